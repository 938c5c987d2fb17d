"""Made-up grasps of a store, counted by their true and their estimated class."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_grasps import CLOSINGS, LAYOUT, TEXT, made_forces, made_store, plain_result, response, sum_up, truths

from tactsim.cli.entry import main
from tactsim.dataset.ranking import confusion
from tactsim.dataset.ranking.confusion import as_text, record, store_confusion, verdict
from tactsim.dataset.ranking.samples import judged_samples
from tactsim.dataset.store.opening import Store
from tactsim.errors import InputError, StorageError
from tactsim.experiments.localization.confusion import ConfusionTable
from tactsim.localization.estimators.hypotheses import HypothesesEstimator

CLOSING = float(CLOSINGS[-1])
QUIET = "0.1 mN"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Forty grasps that close alike, every eighth without a lump; four of them for the test, the first without one."""
    place = made_store(tmp_path_factory.mktemp("made"), response())
    store = Store.open(place, writing=True)
    group = store.group
    closed = tuple(replace(truth, closing=CLOSING) for truth in truths(40))
    group["closing"][...] = np.full(40, CLOSING)
    group["taxel_force"][...] = made_forces(closed, response())[:, None].astype(group["taxel_force"].dtype)
    store.array("split")[...] = np.where(np.arange(40) // 4 == 8, 2, 0)
    sum_up(place)
    return place


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> str:
    return plain_result(tmp_path_factory.mktemp("plain") / "plain")


def test_the_command_counts_and_writes(
    store: Path, plain: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(confusion, "stored_response", lambda reference: response())
    out = tmp_path / "table"
    command = ["data", "confusion", str(store), "--reference", plain, "--split", "test", "--noise", QUIET, "--out", str(out)]
    assert main(command) == 0
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    counts = np.array(report["counts"])
    assert counts.sum() == report["samples"] == 4
    assert counts[0].sum() == 1  # sample 32
    assert counts[0, 0] == 1
    assert counts[1, 0] == 0  # no lump is missed
    assert report["recalls"]["artery"] is None
    assert report["share_right"] == pytest.approx(np.trace(counts) / 4)
    assert (out / "confusion.png").read_bytes()[:4] == b"\x89PNG"
    assert "![confusion.png]" in (out / "report.md").read_text(encoding="utf-8")
    assert "| lump |" in capsys.readouterr().out


def test_a_noise_that_is_not_stated_is_taken_for_lumps(store: Path, plain: str) -> None:
    table, others = store_confusion(store, plain, HypothesesEstimator(classes=("lump",)), noise=1e-9, response=response())
    assert (table.total, others) == (40, 0)
    assert table.counts[0, 0] == 5  # those without a lump differ in rounding alone
    loud, _ = store_confusion(store, plain, HypothesesEstimator(classes=("lump",)), split="test", noise=1.0, response=response())
    assert loud.total == 4
    assert loud.recalls[1] < table.recalls[1]


def test_other_closings_than_the_reference_are_refused(store: Path, tmp_path: Path) -> None:
    other = plain_result(tmp_path / "other", CLOSINGS[:2])
    with pytest.raises(InputError, match="needed: the same"):
        store_confusion(store, other, HypothesesEstimator(), response=response())


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (
            {"size": np.array([60e-3, 40e-3, 20e-3])},
            "the block of the store measures 40 mm x 40 mm x 20 mm, that of",
        ),
        (
            {"layout": LAYOUT.model_copy(update={"pitch": 9e-3})},
            r"the matrix of the store has \d+ x \d+ taxels of [\d.]+ mm at a pitch of 10 mm, that of .* at a pitch of 9 mm;",
        ),
    ],
)
def test_a_reference_of_another_block_or_matrix_is_refused(
    store: Path, tmp_path: Path, other: dict[str, Any], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        store_confusion(store, plain_result(tmp_path / "other", **other), HypothesesEstimator(), response=response())


def test_grasps_that_open_again_are_not_held_against_tissue_that_only_closed(tmp_path: Path, plain: str) -> None:
    ramp = "      - {kind: ramp, to: 1 mm, duration: 1 s}\n"
    place = made_store(tmp_path, response(), text=TEXT.replace(ramp, ramp + "      - {kind: ramp, to: 0.4 mm, duration: 1 s}\n"))
    words = "close by 1 mm and open again to 400 µm; needed: a largest closing at the end"
    with pytest.raises(InputError, match=words):
        store_confusion(place, plain, HypothesesEstimator(), response=response())
    with pytest.raises(InputError, match=words):
        judged_samples(place, [plain], source="taxel_force")


def test_a_changed_sample_is_not_counted(store: Path, plain: str, tmp_path: Path) -> None:
    place = shutil.copytree(store, tmp_path / "changed.zarr")
    forces = Store.open(place, writing=True).array("taxel_force")
    forces[33] = 1.001 * forces[33]
    with pytest.raises(StorageError, match=r"1 samples \(33\) is not what was written"):
        store_confusion(place, plain, HypothesesEstimator(), response=response())
    with pytest.raises(StorageError, match="is not what was written"):
        judged_samples(place, [plain], source="taxel_force")
    assert len(judged_samples(place, [plain], source="taxel_force", split="train").truths) == 36


@pytest.mark.parametrize(
    ("extra", "words"),
    [
        (["--reference", "y"], "takes one --reference"),
        (["--readings", "read_force"], "unrecognized arguments: --readings read_force"),
        (["--learned", "x.npz"], "unrecognized arguments: --learned x.npz"),
    ],
)
def test_options_that_do_not_fit_are_refused(
    store: Path, plain: str, extra: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["data", "confusion", str(store), "--reference", plain, *extra]) == 2
    assert words in capsys.readouterr().err


def test_no_reference_is_an_error(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", "confusion", str(store)]) == 2
    assert "--reference is missing" in capsys.readouterr().err


def test_a_table_in_words_has_a_row_for_every_class_that_occurs() -> None:
    table = ConfusionTable()
    for true, estimated in (("lump", "lump"), ("lump", "none"), ("artery", "artery")):
        table.add(true, estimated)
    content = record(table, 2, {"estimator": "hypotheses", "noise": 1e-3})
    text = as_text(content, {})
    assert verdict(content) == "2 of 3 grasps named right"
    assert "| lump | 1 | 1 | 0 | 0 | 0 | 50 % |" in text
    assert "| none | " not in text.split("---")[-1]
    assert "2 samples belong to no class" in text
    assert max(map(len, (line for line in text.splitlines() if line.startswith("|")))) < 80, "it fits a terminal"
