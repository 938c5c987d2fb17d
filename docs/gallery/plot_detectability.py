"""
Detectability: the smallest lump that a matrix finds
====================================================

How small may a lump be, over its depth, until a matrix of sensors misses it? The question decides how many sensors a jaw needs.
"""

from pathlib import Path

import tactsim as ts

# %%
# Matrices of 3 x 3 and 8 x 8 sensors on the same 30 mm, a lump 1.8 times as stiff as the tissue and a hard one; "found" means
# with 90 % probability at 5 % of false alarms, under the noise that rounding to 0.1 N makes.
case = ts.load_case(
    "detectability",
    {
        "experiment.matrices": [3, 8],
        "experiment.depths": ["2 mm", "4 mm", "6 mm", "8 mm", "10 mm", "12 mm", "14 mm", "16 mm"],
    },
)

# %%
# The run takes some minutes; this page reads the result that it left.
folder = Path("stored/detectability")
if not folder.exists():
    case.run().save(folder)
result = ts.load_result(folder)
print(result.reason)

# %%
# What one jaw loses with depth the other gains, so that the smallest radius hardly depends on the depth. A lump that is little
# stiffer than the tissue has to be far larger than a hard one. In the grey corner a ball of that radius would reach the face.
result.plot("detectability")
