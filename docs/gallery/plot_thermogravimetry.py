"""
Thermogravimetry: how much filler a composite holds
===================================================

A sample is weighed, its matrix is burnt, and what remains is filler. The fraction by volume follows with the densities, and with
it the separation of the particles that the current has to tunnel through.
"""

import tactsim as ts

# %%
# The masses of the thesis, with the density of the powder, which it takes, and that of solid carbon.
result = ts.load_case("thermogravimetry").run()
fraction, deviation = result["volume_fraction"].value, result["volume_fraction_deviation"].value
for name, value, width in zip(("bulk", "solid"), fraction, deviation, strict=True):
    print(f"{name:5} {value:.4f} ± {2 * width:.4f}")

# %%
# Left the fraction over the density, right what its uncertainty comes from: not from the balance.
result.plot()["thermogravimetry"]
