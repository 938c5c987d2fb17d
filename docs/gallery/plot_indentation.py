"""
Indentation: the threshold of the annular sensor
================================================

An annular plate is pressed into soft tissue. The tissue rises into its hole until it touches a second, recessed sensor; the force
on the plate at that moment, over the area of the plate, is the *threshold pressure*. Hard tissue rises late, soft tissue early.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import tactsim as ts

# %%
# The case is built in Python: a cylinder of a soft silicone that sticks to its base, a ring of 3 to 6 mm in diameter, friction,
# and an inner sensor 0.8 mm above the face of the ring. ``stop`` ends the run at the touch.
indentation = ts.Indentation(
    specimen=ts.Specimen(material="icf_stable", thickness="10 mm", radius="15 mm"),
    body=ts.Annulus(inner_radius="1.5 mm", outer_radius="3 mm", fillet="0.2 mm"),
    contact=ts.Coulomb(friction=0.4),
    recess="0.8 mm",
    stop="threshold",
    displacement="8 mm",
    mesh={"finest": "0.2 mm", "growth": 0.6},
)

# %%
# The run takes about a quarter of a minute; this page reads the result that it left.
folder = Path("stored/indentation")
if not folder.exists():
    indentation.run().save(folder)
result = ts.load_result(folder)
for name in ("threshold_force", "threshold_pressure", "threshold_displacement"):
    print(f"{name:23}", result[name])

# %%
# Left the deformed section with the pressure in the tissue, right the force and the rise of the tissue over the displacement.
result.plot("indentation")

# %%
# The history is an xarray data set with units, so that your own figure is a few lines. Force over rise answers a design
# question: with a smaller recess the tissue touches earlier, and the threshold is the force at that rise.
history = result.history
figure, axis = plt.subplots(figsize=(5.5, 3.5), layout="constrained")
axis.plot(1e3 * history["tissue_rise"], history["reaction_force"], marker=".")
axis.set(xlabel="rise of the tissue, or recess, in mm", ylabel="force on the ring in N")
plt.show()
