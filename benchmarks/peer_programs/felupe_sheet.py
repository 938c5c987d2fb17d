"""FElupe on the clamped sheet of SSNV189: python felupe_sheet.py [NX,NY,NZ ...] prints the pulling force of each mesh in N.

An eighth of the sheet in equal linear bricks with a constant pressure each, the element that Abaqus calls C3D8H, by FElupe's mean
dilatation; energy, bulk modulus and clamps as in cases/published_clamped_sheet.yaml. It needs no tactsim. Lengths in mm, MPa.
"""

from __future__ import annotations

import sys

import felupe
import felupe.constitution.tensortrax as differentiated
import numpy as np

HALF_SHEET, HALF_PULL, BULK_MODULUS, STEPS = (25.0, 10.0, 1.75), 24.7071, 2939.0, 10
MESHES = ((5, 2, 1), (10, 4, 1), (18, 7, 1), (25, 10, 1), (33, 13, 2))


def pulling_force(cells):
    """Force in N on the clamp of the whole sheet, which has ``cells`` (3,) along each half edge."""
    mesh = felupe.Cube(b=HALF_SHEET, n=tuple(count + 1 for count in cells))
    field = felupe.FieldsMixed(felupe.RegionHexahedron(mesh), n=3)
    form = differentiated.models.hyperelastic.third_order_deformation
    energy = differentiated.Hyperelastic(form, C10=2.668, C01=0.271, C11=0.0, C20=0.466, C30=0.0)
    solid, displacement = felupe.SolidBody(felupe.NearlyIncompressible(energy, bulk=BULK_MODULUS), field), field[0]
    end = HALF_SHEET[0]
    boundaries = {
        "x = 0": felupe.Boundary(displacement, fx=0.0, skip=(0, 1, 1)),
        "y = 0": felupe.Boundary(displacement, fy=0.0, skip=(1, 0, 1)),
        "z = 0": felupe.Boundary(displacement, fz=0.0, skip=(1, 1, 0)),
        "clamped": felupe.Boundary(displacement, fx=end, skip=(1, 0, 0)),
        "pulled": felupe.Boundary(displacement, fx=end, skip=(0, 1, 1)),
    }
    dof0, dof1 = felupe.dof.partition(field, boundaries)
    for step in range(1, STEPS + 1):
        boundaries["pulled"].update(HALF_PULL * step / STEPS)
        ext0 = felupe.dof.apply(field, boundaries, dof0)
        solved = felupe.newtonraphson(x0=field, items=[solid], dof0=dof0, dof1=dof1, ext0=ext0, verbose=0, tol=1e-6)
        for old, new in zip(field.fields, solved.x.fields, strict=True):
            old.values[:] = new.values
    forces = solid.assemble.vector(field=field).toarray().ravel()[: displacement.values.size].reshape(-1, 3)
    return 4 * abs(float(forces[np.isclose(mesh.points[:, 0], end), 0].sum()))


if __name__ == "__main__":
    asked = [tuple(map(int, text.split(","))) for text in sys.argv[1:]] or MESHES
    for cells in asked:
        print(*cells, f"{pulling_force(cells):.1f} N")  # noqa: T201
