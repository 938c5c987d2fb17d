"""
Film creep: stiffness and viscosity from creep tests
====================================================

Strain of the film over time at a few constant forces gives the three coefficients of a standard linear solid, and the lines that
they follow over the force.
"""

import tactsim as ts

# %%
# The shipped case makes strains at 2, 4, 6 and 8 N with 0.2 % of noise; your own come from a file: ``data: {kind: file, path:
# ...}``.
result = ts.load_case("film_creep").run()
for name in ("instantaneous", "delayed", "viscosity"):
    slope, half = result[f"{name}_slope"], result[f"{name}_slope_half_width"]
    print(f"{name:13} slope {slope.value:10.4g} ± {half.value:.2g} {slope.unit}")

# %%
# Left the strains with their fits, right the coefficients with 95 % intervals and the lines through them.
result.plot()["film_creep"]
