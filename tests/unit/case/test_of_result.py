"""A result is a case, too: the one that it was computed from."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import tactsim as ts
from tactsim.cli import main
from tactsim.errors import CaseError, StorageError

STORED = Path(__file__).parents[3] / "docs" / "gallery" / "stored"
RESULTS = sorted(path.parent.name for path in STORED.glob("*/provenance.json"))


@pytest.mark.parametrize("name", RESULTS)
def test_the_case_of_a_result_is_the_case_that_was_run(name):
    kept = json.loads((STORED / name / "provenance.json").read_text(encoding="utf-8"))
    assert ts.load_case(STORED / name).case_id == kept["case_id"]


def test_overrides_apply_to_it(tmp_path):
    case = ts.load_case("annulus_dynamic_load")
    case.run(None).save(tmp_path / "first")
    again = ts.load_case(tmp_path / "first", {"experiment.outer_radius": "4 mm"})
    assert again.experiment == case.experiment.model_copy(update={"outer_radius": 4e-3})
    with pytest.raises(CaseError, match=r"experiment\.outer_radiu: unknown key"):
        ts.load_case(tmp_path / "first", {"experiment.outer_radiu": "4 mm"})


def test_the_command_runs_it_again(tmp_path):
    assert main(["run", "annulus_dynamic_load", "--out", str(tmp_path / "first"), "--quiet", "--figures", "none"]) == 0
    options = ["--set", "experiment.outer_radius=4 mm", "--out", str(tmp_path / "second"), "--quiet", "--figures", "none"]
    assert main(["run", str(tmp_path / "first"), *options]) == 0
    first, second = (ts.load_result(tmp_path / name) for name in ("first", "second"))
    assert second["largest_displacement"].value != pytest.approx(first["largest_displacement"].value, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        (lambda kept: kept.pop("case"), StorageError, "is damaged: it holds no case"),
        (
            lambda kept: kept["case"]["experiment"].update(kind="elsewhere"),
            CaseError,
            "read the case of the result: unknown",
        ),
        (lambda kept: kept["case"]["experiment"].update(radius=-1.0), CaseError, "cannot read the case of the result"),
    ],
)
def test_a_case_that_cannot_be_read_is_refused(tmp_path, change, error, words):
    shutil.copytree(STORED / "timed_indentation", tmp_path / "one")
    place = tmp_path / "one" / "provenance.json"
    kept = json.loads(place.read_text(encoding="utf-8"))
    change(kept)
    place.write_text(json.dumps(kept), encoding="utf-8")
    with pytest.raises(error, match=words):
        ts.load_case(tmp_path / "one")
