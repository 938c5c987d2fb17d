"""Where Newton begins a grasp whose case asks for the tissue without its inclusions.

Mutants: displacements without the forces of the contact, which cost systems instead of saving them; a kept solution that knows
only the block; friction beyond the limit of the grasp's own law.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tactsim as ts
from tactsim.errors import CaseError, Collapsed, ConvergenceError, Unfinished
from tactsim.experiments.grasp import path, tissue_alone
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.regularisation import regularisation
from tactsim.fem.equilibrium import newton
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.first_guess import FIRST_PART
from tactsim.results.result import Status

pytestmark = pytest.mark.usefixtures("one_thread")
CELLS = {"kind": "graded", "size": 10e-3, "inclusion_size": 4e-3, "edge_size": 3.2e-3, "growth": 1, "filling": "fan"}
CENTER, RADIUS, CLOSING = (0.014, 0.023, 0.011), 4e-3, 1e-3
APART = 2e-3
"""Difference of a taxel over the largest that the contact's tolerance leaves, wherever Newton begins."""


def grasp(lump: Any = "lump", *, guess: str = "tissue", **changes: Any) -> ts.Grasp:
    """A lump in a block, closed on by 1 mm in one step."""
    settings: dict[str, Any] = {
        "block": ts.Block(tissue="icf_stable"),
        "inclusions": [ts.Embedded(shape=ts.Sphere(center=CENTER, radius=RADIUS), material=lump)],
        "matrix": ts.TaxelLayout(rows=3, columns=3, pitch=10e-3, size=9e-3),
        "loading": ts.close(to=CLOSING, duration=1.0),
        "mesh": CELLS,
        "time": {"steps": 1},
        "penetration_tolerance": 1e-5,
        "solver": {"first_guess": guess, "balance": 1e-4},
    }
    return ts.Grasp(**(settings | changes))


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    tissue_alone._solved.cache_clear()
    yield
    tissue_alone._solved.cache_clear()


class Run:
    """A grasp that was run: its forces on the taxels and how many of its systems are those of the block with the lump."""

    def __init__(self, experiment: ts.Grasp) -> None:
        sizes: list[int] = []
        take = newton._Solution._linear_step

        def counted(solution: Any, state: Any, now: Any) -> Any:
            sizes.append(len(state.unknowns))
            return take(solution, state, now)

        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(newton._Solution, "_linear_step", counted)
            result = experiment.run()
        assert result.status is Status.CONVERGED, result.reason
        self.residual, self.assumptions = result.steps[-1].residual, result.assumptions
        self.taxels = np.concatenate([result.quantities[f"taxel_force_{side}"].value for side in ("upper", "lower")])
        self.systems = sum(size == max(sizes) for size in sizes)


@pytest.fixture(scope="module")
def compressed() -> Run:
    """The grasp without the guess."""
    return Run(grasp(guess="compression"))


@pytest.fixture(scope="module")
def led() -> Run:
    """The grasp with it, the first that asks for it."""
    tissue_alone._solved.cache_clear()
    return Run(grasp())


def test_newton_is_led_by_displacements_and_forces_together(compressed: Run, led: Run) -> None:
    assert np.abs(led.taxels - compressed.taxels).max() < APART * compressed.taxels.max()
    assert led.systems <= 0.8 * compressed.systems


@pytest.mark.slow
def test_displacements_alone_lead_it_astray(compressed: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """The mutant of the test above."""
    expecting = tissue_alone.TissueAlone.expected_by

    def forceless(self: Any, rest: Any, closing: float) -> Any:
        state = expecting(self, rest, closing)
        grown = [replace(c.growth, pressure=0 * c.growth.pressure, tangential=0 * c.growth.tangential) for c in state.contacts]
        return replace(state, contacts=tuple(replace(c, growth=g) for c, g in zip(state.contacts, grown, strict=True)))

    monkeypatch.setattr(tissue_alone.TissueAlone, "expected_by", forceless)
    misled = Run(grasp())
    assert np.abs(misled.taxels - compressed.taxels).max() < APART * compressed.taxels.max()
    assert misled.systems > 0.8 * compressed.systems


def test_tissue_of_one_kind_is_where_the_guess_says() -> None:
    """With a "lump" of the tissue's own material: what is expected differs by the mesh, the rungs and the surplus of friction."""
    experiment = grasp("icf_stable")
    model = grasp_model(experiment, grasp_mesh(experiment))
    rest = model.start(experiment.contact, regularisation(experiment))
    guess = path._first_guess(experiment, model, rest, CLOSING)
    found = model.equilibrium(rest, CLOSING, model.compressed(0.6 * CLOSING))
    compressed = model.compressed(CLOSING)
    near, far = (np.sqrt(np.mean(model.space.split(u - found.unknowns)[0] ** 2)) for u in (guess.unknowns, compressed))
    assert near < min(0.02 * CLOSING, 0.2 * far)
    for expected, contact in zip(guess.state.contacts, found.contacts, strict=True):
        assert expected.growth is not None
        pressure = CLOSING * expected.growth.pressure
        whole, sought = (expected.surface.points.weights @ values for values in (pressure, contact.state.pressure))
        assert whole == pytest.approx(sought, rel=0.05)
        friction = CLOSING * np.linalg.norm(expected.growth.tangential, axis=0)
        assert (friction <= contact.pair.traction_limit(pressure) * (1 + 1e-9)).all()


def test_no_grasp_depends_on_those_before_it() -> None:
    alone = tissue_alone.tissue_alone(grasp(), CLOSING)
    tissue_alone._solved.cache_clear()
    tissue_alone.tissue_alone(grasp(loading=ts.close(to=1.05e-3, duration=1.0)), 1.05e-3)
    after = tissue_alone.tissue_alone(grasp(), CLOSING)
    assert alone is not None
    assert after is not None
    assert np.array_equal(after.displacements.values, alone.displacements.values)
    for side, forces in alone.forces.items():
        assert np.array_equal(after.forces[side].between.values, forces.between.values)


def test_it_is_solved_once_for_all_that_differ_little_but_in_their_inclusions() -> None:
    def found(**changes: Any) -> Any:
        return tissue_alone.tissue_alone(grasp(**changes), changes.pop("to", CLOSING))

    one = found()
    elsewhere = ts.Embedded(shape=ts.Sphere(center=(0.02, 0.01, 0.008), radius=3e-3), material="lump")
    assert found(inclusions=[elsewhere]) is one
    assert found(contact=ts.Coulomb(friction=0.62)) is one
    assert found(matrix=ts.TaxelLayout(rows=4, columns=4, pitch=8e-3, size=7e-3)) is one
    assert found(block=ts.Block(tissue="lump")) is not one
    assert found(contact=ts.Coulomb(friction=0.3)) is not one
    assert found(upper={"tilt_x": "1 deg"}) is not one
    assert found(penetration_tolerance=5e-6) is not one


@pytest.mark.parametrize(
    ("changes", "closing"),
    [
        ({"contact": ts.Coulomb(friction=10)}, CLOSING),
        ({"loading": ts.close(to=0.9e-4, duration=1.0), "penetration_tolerance": 9e-6}, 0.9e-4),
        ({}, 2e-5),
        (
            {
                "upper": {"width": "24 mm", "depth": "24 mm"},
                "lower": {"width": "24 mm", "depth": "24 mm"},
                "matrix": ts.TaxelLayout(pitch=7e-3, size=7e-3),
            },
            CLOSING,
        ),
    ],
    ids=["most friction", "widest tolerance", "a first step that was cut", "narrow jaws"],
)
def test_what_a_case_may_ask_for_has_its_tissue(changes: dict[str, Any], closing: float) -> None:
    """A friction, a closing or taxels of the tissue's own that no case may have are no reason to refuse the case."""
    middle = ts.Embedded(shape=ts.Sphere(center=(0.02, 0.02, 0.01), radius=RADIUS), material="lump")
    assert tissue_alone.tissue_alone(grasp(**{"inclusions": [middle]} | changes), closing) is not None


RELAXING = ts.Block(tissue={"kind": "neo_hookean", "c10": "2 kPa", "relaxation": {"fractions": [0.3], "times": ["1 s"]}})
TUBE = ts.Embedded(shape=ts.Tube.example(), material="lump")
PUSHED = {"control": "force", "pieces": [{"kind": "ramp", "to": "1 N", "duration": "1 s"}]}


@pytest.mark.parametrize(
    ("changes", "hindrance"),
    [
        ({"inclusions": []}, "nothing is embedded"),
        ({"inclusions": [TUBE]}, "wall of a hollow tube"),
        ({"mesh": {"kind": "structured", "cells": [8, 8, 4]}}, "not of graded cells"),
        ({"block": RELAXING}, "a material relaxes"),
        ({"loading": PUSHED}, "follow a force"),
    ],
    ids=["nothing", "tube", "cells", "relaxing", "force"],
)
def test_where_it_does_not_act_it_is_said_why(changes: dict[str, Any], hindrance: str) -> None:
    assert hindrance in str(tissue_alone.why_not_tissue(grasp(**changes)))
    assert tissue_alone.tissue_alone(grasp(**changes), CLOSING) is None


def test_it_acts_where_it_is_asked_for_alone() -> None:
    assert tissue_alone.tissue_alone(grasp(), CLOSING) is not None
    assert tissue_alone.tissue_alone(grasp(guess="compression"), CLOSING) is None


def test_the_result_says_what_the_case_chooses_of_the_solver(led: Run, compressed: Run) -> None:
    begun = "solver.first_guess: Newton begins in the tissue without its inclusions, if that converges"
    assert begun in led.assumptions
    assert "solver.balance: unbalanced forces of up to 0.0001 of the largest nodal force" in led.assumptions
    assert not any("first_guess" in one for one in compressed.assumptions)


@pytest.mark.parametrize(
    "error", [ConvergenceError("lost", []), Collapsed("an element is nearly inside out")], ids=["lost", "crushed"]
)
def test_tissue_that_newton_does_not_find_is_done_without(error: Unfinished, monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(*_arguments: Any, **_settings: Any) -> Any:
        raise error

    experiment = grasp()
    model = grasp_model(experiment, grasp_mesh(experiment))
    rest = model.start(experiment.contact, regularisation(experiment))
    monkeypatch.setattr(GraspModel, "equilibrium", lost)
    guess = path._first_guess(experiment, model, rest, CLOSING)
    assert guess.state is rest
    assert np.array_equal(guess.unknowns, model.compressed(FIRST_PART * CLOSING))


def test_forces_are_balanced_as_exactly_as_the_case_asks(led: Run) -> None:
    exact = Run(grasp(solver={"first_guess": "tissue"}))
    assert exact.residual <= 1e-10 < led.residual <= 1e-4
    assert np.abs(led.taxels - exact.taxels).max() < 1e-5 * exact.taxels.max()


def test_a_balance_that_says_nothing_is_refused() -> None:
    with pytest.raises(CaseError, match=r"solver\.balance"):
        grasp(solver={"balance": 0.5})
