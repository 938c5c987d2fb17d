"""
Film test: resistance of a piezoresistive film under constant forces
====================================================================

A conductive polymer film loses resistance when it is pressed, and goes on losing it while it creeps. The model has tunnelling
between the particles, contact at the electrodes, and a standard linear solid.
"""

import matplotlib.pyplot as plt

import tactsim as ts

# %%
# Sixteen forces on Lingstat film, each held for a minute.
result = ts.load_case("film_lingstat").run()
print("slope of the line:", result["line_slope"])

# %%
# Upper left the resistance one second after the force began: at large forces the contacts, not the film, make most of it. That
# is why the conductance is nearly a line over the force.
figures = result.plot()
figures["film_test"]

# %%
# All forces and times as one surface:
figures["film_surface"]

# %%
# By how much does a reading drift while the force is held? The drift is the part of the resistance that is lost between one
# second and one minute.
forces, times = result["forces"].numbers, result["times"].numbers
resistance = result["resistance"].to("kohm").numbers
lost = 1 - resistance[-1] / resistance[times.searchsorted(1.0)]
figure, axis = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
axis.plot(forces, 100 * lost, marker="o")
axis.set(xlabel="force in N", ylabel="resistance lost in %", ylim=(0, None))
plt.show()
