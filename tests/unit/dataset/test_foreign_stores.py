"""Folders that are no data set, or one of another version: one line that says so, and exit code 5."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import zarr
from sweeps import TEXT, content, run_sweep, small_store, sweep_file

from tactsim.cli import main
from tactsim.dataset import TorchSamples, load
from tactsim.dataset.checking import check
from tactsim.dataset.cost import COST
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store import blocks
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.verifying import refuse_changed
from tactsim.dataset.store.writing import set_attributes
from tactsim.dataset.use.card import description
from tactsim.dataset.use.counts import costs_of
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


def test_a_store_that_an_earlier_version_began_is_read_but_not_gone_on_with(store: Path, tmp_path: Path) -> None:
    place = store
    whole = load(place)
    left_out = "force"
    shutil.rmtree(place / left_out)
    set_attributes(Store.open(place, writing=True, damaged=True), arrays=sorted(set(map(str, whole.data_vars)) - {left_out}))
    assert set(load(place).data_vars) == set(whole.data_vars) - {left_out}
    (finding,) = (finding for finding in check(place).findings if finding.kind in ("form", "attribute"))
    assert f"which did not store {left_out}; it can be read" in finding.words
    with pytest.raises(StorageError, match=f"did not store {left_out}; .*begin anew in another folder"):
        run_sweep(load_sweep(sweep_file(tmp_path)), place, resume=True)


@pytest.fixture(scope="module")
def longer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of 30 samples, made at once."""
    folder = tmp_path_factory.mktemp("longer")
    run_sweep(load_sweep(sweep_file(folder), samples=30), folder / "s.zarr")
    return folder / "s.zarr"


@pytest.mark.parametrize("listed", [True, False], ids=["with a list of arrays", "without"])
def test_a_store_from_before_samples_had_a_cost_is_checked_and_gone_on_with(
    store: Path, longer: Path, tmp_path: Path, listed: bool
) -> None:
    place = store
    for name in COST:
        shutil.rmtree(place / name)
    stated = json.loads((place / "zarr.json").read_text())
    for names in (described := stated["attributes"]["arrays"], stated["consolidated_metadata"]["metadata"]):
        for name in COST:
            names.remove(name) if names is described else names.pop(name)
    if not listed:
        del stated["attributes"]["arrays"]
    (place / "zarr.json").write_text(json.dumps(stated))
    assert check(place).findings == ()
    run = run_sweep(load_sweep(sweep_file(tmp_path), samples=30), place, resume=True)
    assert (run.tally.done, run.tally.again) == (6, 0), "nothing that was there is computed again"
    assert check(place).findings == ()
    new, old = content(longer), content(place)
    assert new.keys() - old.keys() == COST.keys()
    for name, values in old.items():
        np.testing.assert_array_equal(values, new[name], err_msg=name)
    assert costs_of(Store.open(place)).keys() == {"sample", "wall_time"}
    assert description(place)


def test_a_quantity_of_the_name_of_a_cost_stays_a_reading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As of a sweep that stores the unknowns of a grasp as a quantity; a changed value is found by its checksum."""
    monkeypatch.setitem(COST, "largest_force", "a count")
    monkeypatch.setattr(blocks, "NOT_SUMMED", (*blocks.NOT_SUMMED, "largest_force"))
    place = small_store(tmp_path, TEXT.replace("times: 4", "times: 4\n  quantities: {largest_force: N}"))
    assert load(place)["largest_force"].attrs["role"] == "reading"
    assert np.isfinite(load(place)["largest_force"].values).all()
    assert check(place).findings == ()
    Store.open(place, writing=True).array("largest_force")[3] = 1.0
    assert [(finding.kind, finding.samples) for finding in check(place).findings] == [("checksum", (3,))]
    with pytest.raises(StorageError, match=r"1 samples \(3\)"):
        refuse_changed(Store.open(place), np.arange(24))


def test_wrong_names_are_bad_input(kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", "export", str(kept), "--to", str(tmp_path / "x.h5"), "--split", "trian"]) == 2
    assert "did you mean 'train'" in capsys.readouterr().err
    assert main(["data", "export", str(kept)]) == 2
    assert "--to is missing" in capsys.readouterr().err
