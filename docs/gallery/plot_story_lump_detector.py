"""
Story: from 200 grasps to a detector of lumps
=============================================

A surgeon's gripper with 3 x 3 force sensors on each jaw closes on tissue. Is there a lump in it? A detector is trained on
simulated grasps, and judged on blocks that it has never seen.
"""

# sphinx_gallery_thumbnail_number = 2
import matplotlib.pyplot as plt
import numpy as np
from sklearn.linear_model import LogisticRegression
from sklearn.metrics import roc_auc_score, roc_curve
from sklearn.model_selection import GroupKFold
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

# %%
# The data set
# ------------
# 200 grasps of 100 blocks of a soft silicone. Half of the blocks hold a lump of 2.5 to 5 mm radius, 3.5 to 54 times as stiff as
# the silicone, anywhere in the middle part. Every block is grasped twice, with another closing (0.8 to 1.2 mm), another friction
# (0.3 to 0.8) and other noise. Neither closing nor friction is told to the detector.
#
# The sweep is a call of ``ts.sweep``; :download:`make_grasps.py </gallery/stored/make_grasps.py>` holds all of it. It runs as
# ``python stored/make_grasps.py`` and takes a quarter of an hour on two cores. The page reads the readings and labels that it
# kept. Blocks without a lump hold a ball that is a millionth stiffer than the tissue: so the mesh has a ball in either class, and
# a detector cannot win by recognizing the mesh.
stored = np.load("stored/grasps.npz")
readings, lump, block = 1e3 * stored["read_force"], stored["lump"], stored["specimen"]
print(readings.shape, "readings in mN;", lump.sum(), "grasps with a lump;", len(set(block)), "blocks")

# %%
# Two grasps of one block with a lump and two of one without, upper jaw. The eye does not see which is which.
figure, axes = plt.subplots(1, 4, figsize=(9, 2.6), layout="constrained")
shown = [*np.flatnonzero(lump)[:2], *np.flatnonzero(~lump)[:2]]
for axis, one in zip(axes, shown, strict=True):
    image = axis.imshow(readings[one, 0], origin="lower", vmin=150, vmax=450, cmap="viridis")
    axis.set(title="lump" if lump[one] else "no lump", xticks=[], yticks=[])
figure.colorbar(image, ax=axes, label="reading in mN")
plt.show()

# %%
# Train without cheating
# ----------------------
# Both grasps of a block stay on the same side of every split: ``GroupKFold`` holds out whole blocks, ten times a tenth. The
# features are the eighteen readings over their sum, which takes out most of the closing, and the sum itself. A logistic
# regression on them and their squares is enough for so few data.
total = readings.sum(axis=(1, 2, 3), keepdims=True)
features = np.hstack([(readings / total).reshape(len(readings), -1), total.reshape(-1, 1)])
detector = make_pipeline(
    StandardScaler(),
    PolynomialFeatures(degree=2, include_bias=False),
    StandardScaler(),
    LogisticRegression(C=0.05, max_iter=5000),
)
score = np.zeros(len(lump))
for train, test in GroupKFold(n_splits=10).split(features, lump, groups=block):
    score[test] = detector.fit(features[train], lump[train]).decision_function(features[test])

# %%
# The curve and its interval
# --------------------------
# The interval comes from drawing the blocks, not the grasps, anew with replacement: two grasps of one block are not independent.
random = np.random.default_rng(1)
grid = np.linspace(0, 1, 101)
blocks = np.unique(block)
rows = {one: np.flatnonzero(block == one) for one in blocks}
curves, areas = [], []
while len(areas) < 1000:
    drawn = np.concatenate([rows[one] for one in random.choice(blocks, len(blocks))])
    false, true, _ = roc_curve(lump[drawn], score[drawn])
    curves.append(np.interp(grid, false, true))
    areas.append(roc_auc_score(lump[drawn], score[drawn]))
area = roc_auc_score(lump, score)
low, high = np.percentile(areas, [2.5, 97.5])

figure, axis = plt.subplots(figsize=(4.8, 4.6), layout="constrained")
axis.fill_between(
    grid, *np.percentile(curves, [2.5, 97.5], axis=0), color="C0", alpha=0.2, linewidth=0, label="95 % of the draws"
)
false, true, _ = roc_curve(lump, score)
axis.plot(false, true, color="C0", label=f"area {area:.2f} ({low:.2f} to {high:.2f})")
axis.plot([0, 1], [0, 1], color="0.6", linewidth=0.8, linestyle="--")
axis.set(xlabel="false alarms", ylabel="lumps found", xlim=(0, 1), ylim=(0, 1.01), aspect="equal")
axis.set_title("Held-out blocks")
axis.legend(frameon=False, loc="lower right")
plt.show()

# %%
# Which lumps are missed?
# -----------------------
# At 10 % of false alarms, over the radius and the depth below the nearer jaw:
level = np.quantile(score[~lump], 0.9)
depth = 1e3 * np.minimum(stored["center"][:, 2], 0.02 - stored["center"][:, 2])
radius = 1e3 * stored["radius"]
figure, axis = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for caught, marker, face, label in ((True, "o", "C0", "found"), (False, "o", "none", "missed")):
    at = lump & ((score > level) == caught)
    axis.scatter(radius[at], depth[at], marker=marker, facecolors=face, edgecolors="C0", label=f"{label} ({at.sum()})")
axis.set(xlabel="radius of the lump in mm", ylabel="depth of its centre in mm")
axis.invert_yaxis()
axis.legend(frameon=False, loc="upper left", bbox_to_anchor=(1, 1))
plt.show()

# %%
# What this says, and what not
# ----------------------------
# The curve starts high because blocks without a lump are alike here: one tissue, one size, and only closing, friction and noise
# differ. The lumps are balls. The mesh is coarse: of such grasps all sensors lie
# within 3 % of the largest from those of a fine mesh. A detector for real tissue needs blocks that vary as tissue does, which
# is another line in ``vary``.
print(f"{np.mean(score[lump] > level):.0%} of the grasps with a lump found at 10 % of false alarms")
