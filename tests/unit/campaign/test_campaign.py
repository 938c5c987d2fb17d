"""The campaign: cases are functions of seed and number, and what contradicts itself is called wrong."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from campaign.contradictions import contradictions
from campaign.families import MADE, all_families, random_case
from campaign.record import as_line, first_runs, last_runs, read_record
from campaign.report import page
from campaign.trials import PATIENCE, Ended, Running, Trial, judged, tried

from tactsim.case import load_case
from tactsim.case.writing import yaml_text
from tactsim.results import document, writing
from tactsim.results.result import Result
from tactsim.units import parse_quantity

GOOD = {"status": "converged", "reason": "done", "quantities": {"force": {"value": 1.0}}}


@pytest.mark.parametrize("family", [*MADE, "film_test", "sensor_response"])
def test_a_case_is_a_function_of_seed_and_number_and_is_accepted(tmp_path: Path, family: str) -> None:
    assert random_case(family, 1, 5) == random_case(family, 1, 5)
    assert len({yaml_text(random_case(family, 1, number)) for number in range(8)}) == 8
    for number in range(8):
        path = tmp_path / f"{number}.yaml"
        path.write_text(yaml_text(random_case(family, 2, number)), encoding="utf-8")
        assert load_case(path).experiment.kind == MADE.get(family, (family, None))[0]


def test_every_kind_that_needs_no_file_is_tried() -> None:
    assert {"grasp", "indentation", "indentation_3d", "timed_indentation", "boundary_value_problem"} <= set(all_families())


def place(folder: Path, result: dict | None, words: str = "") -> Path:
    (folder / "result").mkdir(exist_ok=True)
    (folder / "stderr").write_text(words, encoding="utf-8")
    if result is not None:
        (folder / "result" / "result.json").write_text(json.dumps(result), encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("code", "result", "words", "outcome"),
    [
        (0, GOOD, "", "converged"),
        (3, GOOD | {"status": "failed", "reason": "gave up"}, "", "failed with reason"),
        (3, GOOD | {"status": "failed", "reason": "took longer than the 60 s that it was given"}, "", "stopped by time"),
        (3, GOOD | {"status": "failed", "reason": "the threshold was not reached within 1 mm"}, "", "no threshold"),
        (2, None, "error: a word", "refused"),
        (2, None, "", "wrong"),
        (1, None, "error: internal error", "wrong"),
        (0, GOOD | {"status": "failed"}, "", "wrong"),
        (0, None, "", "wrong"),
        (0, GOOD, "Traceback (most recent call last):", "wrong"),
        (0, GOOD | {"quantities": {"force": {"value": float("inf")}}}, "", "wrong"),
    ],
)
def test_what_contradicts_itself_is_wrong(tmp_path: Path, code: int, result: dict | None, words: str, outcome: str) -> None:
    assert judged(code, place(tmp_path, result, words))[0] == outcome


QUANTITIES = {
    "displacement": 1e-3,
    "reaction_force": 3.75,
    "jaw_force_upper": [0.1, 0.0, 3.75],
    "taxel_force_upper": [[1.0, 2.0]],
    "gap_force_upper": 0.5,
    "outside_force_upper": 0.25,
    "jaw_force_lower": [-0.1, 0.0, -3.75],
    "taxel_force_lower": [[2.0, 1.0]],
    "gap_force_lower": 0.5,
    "outside_force_lower": 0.25,
    "base_force": 3.75,
    "min_volume_ratio": 0.9,
    "max_penetration": 1e-6,
    "penetration_force_error": 1e-3,
}
"""Of a grasp, and what an indentation has beside it."""
GRASP = {"kind": "grasp", "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": "1 mm"}]}}


def found(
    changes: dict, steps: list[dict] = (), reason: str = "done", experiment: dict | None = None, scene: dict | None = None
) -> list[str]:
    quantities = {name: {"value": value} for name, value in {**QUANTITIES, **changes}.items()}
    return contradictions({"quantities": quantities, "steps": steps, "reason": reason, "scene": scene or {}}, experiment)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        (
            {"reaction_force": 3.76, "base_force": 3.76},
            "taxels, gaps and outside of the upper jaw are 3.75 N, the reaction 3.76 N",
        ),
        ({"gap_force_lower": 0.4}, "taxels, gaps and outside of the lower jaw are 3.65 N, the force on that jaw 3.75 N"),
        ({"jaw_force_upper": [0.2, 0.0, 3.75]}, "the upper jaw presses along x with 0.2 N, the lower one against it with 0.1 N"),
        ({"base_force": 3.7}, "the body presses with 3.75 N, the base against it with 3.7 N"),
        ({"outside_force_upper": None}, "outside_force_upper: not finite"),
        ({"taxel_force_upper": [[1.0, None]]}, "taxel_force_upper 1 2: not finite"),
        ({"min_volume_ratio": -0.1}, "a volume ratio of -0.1"),
        ({"max_penetration": 1e-4}, "a penetration of 0.0001 m at a displacement of 0.001 m"),
        ({"penetration_force_error": 0.02}, "penetration takes away 2.00% of the force"),
        ({"displacement": 0.9e-3}, "a displacement of 0.0009 m where the case asks for 0.001 m"),
        ({"threshold_force": -1.0}, "a threshold force that pulls"),
    ],
)
def test_a_wrong_number_of_a_converged_result_is_seen(changes: dict, fault: str) -> None:
    assert found({}, experiment=GRASP) == []
    assert found(changes, experiment=GRASP) == [fault]


def test_taxels_of_a_jaw_that_leans_carry_what_presses_across_its_face() -> None:
    across = np.array([np.cos(0.02) * np.sin(-0.03), -np.sin(0.02), np.cos(0.02) * np.cos(-0.03)])  # of z, turned about x, then y
    along = np.cross(across, [1.0, 0.0, 0.0])
    pulled = 3.75 * across + 0.5 * along
    forces = {"jaw_force_upper": pulled.tolist(), "jaw_force_lower": (-pulled).tolist()}
    assert found(forces, scene={"jaws": {"lower": {"tilt_x": 0.02, "tilt_y": -0.03}}}) == []
    (fault,) = found(forces)
    assert fault.startswith("taxels, gaps and outside of the lower jaw are 3.75 N, the force on that jaw 3.7")


def test_the_base_carries_what_the_inner_sensor_presses_too() -> None:
    assert found({"sensor_force": 0.25, "base_force": 4.0}) == []
    assert found({"sensor_force": 0.25}) == ["the body presses with 4 N, the base against it with 3.75 N"]


def test_a_number_of_a_step_that_is_not_finite_is_seen() -> None:
    steps = [{"step": 1, "values": {"gap_force_upper": 1.0}}, {"step": 2, "values": {"gap_force_upper": None}}]
    assert found({}, steps) == ["step 2 gap_force_upper: not finite"]


def test_an_indentation_that_ends_before_its_displacement_is_seen_and_one_at_its_threshold_is_none() -> None:
    asked = {"kind": "indentation", "displacement": "2 mm"}
    assert found({}, reason="displacement reached", experiment=asked) == [
        "a displacement of 0.001 m where the case asks for 0.002 m"
    ]
    assert found({}, reason="threshold reached", experiment=asked) == []


def test_the_closing_that_a_hold_keeps_is_asked_for_and_none_after_a_sine() -> None:
    hold, sine = (
        {"kind": "hold", "duration": "2 s"},
        {"kind": "sine", "amplitude": "0.1 mm", "frequency": "1 Hz", "duration": "2 s"},
    )
    for last, faults in ((hold, 1), (sine, 0)):
        pieces = [*GRASP["loading"]["pieces"], last]
        asked = {**GRASP, "loading": {"control": "displacement", "pieces": pieces}}
        assert len(found({"displacement": 0.9e-3}, experiment=asked)) == faults


@pytest.mark.parametrize("family", ["indentation", "indentation_3d", "layered_indentation", "posed_indentation"])
def test_the_displacement_that_a_family_asks_for_is_read_in_its_unit(family: str) -> None:
    asked = random_case(family, 1, 0)["experiment"]
    moved = parse_quantity(asked["displacement"], "m")
    assert found({"displacement": moved}, reason="displacement reached", experiment=asked) == []
    (fault,) = found({"displacement": 0.99 * moved}, reason="displacement reached", experiment=asked)
    assert fault.endswith(f"where the case asks for {moved:g} m")


def test_a_solver_that_writes_no_number_is_called_wrong(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = document.document_text

    def broken(result: Result, case_id: str) -> str:
        name, quantity = next(iter(result.quantities.items()))
        lost = replace(quantity, value=float("nan"))
        return text(replace(result, quantities={**result.quantities, name: lost}), case_id)

    monkeypatch.setattr(writing, "document_text", broken)
    outcome = tried(Trial("film_test", 1, 0, 60.0), tmp_path)
    assert outcome.outcome == "wrong"
    assert outcome.reason.endswith("not finite")


def test_a_trial_runs_the_command_and_keeps_its_case(tmp_path: Path) -> None:
    ended = tried(Trial("film_test", 1, 0, 60.0), tmp_path)
    assert (ended.outcome, ended.number) == ("converged", 0)
    assert (tmp_path / "film_test_0" / "case.yaml").is_file()


def test_a_design_with_a_displacement_for_each_of_its_variants_is_judged(tmp_path: Path) -> None:
    assert tried(Trial("annulus_design", 4021, 0, 60.0), tmp_path).outcome == "converged"


def test_a_trial_whose_judge_fails_kills_no_other_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("campaign.trials.judged", lambda *_: 1 / 0)
    running = Running(Trial("film_test", 1, 0, 60.0), tmp_path)
    until = time.monotonic() + 60
    with pytest.raises(ZeroDivisionError):
        _ = [running.ended() for _ in iter(time.monotonic, until) if not time.sleep(0.02)]
    killed: list[int] = []
    monkeypatch.setattr("campaign.trials.os.kill", lambda child, _: killed.append(child))
    running.kill()
    assert not killed


def ended(number: int, outcome: str, kind: str = "grasp", program: str = "a") -> Ended:
    return Ended(kind, 1, number, outcome, f"because of | {number}", 2.0, 1.5, program)


def test_a_record_is_read_back_and_a_line_cut_short_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "trials.jsonl"
    assert read_record(path) == []
    path.write_text(as_line(ended(0, "converged")) + as_line(ended(1, "wrong")) + '{"kind": "gra', encoding="utf-8")
    assert read_record(path) == [ended(0, "converged"), ended(1, "wrong")]
    assert len(path.read_text(encoding="utf-8").splitlines()) == 2


def test_first_and_last_runs_of_a_case_are_kept_apart() -> None:
    record = [ended(0, "failed with reason"), ended(1, "converged"), ended(0, "converged", program="b")]
    assert first_runs(record) == record[:2]
    assert last_runs(record)["grasp", 0] == record[2]


def test_the_page_shows_shares_with_intervals_reasons_and_what_came_of_the_failed_ones() -> None:
    record = [ended(number, "converged") for number in range(9)] + [ended(9, "failed with reason"), ended(10, "refused")]
    text = page(record, asked=1000, limit=900.0, patience=30.0)
    assert "11 of 1000 asked of the kind `grasp`" in text
    assert "| grasp | 11 | 9 | 0 | 1 | 1 | 0 | 0 | 0 | 90.0 % [59.6 %, 98.2 %] |" in text  # Wilson's by hand for 9 of 10
    assert "| grasp 9 | failed with reason | 2 | because of \\| 9 |  |" in text
    assert "run again\n" not in text
    again = page([*record, ended(9, "converged", program="b")], asked=1000, limit=900.0, patience=30.0)
    assert "| grasp 9 | failed with reason | 2 | because of \\| 9 | converged |" in again
    assert "| grasp | 1 | 1 | 0 | 0 | 0 | 0 | 0 | 0 | 100.0 % [20.7 %, 100.0 %] |" in again
    assert "`b` (1 cases)" in again


def test_the_stored_page_is_that_of_the_stored_record() -> None:
    folder = Path(__file__).parents[3] / "docs" / "verification"
    text = (folder / "campaign.md").read_text(encoding="utf-8")
    assert text == page(read_record(folder / "campaign.jsonl"), asked=1000, limit=900.0, patience=PATIENCE)


def test_a_child_that_does_not_end_is_killed_and_counts_as_hung(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("campaign.trials.PATIENCE", 0.1)
    monkeypatch.setattr("campaign.trials._command", lambda *_: time.sleep(60))
    hung = tried(Trial("film_test", 1, 0, 0.1), tmp_path)
    assert hung.outcome == "hung"
    assert hung.seconds < 30
