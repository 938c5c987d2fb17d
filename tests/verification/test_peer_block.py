"""The block that the benchmarks squeeze, against FElupe, GetFEM and FEniCSx in mixed form on the same mesh.

FElupe 11.3.0 (tensortrax 0.29.0), ``NearlyIncompressible`` bodies, P2 displacement, continuous P1 pressure and volume ratio:
``python benchmarks/peers.py --cells 6,6,3 --agreement 6,6,3``, its nodal reactions read by ``readings``. The three-field form is
tactsim's two-field form but where nodes belong to both materials, whose bulk moduli differ: 1.4e-5 of the largest pressure.

GetFEM 5.4.2 and FEniCSx (dolfinx 0.5.2), the same two fields and points: ``getfem_mixed_block.py`` and ``fenicsx_mixed_block.py``
in ``benchmarks/peer_programs``, their reactions read alike. They solve the same discrete problem, and agree with each other to
2e-12. CalculiX has no mixed form of tetrahedra.
"""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest
from mutants import assert_kills

PROGRAMS = Path(__file__).parents[2] / "benchmarks" / "peer_programs"
CELLS = (6, 6, 3)
FORCE = 3.443137
"""On the top in N, after four steps of 0.5 mm."""
PRESSURES = (2109.650, 2136.529, 2090.276, 2136.529, 2404.115, 2144.862, 2090.276, 2144.862, 2110.551)
"""Means on nine squares of the top in Pa, nominal."""
TOLERANCE = 1e-4
"""Of every number over itself: what was asked of programs that solve one discrete problem."""
TWO_FIELDS = (3.4431162302, 2109.6417727816, 2136.5150765806, 2090.2677871151, 2136.5150765806, 2404.0812553654)
TWO_FIELDS += (2144.8482085685, 2090.2677871151, 2144.8482085685, 2110.5436221559)
"""Force in N and nine pressures in Pa by GetFEM, and by FEniCSx to the ten digits that both print."""
SAME_PROBLEM = 1e-9
"""Of every number over itself: the numbers are printed to eleven digits, Newton leaves 1e-8 of the forces and is quadratic."""


@pytest.fixture(scope="module")
def measured() -> np.ndarray:
    """Force in N and nine mean pressures in Pa."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(PROGRAMS)
        block, ours = (importlib.import_module(name) for name in ("block_problem", "tactsim_block"))
        problem = block.block_problem(CELLS)
        return block.readings(problem, ours.solve(problem)["forces"])


def test_force_and_nine_pressures_are_those_of_felupe(measured, verification_record):
    """Mutants: the squares mirrored, a block without the hard ball, whose pressure is even, and the force of a quarter."""

    def check(force, pressures):
        np.testing.assert_allclose(measured, [force, *np.ravel(pressures)], rtol=TOLERANCE)

    squares = np.reshape(PRESSURES, (3, 3))
    check(FORCE, squares)
    ratios = measured / [FORCE, *PRESSURES]
    known = {"reference": "FElupe 11.3.0, mixed form, same mesh", "kind": "published", "mesh": "solid, 6 x 6 x 3 cells"}
    verification_record("squeezed block, force and nine pressures", ratios, np.ones(10), tolerance=TOLERANCE, **known)
    even = np.full((3, 3), FORCE / 0.04**2)
    assert_kills(check, mirrored=(FORCE, squares[:, ::-1]), even=(FORCE, even), quarter=(FORCE / 4, squares))


def test_the_same_discrete_problem_has_the_answer_of_getfem_and_fenicsx(measured, verification_record):
    """Mutants: the force of FElupe's three fields, and the squares mirrored."""

    def check(force, pressures):
        np.testing.assert_allclose(measured, [force, *np.ravel(pressures)], rtol=SAME_PROBLEM)

    force, squares = TWO_FIELDS[0], np.reshape(TWO_FIELDS[1:], (3, 3))
    check(force, squares)
    reference = "GetFEM 5.4.2 and FEniCSx 0.5.2, mixed form, same mesh"
    known = {"reference": reference, "kind": "published", "mesh": "solid, 6 x 6 x 3 cells"}
    ratios = measured / np.array(TWO_FIELDS)
    verification_record("squeezed block, force and nine pressures", ratios, np.ones(10), tolerance=SAME_PROBLEM, **known)
    assert_kills(check, three_fields=(FORCE, squares), mirrored=(force, squares[:, ::-1]))


def test_squares_add_up_to_the_force(measured, verification_record):
    """Mutants: the area of the whole top, and the middle square left out."""

    def check(force, area, pressures):
        assert area * pressures.sum() == pytest.approx(force, rel=1e-10), "round-off of the mass matrix"

    check(measured[0], 0.04**2 / 9, measured[1:])
    known = {"reference": "the force on the top", "kind": "invariance", "mesh": "solid, 6 x 6 x 3 cells", "tolerance": 1e-10}
    verification_record("squeezed block, sum over nine squares", 0.04**2 / 9 * measured[1:].sum(), measured[0], **known)
    assert_kills(check, area=(measured[0], 0.04**2, measured[1:]), middle=(measured[0], 0.04**2 / 9, np.delete(measured[1:], 4)))
