"""What a user keeps in a data set is neither replaced nor removed; what tactsim wrote there is written anew."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from pretence import PNG
from sweeps import compute_once_here, sweep_file

from tactsim.cli import main
from tactsim.dataset.checking import check
from tactsim.dataset.figures import card as dataset_card
from tactsim.storage.own_files import OWN_LIST


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sweeps start no processes, samples are computed once, and the figure is a dot."""
    compute_once_here(monkeypatch)
    monkeypatch.setattr(dataset_card, "card_figures", lambda store: {"spread.png": lambda: PNG})


def swept(tmp_path: Path, samples: int, *options: str) -> int:
    case = str(sweep_file(tmp_path))
    return main(["sweep", case, "--out", str(tmp_path / "s.zarr"), "--samples", str(samples), "--quiet", *options])


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store of three samples that stays as it is."""
    folder = tmp_path_factory.mktemp("kept")
    with pytest.MonkeyPatch.context() as patch:
        compute_once_here(patch)
        patch.setattr(dataset_card, "card_figures", lambda store: {"spread.png": lambda: PNG})
        assert swept(folder, 3) == 0
    return folder / "s.zarr"


@pytest.fixture
def store(kept: Path, tmp_path: Path) -> Path:
    """The same to be gone on with."""
    return Path(shutil.copytree(kept, tmp_path / "s.zarr"))


def test_card_and_figures_are_written_anew(store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert check(store).findings == ()
    (store / "figures/spread.png").unlink()
    assert [finding.kind for finding in check(store).findings] == ["file"]
    assert swept(tmp_path, 6, "--resume") == 0
    assert "| done | 6 |" in (store / "README.md").read_text(encoding="utf-8")
    assert (store / "figures/spread.png").read_bytes() == PNG
    assert "warning: the card" not in capsys.readouterr().err
    assert check(store).findings == ()


@pytest.mark.parametrize("name", ["README.md", "figures/spread.png"])
@pytest.mark.parametrize("before", [False, True])
def test_a_file_of_the_user_is_kept(
    name: str, before: bool, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if before:  # as if it had been there from the beginning
        (store / OWN_LIST).unlink()
        (store / "README.md").unlink()
    (store / name).write_text("mine", encoding="utf-8")
    assert swept(tmp_path, 6, "--resume") == 0
    assert (store / name).read_text(encoding="utf-8") == "mine"
    assert "is not what tactsim wrote there, and is kept" in capsys.readouterr().err
    assert {finding.kind for finding in check(store).findings} <= {"file", "foreign"}
    assert check(store).counts["done"] == 6


def test_files_of_an_earlier_version_are_known_by_the_card(
    store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (store / OWN_LIST).unlink()
    assert check(store).findings == ()
    assert "cannot be verified" in check(store).notes[-1]
    assert swept(tmp_path, 6, "--resume") == 0
    assert "| done | 6 |" in (store / "README.md").read_text(encoding="utf-8")
    assert "kept" not in capsys.readouterr().err


@pytest.mark.parametrize("text", ["mine", "[1]", json.dumps({"schema": "other"}), "[" * 10_000])
def test_a_list_of_another_program_is_kept(text: str, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (store / OWN_LIST).write_text(text)
    assert swept(tmp_path, 6, "--resume") == 0
    assert (store / OWN_LIST).read_text() == text
    assert "move" in capsys.readouterr().err
    assert main(["data", "check", str(store)]) in (4, 5)


def test_a_journal_of_another_program_is_kept(store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (store / ".journal").write_text("dear diary")
    assert swept(tmp_path, 6, "--resume") == 5
    assert "is no journal of tactsim; move it away" in capsys.readouterr().err
    assert (store / ".journal").read_text() == "dear diary"
    capsys.readouterr()
    assert main(["data", "info", str(store)]) == 0
    assert "is no journal of tactsim; move it away" in capsys.readouterr().out


def test_splits_without_a_sample_are_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert swept(tmp_path, 3) == 0
    case, place = str(sweep_file(tmp_path)), tmp_path / "few.zarr"
    capsys.readouterr()
    assert main(["sweep", case, "--out", str(place), "--samples", "3"]) == 0
    err = capsys.readouterr().err
    assert "warning: the splits validation, test have no sample that is done; take more samples" in err
    assert "warning: no sample that is done satisfies the rule of softer; take more samples, or compare its bounds" in err
    assert "warning: the splits" in (place / "README.md").read_text(encoding="utf-8")
    assert main(["sweep", case, "--out", str(tmp_path / "many.zarr"), "--samples", "60"]) == 0
    assert "warning: " not in capsys.readouterr().err
