"""The same case gives the same numbers: twice in one process, and with one thread or two (design, decision 8)."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from solids import assert_close, body_of, box, facets_where, held, on_plane

import tactsim as ts
from tactsim.fem import threads as fem_threads
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.equilibrium.newton import Problem
from tactsim.materials.library import named_material
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

TESTS = Path(__file__).parents[1]
MEASURES = {2: "axisymmetric", 3: "solid"}
CELLS = {2: 12, 3: 3}
TOLERANCE = 1e-12
"""Of unknowns between runs with different numbers of threads: the direct solver may add in another order."""


def inflated_block(dim: int, spoil: float = 0.0) -> np.ndarray:
    """Unknowns of a block glued to its base under pressure on its side; c01 is changed by the part ``spoil``."""
    mesh = box([1.0] * dim, [CELLS[dim]] * dim, jitter=0.2)
    body = body_of(mesh, MEASURES[dim], MooneyRivlin2(c10=1.0, c01=0.25 * (1 + spoil)))
    load = FollowerPressure(body.space, facets_where(mesh, on_plane(0, 1.0)), body.pattern, 0.4)
    fixed = np.concatenate([held(mesh, axis, on_plane(1, 0.0)) for axis in range(dim)] + [held(mesh, 0, on_plane(0, 0.0))])
    problem = Problem(body, fixed)
    unknowns = problem.solve(np.zeros(body.space.size), loads=[load]).unknowns
    problem.solver.close()
    return unknowns


def forces_and_tangent(dim: int, threads: int, spoil: float = 0.0) -> np.ndarray:
    """Residual and tangent entries of a deformed body, assembled by so many threads."""
    body = body_of(box([1.0] * dim, [8] * dim, jitter=0.2), MEASURES[dim], MooneyRivlin2(c10=1.0, c01=0.25 * (1 + spoil)))
    unknowns = np.random.default_rng(3).uniform(-0.003, 0.003, body.space.size)
    before = numba.get_num_threads()
    numba.set_num_threads(min(threads, numba.config.NUMBA_NUM_THREADS))
    computed = np.concatenate([body.residual(unknowns), body.tangent(unknowns)])
    numba.set_num_threads(before)
    assert np.isfinite(computed).all()
    return computed


@pytest.mark.parametrize("dim", [2, 3])
def test_forces_and_tangent_are_equal_bit_by_bit_whatever_the_threads(dim, monkeypatch, verification_record):
    monkeypatch.setattr(fem_threads, "SERIAL_ELEMENTS", 0)  # a body so small has one thread otherwise
    one, two = forces_and_tangent(dim, 1), forces_and_tangent(dim, 2)
    assert (one == two).all()
    known = {"reference": "the same with one thread, bit by bit", "kind": "invariance", "tolerance": 0.0}
    verification_record(
        "residual and tangent assembled by two threads", two, one, mesh=f"{MEASURES[dim]}, 8 cells per side", **known
    )
    assert not (forces_and_tangent(dim, 1) == forces_and_tangent(dim, 1, spoil=1e-15)).all()


@pytest.mark.parametrize("dim", [2, 3])
def test_two_solutions_in_one_process_are_equal(dim, one_thread, verification_record):
    first = inflated_block(dim)
    again = inflated_block(dim)
    assert_close(again, first, TOLERANCE)
    known = {"reference": "the first solution", "kind": "invariance", "tolerance": TOLERANCE}
    verification_record(
        "solution again in one process", again, first, mesh=f"{MEASURES[dim]}, {CELLS[dim]} cells per side", **known
    )
    with pytest.raises(AssertionError):
        assert_close(inflated_block(dim, spoil=1e-10), first, TOLERANCE)


def lump_grasp(spoil: float = 0.0) -> np.ndarray:
    """Forces (row, column) in N of the upper taxels over a ball that no plane mirrors; c10 is changed by the part ``spoil``."""
    tissue = named_material("icf_stable").material
    ball = ts.Sphere(center=("14 mm", "12 mm", "9 mm"), radius="3 mm")
    grasp = ts.Grasp(
        block=ts.Block(size=("30 mm", "30 mm", "18 mm"), tissue=tissue.model_copy(update={"c10": tissue.c10 * (1 + spoil)})),
        inclusions=[ts.Embedded(shape=ball, material="lump")],
        loading=ts.close(to="0.5 mm", duration="1 s"),
        mesh={"kind": "graded", "size": "8 mm", "inclusion_size": "4 mm", "edge_size": "6 mm", "growth": 1.5},
        time={"steps": 1},
    )
    return grasp.run(None)["taxel_force_upper"].numbers


@pytest.mark.slow
def test_a_grasp_again_in_one_process_is_equal_bit_by_bit(verification_record):
    """What is computed in between shifts the places in memory, on which sums depended once."""
    first, again = lump_grasp(), lump_grasp()
    assert (again == first).all()
    known = {"reference": "the first solution, bit by bit", "kind": "invariance", "tolerance": 0.0}
    verification_record("forces of a grasp again in one process", again, first, mesh="graded cells", **known)
    assert not (lump_grasp(spoil=1e-8) == first).all()


@pytest.mark.parametrize("dim", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_one_thread_and_two_give_the_same(dim, tmp_path, one_thread, verification_record):
    program = f"import numpy, test_determinism as t; numpy.save('unknowns.npy', t.inflated_block({dim}))"
    environment = os.environ | {
        "NUMBA_NUM_THREADS": "2",
        "MKL_NUM_THREADS": "2",
        "PYTHONPATH": os.pathsep.join([str(TESTS), str(TESTS / "verification")]),
    }
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env=environment, check=True)
    results = inflated_block(dim), np.load(tmp_path / "unknowns.npy")
    assert_close(*results, TOLERANCE)
    known = {"reference": "one thread", "kind": "invariance", "tolerance": TOLERANCE}
    verification_record(
        "solution with two threads", *results[::-1], mesh=f"{MEASURES[dim]}, {CELLS[dim]} cells per side", **known
    )
    with pytest.raises(AssertionError):
        assert_close(results[0], inflated_block(dim, spoil=1e-10), TOLERANCE)
