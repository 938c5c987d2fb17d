"""
Grasp: a lump between two jaws
==============================

Two jaws with 3 x 3 force sensors each close on a block of soft elastomer that holds a stiff lump. Which sensors feel it?

The lump is off the middle and nearer to the upper jaw, so the upper matrix should see it more sharply than the lower one.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tactsim as ts

# %%
# Lengths carry their unit. ``icf_stable`` is a soft silicone of 10.7 kPa, the lump is twenty times as stiff. The mesh ``graded``
# has few cells, thin at the faces and rounded around the lump. It is the default here; the sizes given are coarser ones.
grasp = ts.Grasp(
    block=ts.Block(size=("40 mm", "40 mm", "20 mm"), tissue="icf_stable"),
    inclusions=[
        ts.Embedded(
            shape=ts.Sphere(center=("26 mm", "24 mm", "13 mm"), radius="4 mm"),
            material=ts.NeoHookean(c10="36 kPa"),
        )
    ],
    matrix=ts.TaxelLayout(rows=3, columns=3, pitch="10 mm", size="9 mm"),
    contact=ts.Coulomb(friction=0.6),
    loading=ts.close(to="1 mm", duration="1 s"),
    mesh={
        "kind": "graded",
        "size": "6 mm",
        "inclusion_size": "3 mm",
        "edge_size": "2 mm",
        "growth": 1,
    },
    time={"steps": 1},
)

# %%
# Solving takes half a minute to a minute. The result is kept in a folder, and this page reads it from there; remove the folder,
# or open this page as a notebook elsewhere, and it is computed.
folder = Path("stored/grasp_lump")
if not folder.exists():
    grasp.run().save(folder)
result = ts.load_result(folder)
result

# %%
# The forces of the sensors are arrays of rows and columns. Row 1 is at the front (smallest y), column 1 at the left (smallest x).
result["taxel_force_upper"].to("mN").array.round(1)

# %%
# A grasp has figures of its own, and one more, of its course, if it takes several steps. The maps show the mean pressure on each
# sensor of both jaws, seen from above, with the outline of the lump.
figures = result.plot()
print(list(figures))
figures["grasp_maps"]

# %%
# The section through the lump shows why: the tissue above it has less room to give way.
figures["grasp_section"]

# %%
# What the lump adds
# ------------------
# Even without a lump the sensors do not read the same: friction holds the tissue back, and the pressure is largest in the
# middle. So the reading to look at is the difference to the same grasp of the plain block.
plain = ts.Grasp(**{name: getattr(grasp, name) for name in ("block", "matrix", "contact", "loading", "mesh", "time")})
folder = Path("stored/grasp_plain")
if not folder.exists():
    plain.run().save(folder)
reference = ts.load_result(folder)

figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained", sharey=True)
for axis, jaw in zip(axes, ("upper", "lower"), strict=True):
    name = f"taxel_force_{jaw}"
    added = np.array(result[name].to("mN")) - np.array(reference[name].to("mN"))
    image = axis.imshow(added, origin="lower", cmap="RdBu_r", vmin=-80, vmax=80, extent=(5, 35, 5, 35))
    for row, column in np.ndindex(added.shape):
        axis.text(
            10 + 10 * column,
            10 + 10 * row,
            f"{added[row, column]:+.0f}",
            ha="center",
            va="center",
            color="w" if added[row, column] > 60 else "k",
        )
    axis.add_patch(plt.Circle((26, 24), 4, fill=False, linestyle="--"))
    axis.set(title=f"{jaw} jaw", xlabel="x in mm")
axes[0].set_ylabel("y in mm")
figure.colorbar(image, ax=axes, label="force added by the lump in mN")
plt.show()
