"""
Published problems: bodies under prescribed loads
=================================================

Problems that others posed and answered, each a shipped case. ``tactsim validate published`` computes all of them and holds them
against the printed numbers.
"""

import tactsim as ts

# %%
# A plate is pressed on a rigid plane and pushed from its side, with a friction of 1 (code_aster SSNV128). It slips on the left
# and sticks on the right. Published: 28.6 and 15.0 µm at 0 and 11.25 mm from the loaded side.
plate = ts.load_case("published_plate_on_plane").run()
print(plate["slip_0"].to("um").value, plate["slip_11"].to("um").value)
plate.plot()["boundary_value_problem"]

# %%
# A clamped rubber sheet is pulled to twice its length; an eighth of it is computed (SSNV189). Abaqus: 1180.67 N. The force falls
# with the mesh, from 1225 N on cells of 5 mm to 1160.3 N, so that the reference is that of a coarse mesh.
sheet = ts.load_case("published_clamped_sheet").run()
print(sheet["pulling_force"])
sheet.plot()["boundary_value_problem"]

# %%
# The same with equal cells of 2.5 mm, changed in Python:
coarse = ts.load_case("published_clamped_sheet", ["experiment.geometry.x=[{length: 25 mm, cells: 10}]"])
print(coarse.run()["pulling_force"])

# %%
# A cube of a Prony series is stretched by 20 % within a second and held (SSNV518). Abaqus: 1.203393 and 0.36333 MPa.
cube = ts.load_case("published_relaxing_cube").run()
print(cube["von_mises_1s"].to("MPa"), cube["von_mises_end"].to("MPa"))
cube.plot()["boundary_value_problem"]

# %%
# The same cube, incompressible, creeps under a dead load to a stretch of six.
creep = ts.load_case("published_creeping_cube").run()
creep.plot()["boundary_value_problem"]

# %%
# A thick tube is widened (SSNV112). Printed: a hoop stress of 99.9566 and a radial stress of -59.9955 MPa at the bore.
tube = ts.load_case("published_thick_cylinder").run()
print(tube["bore_hoop"].to("MPa"), tube["bore_radial"].to("MPa"))
tube.plot()["boundary_value_problem"]

# %%
# A thin Mooney-Rivlin tube is inflated by a pressure that follows its bore; exact: 1.96596 mm.
inflated = ts.load_case("published_inflated_tube").run()
print(inflated["inner_displacement"].to("mm"))
inflated.plot()["boundary_value_problem"]

# %%
# A Mooney-Rivlin cylinder is twisted by 45 degrees between plates that keep their distance (Rivlin): exact are 3.08425 N m, and
# -145.34 N along the axis, for a twisted cylinder wants to become longer.
torsion = ts.load_case("published_torsion").run()
print(torsion["torque"], torsion["axial_force"])
torsion.plot()["boundary_value_problem"]

# %%
# A long cylinder of rubber is squeezed to half its height between smooth plates (ANSYS VM201); read off a curve: 250 and
# 1400 kN/m. A quarter of the section is computed.
cylinder = ts.load_case("published_cylinder_between_plates").run()
print(cylinder["force_100mm"].to("kN/m"), cylinder["force_200mm"].to("kN/m"))
cylinder.plot()["boundary_value_problem"]

# %%
# A rigid disc that is glued to a half-space, over one that slides on it (Mossakovskii, Spence): exact is 1.02863 for a Poisson's
# ratio of 0.3.
glued, smooth = (ts.load_case(f"published_{name}_disc").run()["force"].value for name in ("bonded", "smooth"))
print(glued / smooth)
