"""Folders that are no data set, or one of another version: one line that says so, and exit code 5."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import zarr
from sweeps import run_sweep, small_store, sweep_file

from tactsim.cli import main
from tactsim.dataset import TorchSamples, load
from tactsim.dataset.checking import check
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.writing import set_attributes
from tactsim.errors import StorageError


def rewritten(place: Path, **attributes: object) -> None:
    """Changes what a store says of itself; None takes a word back."""
    description = json.loads((place / "zarr.json").read_text(encoding="utf-8"))
    changed = description["attributes"] | attributes
    description["attributes"] = {name: value for name, value in changed.items() if value is not None}
    (place / "zarr.json").write_text(json.dumps(description), encoding="utf-8")


def foreign(place: Path) -> None:
    shutil.rmtree(place)
    zarr.open_group(place, mode="w", zarr_format=3).create_array("a", shape=(3,), dtype="f8")


def bare_array(place: Path) -> None:
    shutil.rmtree(place)
    zarr.open_array(place, mode="w", zarr_format=3, shape=(3,), dtype="f8")


def format_two(place: Path) -> None:
    shutil.rmtree(place)
    zarr.open_group(place, mode="w", zarr_format=2)


SPOILT: dict[str, tuple[Callable[[Path], object], str]] = {
    "missing": (shutil.rmtree, "no such folder: "),
    "foreign": (foreign, "Zarr of another origin, without the schema 'tactsim/dataset/1'"),
    "array": (bare_array, "Zarr of another origin"),
    "format 2": (format_two, "it is of Zarr format 2"),
    "future": (
        lambda place: rewritten(place, schema="tactsim/dataset/2", codes=["9.0"]),
        "has the schema 'tactsim/dataset/2'; this tactsim reads 'tactsim/dataset/1'; use the version that wrote it: 9.0",
    ),
    "torn": (lambda place: (place / "zarr.json").write_text("{"), "zarr.json is damaged"),
    "no mapping": (lambda place: (place / "zarr.json").write_text("[1]"), "zarr.json is damaged"),
    "silent": (
        lambda place: rewritten(place, sweep=None, license=None),
        "zarr.json does not state license, sweep; bring back a copy",
    ),
    "no status": (lambda place: shutil.rmtree(place / "status"), "it has no variable status"),
}


@pytest.mark.parametrize("kind", SPOILT)
def test_what_is_no_data_set_is_reported(kind: str, kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = Path(shutil.copytree(kept, tmp_path / "s.zarr"))
    spoil, words = SPOILT[kind]
    assert main(["data", "info", str(place)]) == 0
    spoil(place)
    capsys.readouterr()
    for command in (["info"], ["check"], ["export", "--to", str(tmp_path / "x.h5")]):
        assert main(["data", command[0], str(place), *command[1:]]) == 5
        error = capsys.readouterr().err
        assert words in error
        assert error.count("\n") == 1
    for use in (load, check, lambda place: TorchSamples(place, inputs=["force"])):
        with pytest.raises(StorageError, match=r"s\.zarr"):
            use(place)
    assert not (tmp_path / "x.h5").exists()


def test_a_store_that_an_earlier_version_began_is_read_but_not_gone_on_with(tmp_path: Path) -> None:
    place = small_store(tmp_path)
    whole = load(place)
    left_out = "force"
    shutil.rmtree(place / left_out)
    set_attributes(Store.open(place, writing=True, damaged=True), arrays=sorted(set(map(str, whole.data_vars)) - {left_out}))
    assert set(load(place).data_vars) == set(whole.data_vars) - {left_out}
    (finding,) = (finding for finding in check(place).findings if finding.kind in ("form", "attribute"))
    assert f"which did not store {left_out}; it can be read" in finding.words
    with pytest.raises(StorageError, match=f"did not store {left_out}; .*begin anew in another folder"):
        run_sweep(load_sweep(sweep_file(tmp_path)), place, resume=True)


def test_wrong_names_are_bad_input(kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", "export", str(kept), "--to", str(tmp_path / "x.h5"), "--split", "trian"]) == 2
    assert "did you mean 'train'" in capsys.readouterr().err
    assert main(["data", "export", str(kept)]) == 2
    assert "--to is missing" in capsys.readouterr().err
