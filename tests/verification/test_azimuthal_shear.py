"""A tube whose outer face turns about its inner one: azimuthal shear at finite strain, with its normal stresses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem

INNER, OUTER, LENGTH, ANGLE = 4e-3, 8e-3, 0.5e-3, np.radians(40)
C10, C01 = 15e3, 5e3
BULK_OVER_SHEAR = 5e3
"""Not exactly incompressible, as the tube is held on all sides; what it gives way is far below the errors of these meshes."""


def exact(c10=C10, c01=C01):
    """Torque in N m, and by how much the radial stress rises from the inner to the outer face in Pa.

    A circle of the radius r turns by g(r) with r g' = M / (2 pi G r^2), M the torque over the length; then
    s_hoop - s_radial = G (r g')^2 and d s_radial / dr = (s_hoop - s_radial) / r (Rivlin 1949, doi:10.1098/rsta.1949.0009).
    """
    modulus = 2 * (c10 + c01)
    moment = 4 * np.pi * modulus * ANGLE / (INNER**-2 - OUTER**-2)
    rise = quad(lambda r: modulus * (moment / (2 * np.pi * modulus * r**2)) ** 2 / r, INNER, OUTER)[0]
    return moment * LENGTH, rise


def turned(radial, around):
    faces = [{"kind": "clamped", "face": "inner"}, {"kind": "rotation", "face": "outer", "angle": ANGLE}]
    ends = [{"kind": "displacement", "face": face, "z": 0.0} for face in ("bottom", "top")]
    spans = {"radial": [{"length": OUTER - INNER, "cells": radial, "ratio": 2}], "axial": [{"length": LENGTH, "cells": 1}]}
    places = {"inside": INNER, "outside": OUTER}
    asked = {name: {"kind": "stress", "at": [r, 0.0, 0.0], "component": "radial"} for name, r in places.items()}
    result = BoundaryValueProblem.model_validate(
        {
            "dimension": "3d",
            "geometry": {"kind": "cylinder", "inner_radius": INNER, "around": around, "part": "whole", **spans},
            "material": {"kind": "mooney_rivlin_2", "c10": C10, "c01": C01, "bulk_modulus": BULK_OVER_SHEAR * 2 * (C10 + C01)},
            "conditions": [*faces, *ends],
            "asked": {"torque": {"kind": "torque", "face": "outer"}, **asked},
        }
    ).run()
    torque, inside, outside = (float(result[name].value) for name in ("torque", *places))
    return torque, outside - inside


def test_torque_of_a_turned_tube(one_thread, verification_record):
    """On coarse cells; the stress, which needs fine ones, is held beside the order of both."""
    torque, _ = exact()
    coarse, _ = turned(3, 4)
    assert abs(coarse / torque - 1) < 1e-3, "of energy: of the fourth order in the size of the cells, a third of the radius"
    record = {"reference": "Rivlin 1949", "kind": "exact", "mesh": "3 cells x 16 around"}
    verification_record("torque of a tube turned by 40 degrees", coarse, torque, tolerance=1e-3, **record)
    assert abs(coarse / exact(c01=0.0)[0] - 1) > 0.1, "a torque without c01 is seen"


@pytest.mark.slow
def test_orders_of_torque_and_normal_stress(one_thread, verification_record):
    torque, rise = exact()
    coarse, fine = turned(3, 4), turned(6, 8)
    errors = [abs(found[0] / torque - 1) for found in (coarse, fine)]
    rises = [abs(found[1] / rise - 1) for found in (coarse, fine)]
    record = {"reference": "Rivlin 1949", "kind": "exact", "mesh": "6 cells x 32 around"}
    verification_record("torque of a tube turned by 40 degrees", fine[0], torque, tolerance=1e-4, **record)
    assert errors[1] < 1e-4, "an eighth of that of coarse cells or less"
    assert np.log2(rises[0] / rises[1]) > 1.5, "extrapolated stress is of the second order, on cells as coarse as these nearly so"
    assert abs(fine[1] / exact(c01=0.0)[1] - 1) > 0.1, "a normal stress without c01 is seen"
