"""
Indentation in 3D: a sensor that leans
========================================

The axisymmetric model assumes that the sensor stands upright on the axis of the specimen. A hand does not do that. In 3D the
ring may lean and stand off the axis; half of the specimen is meshed with tetrahedra.
"""

from pathlib import Path

import tactsim as ts

# %%
# The shipped case leans the sensor by 3 degrees, 4 mm off the axis of a specimen of 30 mm in diameter.
case = ts.load_case("annulus_tilted_3d", {"experiment.displacement": "0.4 mm", "experiment.penetration_tolerance": "5 um"})
print(case.experiment.tilt_y, case.experiment.offset)

# %%
# The run takes some minutes; this page reads the result that it left.
folder = Path("stored/indentation_3d")
if not folder.exists():
    case.run().save(folder)
result = ts.load_result(folder)
result

# %%
# The side that leans into the tissue carries most of the force.
result.plot("indentation_3d")

# %%
# The deformed tetrahedra with their fields are a pyvista mesh, for a section or a measurement of your own.
grid = result.fields()
print(grid.n_cells, "cells; fields:", ", ".join(grid.point_data))
