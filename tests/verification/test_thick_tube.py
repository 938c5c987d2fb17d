"""Thick Mooney-Rivlin tube under internal pressure in plane strain: exact solution (verification.md, 2.1).

r^2 = R^2 + c, l = r / R: p = G [ln(la / lb) + (lb^-2 - la^-2) / 2]. VM56 (Oden 1972, pp. 325-331): radii 7 and 18.625,
C10 = 80, C01 = 20, p = 150 (in, psi). Mutants: a compressible tube, and the stress of Lame's linear tube.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.optimize import brentq
from shells import inflated, radial_displacement, radial_stress
from solids import assert_close, box, cauchy_stress, facets_where, held, on_plane

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.equilibrium.balance import Equilibrium
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

pytestmark = pytest.mark.usefixtures("one_thread")
INNER, OUTER, PRESSURE = 7.0, 18.625, 150.0
VM56 = MooneyRivlin2(c10=80.0, c01=20.0)
DISPLACEMENT_TOLERANCE = 1e-4
"""Relative, demanded of u_i; ten elements across the wall."""
STRESS_TOLERANCE = 1e-2
"""Of the radial stress over the pressure at every quadrature point: linear pressure and strain in elements of a tenth."""
COUNTS = {"axisymmetric": [10, 1], "plane_strain": [10, 8], "solid": [10, 8, 1]}


def inner_stretch(pressure: float, modulus: float = VM56.shear_modulus) -> float:
    """la = r / R at the bore under a pressure."""

    def excess(la: float) -> float:
        lb = np.sqrt(1 + (la**2 - 1) * INNER**2 / OUTER**2)
        return modulus * (np.log(la / lb) + (lb**-2 - la**-2) / 2) - pressure

    return brentq(excess, 1.0, 4.0, xtol=1e-14)


def exact_radial_stress(R: Array) -> Array:
    """sigma_rr at reference radius R: minus the pressure that the tube outside R bears."""
    c = (inner_stretch(PRESSURE) ** 2 - 1) * INNER**2
    stretch, lb = np.sqrt(1 + c / R**2), np.sqrt(1 + c / OUTER**2)
    return -VM56.shear_modulus * (np.log(stretch / lb) + (lb**-2 - stretch**-2) / 2)


def linear_radial_stress(R: Array) -> Array:
    """sigma_rr of Lame's tube at radius R, as if it did not widen."""
    return -PRESSURE * INNER**2 / (OUTER**2 - INNER**2) * (OUTER**2 / R**2 - 1)


def solve_tube(measure: str, material: MooneyRivlin2 = VM56) -> tuple[Body, Equilibrium]:
    """A strip of the section, a quarter of the ring, or a quarter slice; rings widen outwards, planes stay plane."""
    flat = box([1.0] * len(COUNTS[measure]), COUNTS[measure])
    s, t = flat.nodes[:, 0], flat.nodes[:, 1]
    R = INNER * (OUTER / INNER) ** s
    bore = facets_where(flat, on_plane(0, 0.0))
    everywhere = lambda nodes: np.ones(len(nodes), bool)  # noqa: E731
    if measure == "axisymmetric":
        return inflated(
            flat.moved(np.column_stack([R, t])), measure, material, PRESSURE, bore=bore, fixed=held(flat, 1, everywhere)
        )
    angle = np.pi / 2 * t
    fixed = [held(flat, 1, on_plane(1, 0.0)), held(flat, 0, on_plane(1, 1.0))]
    if measure == "solid":
        fixed.append(held(flat, 2, everywhere))
    mesh = flat.moved(np.column_stack([R * np.cos(angle), R * np.sin(angle), flat.nodes[:, 2:]]))
    return inflated(mesh, measure, material, PRESSURE, bore=bore, fixed=np.concatenate(fixed))


def axes(measure: str) -> int:
    """Coordinates that make the radius."""
    return 1 if measure == "axisymmetric" else 2


def assert_bore(measure: str, body: Body, solved: Equilibrium, expected: float = 7.181871) -> None:
    """Every node on the bore moved by u_i."""
    assert_close(radial_displacement(body, solved, INNER, axes=axes(measure)), expected, DISPLACEMENT_TOLERANCE)


def test_the_closed_form_gives_the_printed_numbers(verification_record):
    """Mutants: a modulus without c01, and the stress of Lame's linear tube."""

    def check(la, radial_stress):
        assert abs(INNER * (la - 1) - 7.181871) <= 6e-7  # printed to six digits
        for R, printed in ((8.16, -121.634), (10.0, -85.965), (12.0, -56.621), (15.0, -25.138)):
            assert abs(radial_stress(np.array(R)) - printed) <= 6e-4  # printed to three digits

    la = inner_stretch(PRESSURE)
    check(la, exact_radial_stress)
    known = {"reference": "ANSYS VM56, printed to six digits", "kind": "published", "mesh": "closed form", "scale": 1.0}
    verification_record("thick tube, closed form, bore", INNER * (la - 1), 7.181871, tolerance=6e-7, **known)
    without_c01 = inner_stretch(PRESSURE, 2 * VM56.c10)
    assert_kills(check, without_c01=(without_c01, exact_radial_stress), linear=(la, linear_radial_stress))


@pytest.mark.parametrize("measure", COUNTS)
def test_vm56(measure, verification_record):
    body, solved = solve_tube(measure)
    assert_bore(measure, body, solved)
    assert_close(radial_displacement(body, solved, OUTER, axes=axes(measure)), 3.713668, DISPLACEMENT_TOLERANCE)
    R, stress = radial_stress(body, cauchy_stress(body, solved), solved.unknowns, axes=axes(measure))

    def check(expected):
        assert_close(stress, expected, STRESS_TOLERANCE, scale=PRESSURE)

    check(exact_radial_stress(R))
    known = {
        "reference": "ANSYS VM56, Oden 1972, pp. 325-331",
        "kind": "exact",
        "mesh": f"{measure}, 10 elements across the wall",
    }
    bore = radial_displacement(body, solved, INNER, axes=axes(measure))
    verification_record("thick tube, displacement of the bore", bore, 7.181871, tolerance=DISPLACEMENT_TOLERANCE, **known)
    exact = exact_radial_stress(R)
    verification_record(
        "thick tube, radial stress everywhere", stress, exact, tolerance=STRESS_TOLERANCE, scale=PRESSURE, **known
    )
    assert_kills(check, linear=(linear_radial_stress(R),))


def test_only_the_sum_of_the_coefficients_enters(verification_record):
    body, solved = solve_tube("axisymmetric", MooneyRivlin2(c10=20.0, c01=80.0))
    assert_bore("axisymmetric", body, solved)
    known = {
        "reference": "ANSYS VM56, Oden 1972, pp. 325-331",
        "kind": "exact",
        "mesh": "axisymmetric, 10 elements across the wall",
    }
    bore = radial_displacement(body, solved, INNER, axes=1)
    words = "thick tube of swapped coefficients, displacement of the bore"
    verification_record(words, bore, 7.181871, tolerance=DISPLACEMENT_TOLERANCE, **known)
    another = solve_tube("axisymmetric", MooneyRivlin2(c10=20.0, c01=80.5))
    assert_kills(assert_bore, another_sum=("axisymmetric", *another))


@pytest.mark.parametrize("measure", COUNTS)
def test_a_compressible_tube_is_seen(measure):
    with pytest.raises(AssertionError):
        assert_bore(measure, *solve_tube(measure, VM56.model_copy(update={"bulk_modulus": 2e4})))
