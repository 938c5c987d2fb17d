"""
Confusion: nothing or a lump?
=============================

An estimator that weighs hypotheses says of a grasp whether it holds nothing, a lump, two lumps, an artery or two. How often
does it take one for the other when the sensors are noisy?
"""

from pathlib import Path

import tactsim as ts

# %%
# The two grasps of :doc:`plot_grasp`, each read five times with 2 mN of noise on every sensor. The reference is the plain grasp.
confusion = ts.kinds("experiment")["confusion"](
    grasps=("stored/grasp_plain", "stored/grasp_lump"),
    reference="stored/grasp_plain",
    noise="2 mN",
    draws=5,
)

# %%
# The run takes some minutes; this page reads the result that it left.
folder = Path("stored/confusion")
if not folder.exists():
    confusion.run().save(folder)
result = ts.load_result(folder)
print(result.reason)

# %%
# Rows are the truth, columns what the estimator said.
result.plot("confusion")
