"""The table of section 6.6: its numbers on invented grasps, findings that can fail, and one simulated pair."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from thesis_tables import MANIFEST, TABLE, shipped_table, shipped_tables, write_tables
from wrong_rows import misjudged

from tactsim.errors import CaseError, InputError, InvalidQuantity, UnknownName
from tactsim.shipped import CASES
from tactsim.validation import compare, load_tables
from tactsim.validation.endings import Confirmed
from tactsim.validation.execution import StudyRunner, Task, simulated
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.grasp import taxel_asymmetry, taxel_change, taxel_contrast, taxel_history, taxel_pulse
from tactsim.validation.report import CLASSES, Validation, count_rows, table_text
from tactsim.validation.study import RunOutcome, Study
from tactsim.validation.table import Row, Table

SHIPPED = CASES / "thesis"
CLAIM = "ends: {kind: confirmed, above: 100 N/m, why: a force that is felt}"


def table_6_6() -> Table:
    return shipped_table("section_6_6")


def grasp(name: str, upper: np.ndarray, lower: np.ndarray | None = None, *, status: str = "converged") -> RunOutcome:
    """A pretended grasp with forces (steps, rows, columns) in N on its taxels, one step a second, closed to 1 mm."""
    sides = {"upper": upper, "lower": upper if lower is None else lower}
    history = {
        f"taxel_force_{side}_{row + 1}_{column + 1}": tuple(map(float, forces[:, row, column]))
        for side, forces in sides.items()
        for row, column in np.ndindex(forces.shape[1:])
    }
    history["time"] = tuple(float(step) for step in range(len(upper)))
    history["displacement"] = tuple(1e-3 * (step + 1) / len(upper) for step in range(len(upper)))
    return RunOutcome(id=name, case_id=name, status=status, reason="end", quantities={}, history=history, seconds=1)


def middle(force: float) -> np.ndarray:
    """Two steps of a 3 x 3 matrix in N: nothing, then even forces of 1 N and this one in the middle."""
    forces = np.ones((2, 3, 3))
    forces[0], forces[1, 1, 1] = 0.0, force
    return forces


def inputs(**runs: np.ndarray) -> Inputs:
    """A study ``s`` of pretended grasps by name."""
    return Inputs(studies={"s": tuple(grasp(name, forces) for name, forces in runs.items())})


def test_the_table_is_counted() -> None:
    assert shipped_tables("thesis", "section_6_6").faults == ()
    table = table_6_6()
    used = {name for row in table.rows if row.evaluate for name in _runs_of(row.evaluate.model_dump())}
    simulated = {run.id for study in table.studies for run in study.runs}
    assert simulated == used, "every run serves a row, every row has its runs"


def _runs_of(arguments: dict) -> set[str]:
    return {name for name in (*arguments.get("runs", ()), *arguments.get("bases", ()), arguments.get("run")) if name}


def test_a_history_has_rows_and_columns_in_their_places() -> None:
    forces = np.arange(12.0).reshape(2, 2, 3)
    np.testing.assert_array_equal(taxel_history(grasp("a", forces), "lower"), forces)
    np.testing.assert_array_equal(taxel_history(grasp("a", forces, -forces), "lower"), -forces)
    with pytest.raises(InputError, match="no taxels"):
        taxel_history(grasp("a", forces).model_copy(update={"history": {}}), "lower")


def change(studies: Inputs, runs: Sequence[str], which: Any, **others: Any) -> float:
    """A change in the study ``s``."""
    return taxel_change(studies, "s", which, tuple(runs), **others)


def test_the_least_and_the_greatest_change_have_a_sign() -> None:
    rising = inputs(a=middle(1.0), b=middle(1.5), c=middle(1.7), d=middle(2.7))
    turning = inputs(a=middle(1.0), b=middle(1.5), c=middle(1.4), d=middle(2.7))
    assert change(rising, "abcd", "least along") == pytest.approx(0.2, rel=1e-12)  # round-off
    assert change(rising, "abcd", "greatest along") == pytest.approx(1.0, rel=1e-12)
    assert change(turning, "abcd", "least along") < 0
    assert change(rising, "bcd", "least from base", bases=("a",)) == pytest.approx(0.5, rel=1e-12)
    assert change(turning, "bc", "greatest from base", bases=("d",)) == pytest.approx(-1.2, rel=1e-12)
    assert change(rising, "abcd", "greatest along", taxel=(1, 1)) == 0


def test_what_the_meshes_differ_by_is_taken_off() -> None:
    """Plain blocks on the two meshes read 1 and 2 N: the body adds 0.5 N on the first and 0.2 N on the second."""
    studies = inputs(a=middle(1.5), b=middle(2.2), plain_a=middle(1.0), plain_b=middle(2.0))
    plain = ("plain_a", "plain_b")
    assert change(studies, "ab", "least along") > 0
    assert change(studies, "ab", "least along", bases=plain) == pytest.approx(-0.3, rel=1e-12)
    assert change(studies, "ab", "least from base", bases=plain) == pytest.approx(0.2, rel=1e-12)


def test_the_jaws_are_distinguished() -> None:
    studies = Inputs(studies={"s": (grasp("a", middle(2.0), middle(2.5)), grasp("b", middle(4.0), middle(3.0)))})
    computed = [change(studies, "ab", "least along", side=side) for side in ("upper", "lower", "upper less lower")]
    assert computed == [2.0, 0.5, 1.5]


def test_a_change_is_read_at_the_closing_asked_for() -> None:
    forces = middle(3.0)
    forces[0] = 2.0
    studies = inputs(a=forces, plain=middle(2.5))
    at = [change(studies, "a", "least from base", bases=("plain",), closing=closing) for closing in (None, 1e-3, 5e-4)]
    assert at == [0.5, 0.5, 2.0]
    with pytest.raises(InputError, match="no step of s, a ended at a closing of 700 µm"):
        change(studies, "a", "least from base", bases=("plain",), closing=7e-4)


@pytest.mark.parametrize(
    ("runs", "which", "bases", "message"),
    [
        ("ab", "least along", "abc", "3 bases for 2 runs"),
        ("a", "least from base", "", "no base"),
        ("a", "least along", "", "one run"),
    ],
)
def test_what_cannot_be_compared_is_refused(runs: str, which: str, bases: str, message: str) -> None:
    with pytest.raises(InvalidQuantity, match=message):
        change(Inputs(), runs, which, bases=tuple(bases))
    row = next(row for row in table_6_6().rows if getattr(row.evaluate, "kind", "") == "taxel_change")
    call = {"kind": "taxel_change", "study": "s", "runs": tuple(runs), "change": which, "bases": tuple(bases)}
    with pytest.raises(ValidationError, match=message):
        type(row).model_validate({**row.model_dump(), "evaluate": call})


def test_what_did_not_converge_or_is_not_there_is_reported() -> None:
    failed = Inputs(studies={"s": (grasp("a", middle(1.0)), grasp("b", middle(2.0), status="failed"))})
    with pytest.raises(InputError, match="s, b did not converge: end"):
        change(failed, "ab", "least along")
    with pytest.raises(UnknownName):
        change(failed, "ac", "least along")
    for place in ((0, 1), (4, 1), (1, 4)):
        with pytest.raises(InputError, match=r"of a matrix of 3 rows"):
            taxel_contrast(failed, "s", "a", taxel=place, others=((1, 1),))


@pytest.mark.parametrize(("mirror", "place"), [("left_right", (1, 2)), ("front_back", (2, 1)), ("upper_lower", (1, 1))])
def test_only_the_broken_symmetry_is_reported(mirror: str, place: tuple[int, int]) -> None:
    even, bent = middle(2.0), middle(2.0)
    bent[-1][place] += 0.1
    studies = Inputs(studies={"s": (grasp("even", even), grasp("bent", even, bent))})
    for name in ("left_right", "front_back", "upper_lower"):
        assert taxel_asymmetry(studies, "s", "even", name) == 0  # type: ignore[arg-type]
        computed = taxel_asymmetry(studies, "s", "bent", name)  # type: ignore[arg-type]
        assert (computed > 0) == (name in (mirror, "upper_lower"))
    largest = bent[-1].max()
    assert taxel_asymmetry(studies, "s", "bent", mirror) == pytest.approx(0.1 / largest, rel=1e-12)  # type: ignore[arg-type]


def test_a_taxel_reads_less_than_each_of_the_others() -> None:
    row = np.array([[[0.5, 0.9, 0.7]]])
    simulated = inputs(a=row, b=row[..., ::-1])
    assert taxel_contrast(simulated, "s", "a", taxel=(1, 1), others=((1, 2), (1, 3))) == pytest.approx(-0.2, rel=1e-12)
    assert taxel_contrast(simulated, "s", "b", taxel=(1, 1), others=((1, 2), (1, 3))) > 0


def test_the_change_of_a_pulse_leaves_out_what_came_before() -> None:
    steps = np.zeros((4, 1, 2))
    steps[:, 0, 0], steps[:, 0, 1] = (9.0, 0.1, 0.4, 0.2), (0.0, 0.3, 0.35, 0.3)
    assert taxel_pulse(inputs(a=steps), "s", "a", 1.0) == pytest.approx(0.3, rel=1e-12)
    assert taxel_pulse(inputs(a=steps), "s", "a", 0.0) > 1
    with pytest.raises(InputError, match="a change needs two"):
        taxel_pulse(inputs(a=steps), "s", "a", 3.0)


def claim(folder: Path, ends: str) -> list:
    text = TABLE.split("  - id: known", maxsplit=1)[0].replace("    expected: 125 N/m\n", "")
    recorded = "    ends: {kind: reproduced, within: {relative: 0.001, reason: a quotient}}"
    folder = write_tables(folder, text.replace(recorded, f"    {ends}"), MANIFEST.replace("small: 3", "small: 1"))
    loaded = load_tables(folder)
    outcome = compare("small", loaded.tables["small"], folder, {})
    counts = dict(zip(("chapter", "table", "rows", *CLASSES), count_rows(Validation(loaded, (outcome,)))[0], strict=True))
    assert (counts["confirmed"], counts["left"]) in ((1, 0), (0, 1))
    assert "100 N/m" in table_text(outcome)
    return list(outcome.rows)


def test_a_claim_holds_on_its_side_of_the_limit_only(tmp_path: Path) -> None:
    (row,) = claim(tmp_path, CLAIM)  # 125 N/m are computed
    assert (row.held, row.ended, row.reason) == (True, "confirmed, above 100 N/m", "a force that is felt")
    (row,) = claim(tmp_path, CLAIM.replace("above", "below"))
    assert (row.held, row.ended) == (False, "LEFT: was confirmed, below 100 N/m")


@pytest.mark.parametrize(
    ("ends", "message"),
    [
        ("ends: {kind: confirmed, above: 1 N/m, below: 2 N/m, why: both}", "either above or below"),
        ("ends: {kind: contradicted, why: neither}", "either above or below"),
        ("ends: {kind: confirmed, above: 100, why: bare}", "has no unit"),
        ("ends: {kind: confirmed, above: 100 N, why: wrong}", "wrong dimension"),
        ("ends: {kind: not_testable, why: evaluated}", "what is evaluated is testable"),
        ("ends: {kind: regression_bound, above: 1 N/m, why: not own}", "ends as a regression"),
        ("ends: {kind: transcribed, why: nothing to read}", "needs what is expected"),
    ],
)
def test_a_bad_ending_is_reported(tmp_path: Path, ends: str, message: str) -> None:
    with pytest.raises(CaseError, match=message):
        claim(tmp_path, ends)


def test_a_claim_that_calls_nothing_is_refused() -> None:
    row = next(row for row in table_6_6().rows if isinstance(row.ends, Confirmed))
    with pytest.raises(ValidationError, match="only what is not testable may lack how it is evaluated"):
        type(row).model_validate({**row.model_dump(by_alias=True), "evaluate": None})


def check(rows: Sequence[Row], outcomes: Callable[[Sequence[Study]], Mapping[str, tuple[RunOutcome, ...]]]) -> None:
    """Runs the studies that the rows need; each must hold, and must not hold if it is made wrong."""
    needed = {name for row in rows if row.evaluate for name in _runs_of(row.evaluate.model_dump())}
    studies = [
        study.model_copy(update={"runs": kept})
        for study in table_6_6().studies
        if (kept := tuple(run for run in study.runs if run.id in needed))
    ]
    inputs = Inputs(folder=SHIPPED, studies=outcomes(studies))
    assert misjudged(rows, inputs) == ([], [])


def in_one_step(studies: Sequence[Study]) -> Mapping[str, tuple[RunOutcome, ...]]:
    return {
        study.name: tuple(
            simulated(Task(run.id, str(SHIPPED / study.case), (*study.overrides(run), "experiment.time.steps=1")))
            for run in study.runs
        )
        for study in studies
    }


def test_the_row_of_one_short_simulation_holds() -> None:
    check([row for row in table_6_6().rows if row.id.startswith("symmetry.ball")], in_one_step)


@pytest.mark.slow
def test_every_row_holds_and_none_that_is_wrong() -> None:
    """Simulations come from the user's cache if the code that makes them is the same."""

    def kept(studies: Sequence[Study]) -> Mapping[str, tuple[RunOutcome, ...]]:
        ((_, outcomes),) = StudyRunner().outcomes({"section_6_6": studies}, SHIPPED, lambda line: None)
        return outcomes

    check(table_6_6().rows, kept)
