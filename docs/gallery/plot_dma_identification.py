"""
DMA identification: what eight frequencies tell about a tissue
==============================================================

Dynamic mechanical analysis gives a complex modulus at a few frequencies. A generalized Kelvin model with eight units has
seventeen constants; eight frequencies give sixteen numbers with noise. Which constants do the data determine?
"""

import tactsim as ts

# %%
# The shipped case makes data of Table 4.1 with 2 % of noise and fits them by least squares and by a genetic search. Least squares
# alone are done in seconds. Your own data come from a CSV file: ``data: {kind: file, path: moduli.csv}``.
case = ts.load_case("dma_atrial", {"experiment.methods": ["least_squares"], "experiment.data.noise": 0.02})
result = case.run()
print(result.reason)

# %%
# The curves between 1 and 36 Hz are known well, with narrow bands. The constants are not: units whose retardation times lie
# outside of what was measured may take any value.
result.plot()["dma_identification"]
