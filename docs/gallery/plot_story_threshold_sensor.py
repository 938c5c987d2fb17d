"""
Story: from the stress-strain curve of a silicone to a threshold sensor
=======================================================================

A phantom is cast from Ecoflex 00-30. Which recess should an annular sensor have, so that the silicone reaches the inner sensor
with a force between 0.3 and 1 N, enough to read well and little enough for a hand? Four steps: fit the material, press the ring
into it, read the threshold over the recess, and look at the voltage.
"""

# sphinx_gallery_thumbnail_number = 3
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tactsim as ts
from tactsim.identification.uniaxial import fit_uniaxial
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.materials.homogeneous import nominal_stress

# %%
# A published curve
# -----------------
# Nine points of a tensile test of Ecoflex 00-30 (ASTM D412, 450 mm/min) by Marechal, Balland, Lindenroth, Petrou,
# Kontovounisios and Bello, *Toward a common framework and database of materials for soft robotics*, Soft Robotics 2020,
# `doi:10.1089/soro.2019.0115 <https://doi.org/10.1089/soro.2019.0115>`_. The points are from the authors' Soft Robotics
# Materials Database, which is under the Open Database License 1.0.
strain = np.array([0.18181, 0.40909, 0.63637, 0.86363, 1.09091, 1.31818, 1.54545, 1.77273, 2.0])
stress = 1e3 * np.array([6.82, 13.82, 20.27, 25.96, 30.96, 36.35, 41.49, 47.06, 52.39])
curve = UniaxialCurve(stretch=1 + strain, nominal_stress=stress, source="Marechal et al. 2020, Ecoflex 00-30")

# %%
# Fit a material
# --------------
# ``stable`` keeps the material strongly elliptic at every stretch, so that the finite elements do not depend on their mesh. From
# files, ``tactsim material --fit curve.csv`` does the same.
fits = {form: fit_uniaxial(curve, form) for form in ("2-parameter", "stable")}
figure, axis = plt.subplots(figsize=(5.8, 3.8), layout="constrained")
stretch = np.linspace(0.6, 3.0, 100)
for (form, fit), style in zip(fits.items(), ("--", "-"), strict=True):
    axis.plot(
        stretch - 1,
        1e-3 * nominal_stress(fit.material, "uniaxial", stretch),
        style,
        label=f"{form}, worst point {fit.max_relative_error:.0%} off",
    )
axis.plot(strain, 1e-3 * stress, "ko", label="measured")
axis.axvspan(-0.4, 0, color="0.93")
axis.text(-0.38, 40, "compression:\nnot measured", fontsize=9)
axis.set(xlabel="strain", ylabel="nominal stress in kPa")
axis.legend(frameon=False, loc="lower right")
plt.show()

# %%
# Under a sensor the silicone is compressed and sheared, and the test was in tension. All that follows rests on the fitted energy
# where nothing was measured; a compression test of the phantom would be worth its time.
silicone = fits["stable"].material
print(f"shear modulus {silicone.shear_modulus / 1e3:.1f} kPa")

# %%
# Press the ring into it
# ----------------------
# One run to a recess of 0.62 mm is enough: until the inner sensor is touched its place does not matter, so that the force at a
# rise of 0.4 mm is the threshold of a recess of 0.4 mm. The run takes half a minute; this page reads the result that it left.
indentation = ts.Indentation(
    specimen=ts.Specimen(material=silicone, thickness="10 mm", radius="15 mm"),
    body=ts.Annulus(inner_radius="1.5 mm", outer_radius="3 mm", fillet="0.4 mm"),
    contact=ts.Coulomb(friction=0.4),
    recess="0.62 mm",
    stop="threshold",
    displacement="8 mm",
    mesh={"finest": "0.2 mm", "growth": 0.6},
)
folder = Path("stored/story_silicone")
if not folder.exists():
    indentation.run().save(folder)
result = ts.load_result(folder)
print(result.reason)
result.plot("indentation")

# %%
# Choose the recess
# -----------------
# Threshold force over recess, and what the film makes of it: the conductance after one second, on a divider of 1 kohm at 5 V.
history = result.history
rise, force = history["tissue_rise"].values, history["reaction_force"].values
film = ts.load_case("film_lingstat", {"experiment.forces": [f"{0.1 * n} N" for n in range(1, 21)]}).run()
resistance = np.interp(force, film["forces"].numbers, film["reading_resistance"].numbers)
voltage = 5.0 * 1e3 / (1e3 + resistance)

figure, (above, below) = plt.subplots(2, 1, figsize=(5.8, 5), sharex=True, layout="constrained")
above.plot(1e3 * rise, force)
above.axhspan(0.3, 1, color="0.93")
above.set(ylabel="threshold force in N")
inside = force >= film["forces"].numbers[0]
below.plot(1e3 * rise[inside], voltage[inside])
below.set(xlabel="recess of the inner sensor in mm", ylabel="voltage at the threshold in V")
recesses = np.interp([0.3, 1.0], force, 1e3 * rise)
for recess in recesses:
    for axis in (above, below):
        axis.axvline(recess, color="0.6", linewidth=0.8)
plt.show()

# %%
# The answer, for this silicone and this ring; a recess in the middle leaves room on both sides.
print(f"recess from {recesses[0]:.2f} mm (0.3 N) to {recesses[1]:.2f} mm (1 N)")
