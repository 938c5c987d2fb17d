"""
Localization: where is the lump, and how sure is that?
======================================================

From the readings of one grasp, and of the same grasp on plain tissue, an estimator says whether a lump is there, where it lies,
and how uncertain its place and size are.
"""

from pathlib import Path

import tactsim as ts

# %%
# The grasps are those of :doc:`plot_grasp`: a lump of radius 4 mm at (26, 24, 13) mm. The noise of a sensor is 1 mN.
# ``model_based`` fits a ball by a fast forward model of the plain tissue.
localization = ts.kinds("experiment")["localization"](
    grasp="stored/grasp_lump",
    reference="stored/grasp_plain",
    noise="1 mN",
    estimator={"kind": "model_based"},
)

# %%
# Setting up the forward model takes a minute; this page reads the result that the run left.
folder = Path("stored/localization")
if not folder.exists():
    localization.run().save(folder)
result = ts.load_result(folder)
print(result.reason)
for name in ("estimated_center", "center_deviation", "lateral_error", "depth_error"):
    if name in result:
        print(name, result[name].to("mm").array.round(2).values)

# %%
# Three views of what the lump adds to the readings, with the true outline, the estimate, and the region that holds the middle of
# the lump with a probability of 90 %.
figures = result.plot()
figures["views"]

# %%
# The thesis's own algorithm looks at the forces alone. It is fast, and on this lump it shows where its limits are: it reports the
# place of the strongest sensor, and no uncertainty.
simple = ts.kinds("experiment")["localization"](
    grasp="stored/grasp_lump",
    reference="stored/grasp_plain",
    noise="1 mN",
    estimator={"kind": "thesis", "background": "reference"},
).run()
print(simple.reason)
print("lateral error", f"{simple['lateral_error'].to('mm'):.1f}", "and depth error", f"{simple['depth_error'].to('mm'):.1f}")
