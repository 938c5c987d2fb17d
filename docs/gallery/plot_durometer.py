"""
Durometer: what a Shore OO reading means for a modulus
======================================================

A durometer presses a blunt rod into the rubber with a spring; the scale from 0 to 100 tells how far the rod stays out. Here the
solver presses the rod of type OO into a silicone, and the spring of the scale turns depth into a reading.
"""

from pathlib import Path

import tactsim as ts

# %%
# The shipped case ``durometer_oo`` has the rod, the scale and the elastomer B1-A. A wider mesh and steps are enough for a
# picture.
case = ts.load_case("durometer_oo", {"experiment.mesh": {"finest": "0.15 mm", "growth": 0.6}})
print(case.title)

# %%
# The run takes half a minute; this page reads the result that it left.
folder = Path("stored/durometer")
if not folder.exists():
    case.run().save(folder)
result = ts.load_result(folder)
result

# %%
# The reading is where the force of the rod meets the force of the spring. The curve of a softer rubber would meet it further
# down.
result.plot("durometer")
