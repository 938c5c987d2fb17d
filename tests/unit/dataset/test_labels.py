"""Labels along the dimensions of a store: jaws, rows, columns and axes, by xarray alone and by tactsim, in new stores and old."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
import zarr
from made_grasps import made_store, response

from tactsim.dataset import load
from tactsim.dataset.checking import check
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.sampling.stored import stored_sweep
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.writing import consolidate
from tactsim.dataset.use.export import exported

LABELS = {"jaw": ["upper", "lower"], "row": [1, 2, 3], "column": [1, 2, 3], "axis": ["x", "y", "z"]}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_store(tmp_path_factory.mktemp("made"), response())


@pytest.fixture
def grasps(made: Path, tmp_path: Path) -> Path:
    """The same to be spoilt."""
    return Path(shutil.copytree(made, tmp_path / "grasps.zarr"))


def labels_by_xarray(store: Path) -> dict[str, list[object]]:
    with xarray.open_zarr(store) as data:
        return {str(name): values.values.tolist() for name, values in data.coords.items()}


def without_labels(store: Path) -> Path:
    """The store as an earlier tactsim wrote it."""
    for name in LABELS:
        shutil.rmtree(store / name)
    consolidate(store)
    return store


def resumed(store: Path) -> None:
    with opened_run(stored_sweep(Store.open(store)), store, resume=True):
        pass


def faults(store: Path) -> list[str]:
    return [str(finding) for finding in check(store).findings if finding.kind in ("description", "gathered", "foreign", "file")]


def test_xarray_selects_a_taxel_by_its_jaw_and_row_without_tactsim(grasps: Path) -> None:
    assert labels_by_xarray(grasps) == LABELS
    with xarray.open_zarr(grasps) as data:
        force = data["taxel_force"]
        assert force.dims == ("sample", "time", "jaw", "row", "column"), "names of dimensions stay"
        chosen = force.sel(jaw="lower", row=1, column=[2, 3]).values
        np.testing.assert_array_equal(chosen, force.values[:, :, 1, 0, 1:])
        np.testing.assert_array_equal(data["inclusion_center"].sel(axis="z").values, data["inclusion_center"].values[..., 2])
    assert faults(grasps) == []


@pytest.mark.usefixtures("hdf5_here")
def test_an_export_names_jaws_and_axes_as_the_store_does(grasps: Path, tmp_path: Path) -> None:
    """Which jaw comes first was to be read out of the description of a variable."""
    exported(grasps, tmp_path / "g.h5")
    exported(grasps, tmp_path / "g")
    with h5py.File(tmp_path / "g.h5") as file:
        assert {name: file[name][...].astype("U").tolist() for name in LABELS} == {
            name: list(map(str, labels)) for name, labels in LABELS.items()
        }
    assert json.loads((tmp_path / "g" / "dataset.json").read_text(encoding="utf-8"))["labels"] == LABELS


def test_an_old_store_is_read_with_labels_and_gets_them_when_it_is_resumed(grasps: Path, made: Path) -> None:
    assert labels_by_xarray(without_labels(grasps)) == {}
    assert faults(grasps) == []
    old, new = load(grasps), load(made)
    np.testing.assert_array_equal(
        old["taxel_force"].sel(jaw="upper", row=3).values, new["taxel_force"].sel(jaw="upper", row=3).values
    )
    both = xarray.concat([old.load(), new.load()], "sample")
    assert both.sizes["row"] == 3
    resumed(grasps)
    assert labels_by_xarray(grasps) == LABELS
    assert faults(grasps) == []


def test_changed_labels_are_reported_and_made_anew(grasps: Path) -> None:
    zarr.open_group(grasps, mode="r+", zarr_format=3)["row"][:] = [3, 2, 1]
    (fault,) = faults(grasps)
    assert "the labels along row are not 1 to 3; remove the folder row and go on with --resume" in fault
    assert load(grasps)["row"].values.tolist() == [1, 2, 3], "tactsim does not rely on the file"
    shutil.rmtree(grasps / "row")
    resumed(grasps)
    assert labels_by_xarray(grasps) == LABELS
    (grasps / "jaw" / "zarr.json").write_text("{", encoding="utf-8")
    assert any("go on with --resume" in fault for fault in faults(grasps))


def test_a_label_that_was_half_written_is_removed(grasps: Path) -> None:
    (grasps / "row" / "c" / "zarr.0123456789abcdef0123456789abcdef.partial").write_bytes(b"half")
    assert "unfinished" in {finding.kind for finding in check(grasps).findings}
    resumed(grasps)
    assert not list(grasps.rglob("*.partial"))
