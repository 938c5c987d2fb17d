"""Incompressible tissue keeps its volume where free faces roll onto jaws and around fillets, and its pressures stay stable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from mutants import assert_kills
from scipy.linalg import eigh
from scipy.sparse import identity, kron
from solids import body_of

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.path import grasp_path
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.fem.assembly.volume_stiffness import MOST, VOLUME_STIFFNESS
from tactsim.fem.solvers.block_preconditioner import pressure_mass
from tactsim.fem.solvers.linear import direct_solver
from tactsim.fem.solvers.two_level import linear_interpolation
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models import block_model, pressed_model
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_block
from tactsim.results.result import Status

pytestmark = pytest.mark.usefixtures("one_thread")
SIZE = (24e-3, 24e-3, 12e-3)
OFF = 0.02
"""Error of a volume ratio that counts."""


@dataclass(frozen=True)
class Squeezed:
    """A plain block closed by 1 mm in all: the part of its volume that is off by ``OFF``, the least ratio, a taxel in N."""

    poor: float
    least: float
    taxel: float


def squeezed(edge_size: float, growth: float, stiffness: float | None, monkeypatch) -> Squeezed:
    """The block with cells of ``edge_size`` in m at the jaws, and of one ``stiffness`` or by the rule."""
    with monkeypatch.context() as changed:
        if stiffness is not None:
            changed.setattr(block_model, "block_volume_stiffness", lambda nodes, elements, pressed: stiffness)
        grasp = Grasp.model_validate(
            {
                "block": {"size": SIZE, "tissue": "icf_stable"},
                "matrix": {"rows": 2, "columns": 2, "pitch": 10e-3, "size": 9e-3},
                "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 0.5e-3, "duration": 1.0}]},
                "mesh": {"kind": "graded", "size": 4e-3, "edge_size": edge_size, "growth": growth},
                "time": {"steps": 1},
            }
        )
        model = grasp_model(grasp, grasp_mesh(grasp))
        state = list(grasp_path(grasp, model).states())[-1][0].contact
    error, weights = np.abs(model.body.volume_error(state.unknowns, state.kinematics)), model.body.points.weights
    poor, least = weights[error > OFF].sum() / weights.sum(), state.kinematics.J.min()
    return Squeezed(float(poor), float(least), float(model.taxels(state, "upper", grasp.matrix).taxels[2, 0, 0]))


def test_tissue_keeps_its_volume_at_the_edges_of_the_jaws(monkeypatch, verification_record):
    """Mutant: linear pressures alone hold the volume."""

    def check(stiffness):
        found = squeezed(1.6e-3, 0.5, stiffness, monkeypatch)
        assert found.poor < 0.02  # 0.7 %, and 6 % without
        assert found.least > 0.9  # 0.97, and 0.86 without
        return found.poor

    known = {"reference": "volume of incompressible tissue", "kind": "exact", "mesh": "graded cells of 1.6 to 4 mm"}
    verification_record(
        "part of a grasped block whose volume is off by 2 %", check(None), 0.0, scale=1.0, tolerance=0.02, **known
    )
    assert_kills(check, without=(0.0,))


FINER = 0.206188
"""Force in N on the taxel at the corner by cells of 0.25 and 2.5 mm, 107 368 unknowns, with the stiffness of a block."""


def check_slim(stiffness, monkeypatch):
    """On cells of 0.4 to 4 mm volumes are kept and the taxel is as on finer ones."""
    found = squeezed(0.4e-3, 0.8, stiffness, monkeypatch)
    assert found.poor < 1e-3  # 0.6e-3; 2.7e-3 with 3 for all cells
    assert found.taxel == pytest.approx(FINER, rel=1.5e-3)  # 0.10 %; 0.22 % with 20 for all cells
    return found.taxel


def test_slim_cells_keep_volumes_without_making_a_block_stiffer(monkeypatch, verification_record):
    """Mutant: the stiffness of slim cells for all, which hardens the block."""
    known = {"reference": "cells of 0.25 and 2.5 mm", "kind": "invariance", "mesh": "graded cells of 0.4 to 4 mm"}
    taxel = check_slim(None, monkeypatch)
    verification_record("taxel at the corner of a plain block", taxel, FINER, tolerance=1.5e-3, **known)
    assert_kills(check_slim, slim=(MOST, monkeypatch))


@pytest.mark.slow
def test_the_stiffness_of_coarse_cells_would_leave_volumes_of_slim_ones(monkeypatch):
    assert_kills(check_slim, coarse=(VOLUME_STIFFNESS, monkeypatch))


def test_tissue_that_is_drawn_around_a_tight_fillet_keeps_its_volume(monkeypatch, verification_record):
    """On elements nearly as long as the fillet, against those of half the length without the stiffness.

    Mutant: linear pressures alone hold the volume; at 3.17 mm an element beside the fillet turns inside out.
    """
    punch = Indentation.model_validate(
        {
            "specimen": {"material": {"kind": "neo_hookean", "c10": 13.89e3}, "thickness": 13.89e-3, "radius": 14.07e-3},
            "body": {"kind": "punch", "radius": 3.181e-3, "fillet": 0.1669e-3},
            "contact": {"kind": "coulomb", "friction": 0.431},
            "displacement": 1.8e-3,
            "stop": "displacement",
            "mesh": {"growth": 0.6, "finest": 0.1272e-3},
        }
    )

    def check(stiffness):
        monkeypatch.setattr(pressed_model, "VOLUME_STIFFNESS", stiffness)
        result = punch.run()
        assert result.status is Status.CONVERGED, result.reason
        assert result["reaction_force"].value == pytest.approx(1.5385, rel=2e-3)  # by `refinement: 2`
        assert result["min_volume_ratio"].value > 0.78  # 0.82, and 0.70 without
        return result["reaction_force"].value

    found = check(VOLUME_STIFFNESS)
    known = {
        "reference": "elements of half the length",
        "kind": "invariance",
        "mesh": "axisymmetric, 0.13 mm at a fillet of 0.17 mm",
    }
    verification_record("punch with a tight fillet, force", found, 1.5385, tolerance=2e-3, **known)
    assert_kills(check, stiffness=(0.0,))


def stability(size: float, *, linear: bool = False) -> float:
    """Inf-sup constant of the pair of displacement and pressure on graded cells of ``size`` in m, all faces held.

    Root of the second smallest eigenvalue of B A^-1 B' over the mass of the pressures (Chapelle & Bathe 1993,
    doi:10.1016/0045-7949(93)90340-J); the smallest is that of a uniform pressure. ``linear`` displacements are the mutant.
    """
    mesh = graded_block(SIZE, [], BlockMeshSettings(size=size, edge_size=size / 2, growth=1.0)).mesh
    body = body_of(mesh, "solid", NeoHookean(c10=0.5), volume_stiffness=VOLUME_STIFFNESS)
    split = body.space.displacement_size
    tangent = body.pattern.matrix(body.tangent(np.zeros(body.space.size)))
    free = ~((np.abs(mesh.nodes) < 1e-9) | (np.abs(mesh.nodes - SIZE) < 1e-9)).any(axis=1)
    shapes = linear_interpolation(body.space) if linear else identity(len(mesh.nodes), format="csr")
    shapes = kron(shapes[:, free[: shapes.shape[1]]], identity(3), format="csr")
    A, B = (shapes.T @ tangent[:split, :split] @ shapes).tocsr(), (tangent[split:, :split] @ shapes).toarray()
    A.sort_indices()
    solver = direct_solver("superlu")
    solver.factor(A)
    schur = B @ np.stack([solver.solve(row) for row in B], axis=1)
    solver.close()
    mass = pressure_mass(body, np.ones(len(mesh.elements))).toarray()
    return float(np.sqrt(max(eigh(schur, mass, eigvals_only=True)[1], 0.0)))


def test_pressures_stay_stable_as_cells_shrink(verification_record):
    """Mutant: displacements as linear as the pressures, which then checkerboard."""

    def check(linear):
        coarse, fine = (stability(size, linear=linear) for size in (8e-3, 5e-3))
        assert coarse > 0.2
        assert fine > 0.95 * coarse
        return fine, coarse

    found, expected = check(False)
    known = {
        "reference": "that of cells 1.6 times as long (Chapelle & Bathe 1993)",
        "kind": "invariance",
        "mesh": "graded cells of 5 mm",
    }
    verification_record("inf-sup constant of displacement and pressure", found, expected, tolerance=0.05, **known)
    assert_kills(check, linear=(True,))
