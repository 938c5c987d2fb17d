"""
Annulus design: which sensors does the tissue touch?
====================================================

A ring that is narrow, or an inner sensor that sits deep, may never be touched by the tissue within the force that is allowed.
The map shows, over the ratio of the radii and the recess, the force with which the tissue touches.
"""

import numpy as np

import tactsim as ts

# %%
# Nineteen ratios, twenty recesses and three times after the load, by the closed form on atrial tissue.
result = ts.load_case("design_annulus").run()
print(result["point_force_to_touch"].to("N").value, "N to touch at the design point of the thesis")

# %%
# Below the black line the tissue touches with the recommended 2 N. The red star is the design of the thesis: with 1 N it is not
# touched. Hatched designs need a displacement too large for the small-displacement theory; finite elements have to check them.
result.plot("annulus_design")

# %%
# The deepest recess that is still touched with 2 N after 0.5 s, over the ratio of the radii:
experiment = result.experiment
deepest = result["deepest_recess_recommended"].to("mm").numbers
at = list(experiment.times).index(0.5)
for ratio, recess in zip(experiment.ratios, np.take(deepest, at, axis=deepest.shape.index(len(experiment.times))), strict=True):
    print(f"ratio {ratio:4.2f}   {recess:6.3f} mm")
