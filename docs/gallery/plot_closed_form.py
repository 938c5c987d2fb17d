"""
Closed form: the viscoelastic annulus in milliseconds
=====================================================

For small displacements the annulus on viscoelastic tissue has a closed form. It follows any history of force or displacement at
once, which makes it the tool for a first design and for large data sets.
"""

import matplotlib.pyplot as plt

import tactsim as ts

# %%
# The load of section 4.7 of the thesis: 0.2 N at once, then an oscillation, on porcine atrial tissue.
case = ts.load_case("annulus_dynamic_load")
result = case.run()
print(result["largest_displacement"].to("mm"), "at most")

# %%
# Force, displacement and the rise of the tissue on the axis of the hole. Where the force pulls, a real contact would open, and
# the closed form, which stays bonded, no longer holds; these times are shaded.
result.plot("closed_form")

# %%
# How much of the rise under the hole is left when the hole is narrow? An override changes one value of the case.
figure, axis = plt.subplots(figsize=(5.5, 3.5), layout="constrained")
for inner in ("0.3 mm", "1 mm", "1.5 mm", "2 mm"):
    one = ts.load_case("annulus_dynamic_load", {"experiment.inner_radius": inner, "experiment.points": 80}).run()
    history = one.history
    axis.plot(history["time"], 1e6 * history["tissue_rise_axis"], label=f"inner radius {inner}")
axis.set(xlabel="time in s", ylabel="rise on the axis in µm")
axis.legend(frameon=False, ncols=2)
axis.set_ylim(top=1.35 * axis.get_ylim()[1])
plt.show()
