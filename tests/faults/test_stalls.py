"""Paths that creep, and numbers in a case that would make a loop without bound."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import tactsim as ts
from tactsim.case import load_case
from tactsim.contact.penalty import Augmentation
from tactsim.errors import ConvergenceError, InputError, InvalidQuantity
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.paths.loading import PathFollower, StepControl
from tactsim.fem.paths.progress import MOST_FURTHER, MOST_STEPS, WINDOW
from tactsim.fem.paths.time_steps import TimeControl, TimeMarcher
from tactsim.results.result import Status
from tactsim.shipped import CASES


@dataclass(frozen=True)
class Point:
    """A scalar state; its place counts as load and as time."""

    load: float
    unknowns: np.ndarray
    iterations: int = 3

    @property
    def time(self) -> float:
        """The same number."""
        return self.load


START = Point(0.0, np.zeros(1), 0)


class Marsh:
    """Beyond 0.7 no step longer than ``reach`` converges."""

    def __init__(self, reach: float):
        self.reach, self.solutions = reach, 0

    def __call__(self, state: Point, load: float, guess: np.ndarray) -> Point:
        self.solutions += 3
        if load > 0.7 and load - state.load > self.reach:
            raise ConvergenceError("Newton did not converge", [1.0, 1.0, 1.0, 1.0])
        return Point(load, np.array([load]))


def follow(advance: Marsh, **control: float) -> list[Point]:
    lengths = {"first": 0.1, "largest": 0.4, "smallest": 1e-8} | control
    return [state for state, _ in PathFollower(advance, StepControl(**lengths)).follow(START, 1.0)]


def march(advance: Marsh, first: float = 0.1, largest: float = 0.4) -> list[Point]:
    marcher = TimeMarcher(advance, lambda now, state: 0.0, TimeControl(1.0, first=first, smallest=1e-8))
    return [state for state, _ in marcher.march(START, [0.5, 1.0], largest=largest)]


@pytest.mark.parametrize("path", [follow, march])
def test_a_path_that_creeps_is_given_up_with_what_it_reached_and_how_fast(path):
    marsh = Marsh(reach=1e-5)
    with pytest.raises(
        ConvergenceError,
        match=r"gave up at (0\.7\d* of 1|700\.\d* ms of 1 s), for there is hardly any headway: the last 1\d\d linear",
    ):
        path(marsh)
    assert marsh.solutions < MOST_FURTHER + 4 * WINDOW


@pytest.mark.parametrize("path", [follow, march])
def test_a_path_that_is_slow_but_gets_there_is_followed(path):
    assert path(Marsh(reach=5e-3))[-1].load == 1.0


@pytest.mark.parametrize("path", [follow, march])
def test_steps_that_begin_very_short_and_grow_are_no_stall(path):
    assert path(Marsh(reach=1.0), first=1e-30)[-1].load == 1.0


@pytest.mark.parametrize("path", [follow, march])
def test_short_steps_that_were_asked_for_are_no_stall(path):
    states = path(Marsh(reach=1.0), first=1e-3, largest=1e-3)
    assert len(states) >= 1000
    assert states[-1].load == 1.0


def test_cuts_without_end_are_a_stall():
    with pytest.raises(ConvergenceError, match=r"gave up at 0\.7 of 1, for there is hardly any headway"):
        follow(Marsh(reach=0.0), smallest=1e-300)


@pytest.mark.parametrize("path", [follow, march])
def test_too_many_steps_are_refused(path):
    with pytest.raises(InvalidQuantity, match=rf"asks for 1e\+06 steps; allowed: up to {MOST_STEPS}"):
        path(Marsh(reach=1.0), first=1e-6, largest=1e-6)


RAMP = "{kind: ramp, to: 1 mm, duration: 1 s}"


@pytest.mark.parametrize(
    ("name", "setting", "message"),
    [
        ("annulus_icf", "experiment.steps={first: 1e-30 m}", r"steps\.first: .* is lost in round-off; allowed: at least 8 pm"),
        ("annulus_icf", "experiment.steps={first: 10 nm, largest: 10 nm}", r"steps\.largest 10 nm asks for 8e\+05 steps"),
        (
            "grasp_plain",
            f"experiment.loading.pieces=[{RAMP}, {{kind: sine, amplitude: 0.1 mm, frequency: 1e30 Hz, duration: 1 s}}]",
            r"pieces\.1: frequency .* makes 1e\+30 periods; allowed: up to 10000",
        ),
        ("atrial_annulus_sine", "experiment.loading.pieces.1.frequency=1e6 Hz", r"periods; allowed: up to 10000"),
        ("grasp_artery_pulse", "experiment.inclusions.0.lumen.rate=1e300 Hz", r"rate"),
        ("grasp_artery_pulse", "experiment.loading.pieces.0.duration=1e9 s", r"lumen: rate: .* periods; allowed: up to 10000"),
        (
            "sweep",
            "[" + ", ".join(["{kind: hold, duration: 1 s}"] * 20) + "]",
            r"points: 2e\+06 times in all pieces; allowed: up to 1e\+06",
        ),
    ],
)
def test_numbers_that_would_loop_without_bound_are_refused(name: str, setting: str, message: str, tmp_path: Path):
    if name == "sweep":
        text = (
            "schema: tactsim/case/1\nexperiment:\n  kind: closed_form\n  material: atrial\n  points: 100000\n"
            f"  loading: {{control: force, pieces: {setting}}}\n"
        )
        path, settings = tmp_path / "case.yaml", []
        path.write_text(text, encoding="utf-8")
    else:
        path, settings = CASES / f"{name}.yaml", [setting]
    with pytest.raises(InputError, match=message):
        load_case(path, settings)


def test_a_course_of_too_many_steps_is_refused_before_the_first_one():
    coarse = "experiment.mesh={kind: structured, cells: [2, 2, 2]}"
    sine = "{kind: sine, amplitude: 0.1 mm, frequency: 9 kHz, duration: 1 s}"
    case = load_case(CASES / "grasp_plain.yaml", [coarse, f"experiment.loading.pieces=[{RAMP}, {sine}]"])
    with pytest.raises(InvalidQuantity, match=r"loading, with the steps .* asks for 7\.2e\+04 steps; allowed: up to 50000"):
        case.experiment.run()


def test_a_contact_whose_multipliers_overshoot_becomes_stiffer_for_a_step():
    usual = Augmentation(tolerance=6e-6, softest=1e3, switch_length=1e-3, softness=30e-6)
    stiffer = [usual]
    while stiffer[-1].stiffer() != stiffer[-1]:
        stiffer.append(stiffer[-1].stiffer())
    np.testing.assert_allclose([one.softness for one in stiffer], [30e-6, 15e-6, 7.5e-6, 3.75e-6, 3e-6])
    assert stiffer[-1].after_step_from(usual) == usual
    sharp = replace(usual, softness=1e-6)
    assert sharp.stiffer() == sharp, "a contact that needs no multipliers stays as it is"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "settings"),
    [
        (
            "grasp_plain",
            (
                "experiment.block={size: [52 mm, 46 mm, 14.6 mm], tissue: b1a_stable}",
                "experiment.contact.friction=0.37",
                "experiment.loading.pieces.0.to=1.0074 mm",
                "experiment.mesh={kind: graded}",
                "experiment.time.steps=2",
            ),
        ),
        ("grasp_artery_icf", ("experiment.loading.pieces.0.to=2.12 mm",)),
    ],
)
def test_grasps_that_crept_end(name: str, settings: tuple[str, ...], monkeypatch: pytest.MonkeyPatch):
    solved, spent = Problem.solve, []

    def counted(problem: Problem, *arguments: object, **options: object) -> object:
        try:
            computed = solved(problem, *arguments, **options)  # type: ignore[arg-type]
        except ConvergenceError as error:
            spent.append(error.solutions)
            raise
        spent.append(computed.iterations)
        return computed

    monkeypatch.setattr(Problem, "solve", counted)
    result = load_case(CASES / f"{name}.yaml", list(settings)).experiment.run()
    assert sum(spent) < MOST_FURTHER
    if result.status is not Status.CONVERGED:
        assert result.status is Status.FAILED
        assert re.search("gave up at|has kept .* of its volume, and no step leads on", result.reason)
        assert result.steps[-1].values["displacement"] > 0.5e-3


def test_a_first_step_longer_than_the_way_leaves_shorter_ones():
    specimen = ts.Specimen(material="icf_stable", thickness="4 mm", radius="8 mm")
    press = ts.Indentation(
        specimen=specimen,
        recess="0.8 mm",
        displacement="0.3 mm",
        stop="displacement",
        steps={"first": "1 m"},
        mesh={"refinement": 0.5},
    )
    control = press.control()
    assert control.first == control.largest == press.displacement
    assert control.smallest < 1e-3 * press.displacement
    assert press.run().status == "converged"
