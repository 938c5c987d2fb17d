"""The table of chapter 5: rows without finite elements hold, none that is made wrong does; and its functions."""

from __future__ import annotations

import numpy as np
import pytest
from thesis_tables import shipped_table
from wrong_rows import misjudged

from tactsim.errors import InputError
from tactsim.shipped import CASES
from tactsim.validation.execution import Task, simulated
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.probe import Press, probe_contact_depth, probe_force_ratio, switch_mean_rate
from tactsim.validation.study import RunOutcome
from tactsim.validation.table import Row

SHIPPED = CASES / "thesis"
SOLVED = ("finite_elements", "tissues_fem")
"""Studies that take minutes."""


@pytest.fixture(scope="module")
def inputs() -> Inputs:
    """The studies of the fast model, computed."""
    studies = {
        study.name: tuple(simulated(Task(run.id, str(SHIPPED / study.case), study.overrides(run))) for run in study.runs)
        for study in shipped_table("chapter_5").studies
        if study.name not in SOLVED
    }
    return Inputs(folder=SHIPPED, studies=studies)


def without_finite_elements(row: Row) -> bool:
    return row.evaluate is None or not any(name in row.evaluate.model_dump_json() for name in SOLVED)


def test_rows_hold_without_finite_elements(inputs: Inputs) -> None:
    every = shipped_table("chapter_5").rows
    rows = [row for row in every if without_finite_elements(row)]
    assert len(rows) == len(every) - 13
    assert misjudged(rows, inputs) == ([], [])


def touch(force: float) -> RunOutcome:
    """A pretended way in and back, the force proportional to the depth on the way in and nothing on the way back."""
    depth = np.array([0.0, 2.5e-3, 5e-3, 2.5e-3, 0.0])
    history = {"tissue": np.ones(5), "rate": np.full(5, 1e-3), "depth": depth, "force": force * depth * (np.arange(5) < 3)}
    values = {name: tuple(column.tolist()) for name, column in history.items()}
    return RunOutcome(id="r", case_id="r", status="converged", reason="end", quantities={}, history=values, seconds=0.0)


def test_a_ratio_is_taken_on_the_way_in() -> None:
    press, touched = Press(tissue=1, rate=1e-3), touch(2.0)

    def ratio(over: Press = press, depth: float = 1.2e-3, outcome: RunOutcome = touched) -> float:
        return probe_force_ratio(Inputs(studies={"s": (outcome,)}), "s", "r", press, over, depth=depth)

    assert ratio() == 1.0
    for other in ({"tissue": 2, "rate": 1e-3}, {"tissue": 1, "rate": 2e-3}):
        with pytest.raises(InputError, match="no touch of tissue"):
            ratio(over=Press(**other))
    with pytest.raises(InputError, match="down to"):
        ratio(depth=6e-3)
    with pytest.raises(InputError, match="gave up"):
        ratio(outcome=touched.model_copy(update={"status": "failed", "reason": "gave up"}))


def test_coarse_sampling_misses_the_rate_by_its_step() -> None:
    coarse = switch_mean_rate(rate=0.97e-3, sampling_rate=20.0)
    assert coarse == pytest.approx(0.97e-3, rel=0.02)
    assert coarse != pytest.approx(0.97e-3, rel=1e-4)


def test_the_depth_of_a_contact_is_that_of_its_first_sample_and_the_one_before() -> None:
    heights = (0.0, 0.4e-3, 1.4e-3, 0.2e-3, 0.0)
    touched = touch(2.0)
    touched = touched.model_copy(update={"history": {**touched.history, "contact_height": heights}})

    def depth(height: float, outcome: RunOutcome = touched) -> float:
        return probe_contact_depth(Inputs(studies={"s": (outcome,)}), "s", "r", height)

    assert depth(0.2e-3) == pytest.approx(1.25e-3, rel=1e-12)  # on the way in; round-off
    assert depth(0.9e-3) == pytest.approx(3.75e-3, rel=1e-12)
    with pytest.raises(InputError, match=r"no contact up to 1\.5 mm above the face"):
        depth(1.5e-3)
    with pytest.raises(InputError, match="gave up"):
        depth(1e-3, touched.model_copy(update={"status": "failed", "reason": "gave up"}))
