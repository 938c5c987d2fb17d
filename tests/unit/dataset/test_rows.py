"""Values that are read straight from the files of a store are those that Zarr reads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import zarr
from sweeps import small_store

from tactsim.dataset.store.opening import Store
from tactsim.errors import StorageError


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store of 24 samples in two chunks."""
    return small_store(tmp_path_factory.mktemp("rows"))


MASK = np.random.default_rng(1).random(24) < 0.4
ROWS = {
    "all": ...,
    "begin": slice(0, 3),
    "across": slice(5, 20, 2),
    "beyond": slice(20, 40),
    "none": slice(4, 4),
    "mask": MASK,
    "numbers": np.array([3, 17, 4]),
}


@pytest.mark.parametrize("asked", ROWS)
def test_every_variable_is_as_zarr_reads_it(place: Path, asked: str) -> None:
    store, group, rows = Store.open(place), zarr.open_group(place, mode="r"), ROWS[asked]
    assert {store.described[name].dtype for name in store.described} >= {"float64", "str", "uint8"}
    for name in store.described:
        expected = group[name].oindex[rows] if isinstance(rows, np.ndarray) else group[name][rows]
        read = store.read(name, rows)
        assert read.shape == expected.shape, name
        if expected.dtype.kind in "fiub":
            np.testing.assert_array_equal(read, expected, err_msg=name)
        else:
            assert read.tolist() == [str(text) for text in expected], name


def test_a_chunk_that_is_no_file_holds_the_fill_value(place: Path) -> None:
    """Mutant: zeros, or the other chunk."""
    (gone := place / "force/c/1/0").rename(aside := place.parent / "aside")
    try:
        values = Store.open(place).read("force", slice(14, 18))
        assert np.isfinite(values[:2]).all()
        assert np.isnan(values[2:]).all()
    finally:
        aside.rename(gone)
    with pytest.raises(StorageError, match="no variable forces"):
        Store.open(place).read("forces")
