"""Writing and reading the folder of a result."""

from __future__ import annotations

import json
import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pretence import PNG, pretended_result

from tactsim.errors import StorageError
from tactsim.results import Result, Status, StepRecord, read_result, write_result
from tactsim.results.reading import read_basis
from tactsim.results.writing import history_table

RECORDS = tuple(StepRecord(k, 4, 1e-11, {"displacement": k * 1e-4, "reaction_force": k * 0.5}) for k in (1, 2))
RESULT = pretended_result(Status.CONVERGED, "done", RECORDS)
ORIGIN = {"seed": None, "case": {"title": "A case"}}


def test_the_folder_holds_what_the_contract_names(tmp_path: Path) -> None:
    place = write_result(RESULT, tmp_path / "out", case_id="abc", provenance=ORIGIN, figures={"press.png": PNG})
    names = ["fields.pvd", "fields_0001.vtu", "fields_0002.vtu", "figures", "history.csv", "manifest.json"]
    names += ["provenance.json", "result.json"]
    assert sorted(os.listdir(place)) == names
    assert (place / "figures" / "press.png").read_bytes() == PNG
    assert json.loads((place / "provenance.json").read_text(encoding="utf-8")) == ORIGIN


def test_a_result_comes_back(tmp_path: Path) -> None:
    place = write_result(RESULT, tmp_path / "out", case_id="abc", provenance=ORIGIN)
    stored = read_result(place)
    assert (stored.case_id, stored.provenance) == ("abc", ORIGIN)
    assert stored.result.steps == RECORDS
    assert len(stored.result.frames) == 2
    assert read_result(place, fields=False).result.frames == ()
    np.testing.assert_array_equal(stored.result.quantities["taxel_force_upper"].value, np.arange(6.0).reshape(2, 3))


def test_a_result_says_which_of_its_files_were_changed(tmp_path: Path) -> None:
    place = write_result(RESULT, tmp_path / "out", case_id="abc", provenance=ORIGIN)
    assert read_result(place).complete.warnings == RESULT.warnings
    (place / "result.json").write_text((place / "result.json").read_text(encoding="utf-8").replace('"done"', '"well done"'))
    (place / "fields_0002.vtu").write_bytes((place / "fields_0001.vtu").read_bytes())
    lines = [f"{name} was changed since tactsim wrote it" for name in ("fields_0002.vtu", "result.json")]
    assert read_result(place).complete.warnings == (*RESULT.warnings, *lines)
    assert read_result(place, fields=False).complete.warnings == (*RESULT.warnings, lines[1])


def test_fields_that_are_gone_are_told(tmp_path: Path) -> None:
    place = write_result(RESULT, tmp_path / "out", case_id="abc", provenance=ORIGIN)
    (place / "fields.pvd").unlink()
    assert read_result(place).complete.warnings == (
        *RESULT.warnings,
        "fields.pvd, which tactsim wrote, is gone: the result has no fields",
    )
    assert read_result(place, fields=False).complete.warnings == RESULT.warnings


def test_what_rests_on_a_changed_result_is_told(tmp_path: Path) -> None:
    place = write_result(RESULT, tmp_path / "out", case_id="abc", provenance=ORIGIN)
    assert read_basis(place).result.steps == RECORDS
    (place / "result.json").write_text((place / "result.json").read_text(encoding="utf-8").replace('"done"', '"well done"'))
    with pytest.warns(UserWarning, match=r"out: result\.json was changed since tactsim wrote it"):
        assert read_basis(place).result.reason == "well done"


def test_the_history_has_units_in_its_header_and_a_row_per_step() -> None:
    late = StepRecord(3, 9, math.inf, {"displacement": 3e-4, "reaction_force": math.nan, "ratio": 0.5})
    assert history_table(replace(RESULT, steps=(*RECORDS, late))).splitlines() == [
        "step,displacement [m],reaction_force [N],ratio,newton_iterations,residual",
        "1,0.0001,0.5,,4,1e-11",
        "2,0.0002,1.0,,4,1e-11",
        "3,0.0003,,0.5,9,",
    ]


def test_a_result_without_steps_can_be_written(tmp_path: Path) -> None:
    place = write_result(Result("k", Status.INTERRUPTED, "stopped"), tmp_path / "out", case_id="x", provenance={})
    assert read_result(place).result == Result("k", Status.INTERRUPTED, "stopped")


def test_an_earlier_result_gives_way_only_by_force(tmp_path: Path) -> None:
    write_result(RESULT, tmp_path / "out", case_id="1", provenance={})
    with pytest.raises(StorageError, match="--force"):
        write_result(RESULT, tmp_path / "out", case_id="2", provenance={})
    assert read_result(tmp_path / "out").case_id == "1"
    write_result(RESULT, tmp_path / "out", case_id="2", provenance={}, force=True)
    assert read_result(tmp_path / "out").case_id == "2"


def test_a_figure_stays_in_its_folder(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="not a plain file name"):
        write_result(RESULT, tmp_path / "out", case_id="x", provenance={}, figures={"../evil.png": b""})
    assert os.listdir(tmp_path) == []


def test_what_cannot_be_read_is_reported(tmp_path: Path) -> None:
    place = write_result(RESULT, tmp_path / "out", case_id="x", provenance={})
    for content in ("{", "[]", "[" * 100_000):
        (place / "provenance.json").write_text(content, encoding="utf-8")
        with pytest.raises(StorageError, match=r"provenance\.json is damaged"):
            read_result(place)
    (place / "provenance.json").unlink()
    with pytest.raises(StorageError, match=r"cannot read .*provenance\.json"):
        read_result(place)
    (place / "result.json").write_bytes(b"\xff")
    with pytest.raises(StorageError, match=r"cannot read .*result\.json"):
        read_result(place)
    (place / "result.json").unlink()
    with pytest.raises(StorageError, match=r"holds no result\.json"):
        read_result(place)
    with pytest.raises(StorageError, match="is not a folder"):
        read_result(tmp_path / "missing")
