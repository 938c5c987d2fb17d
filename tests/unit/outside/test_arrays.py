"""npz files of others: nothing larger than the file can hold, nothing that runs."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import numpy as np
import pytest
from numpy.lib import format as npy

from tactsim.errors import StorageError
from tactsim.outside.arrays import read_arrays


def npz(**arrays: Any) -> bytes:
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    return content.getvalue()


def test_arrays_come_back() -> None:
    arrays = {"a": np.arange(6.0).reshape(2, 3), "words": np.array(["x", "yz"]), "none": np.zeros((0, 3))}
    loaded = read_arrays(npz(**arrays), "file")
    assert loaded.keys() == arrays.keys()
    assert all(np.array_equal(loaded[name], array) for name, array in arrays.items())


def test_more_than_is_expected_is_refused_before_it_is_unpacked() -> None:
    content = npz(a=np.zeros(10**7))
    assert len(content) < 10**6
    with pytest.raises(StorageError, match="unpacks to more than 1000000 bytes"):
        read_arrays(content, "file", largest=10**6)


def test_a_header_that_promises_more_than_there_is_is_refused() -> None:
    header = io.BytesIO()
    npy.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (4_000_000_000,)})
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("a.npy", header.getvalue() + b"\0" * 64)
    with pytest.raises(StorageError, match="says that it holds 32000000000 bytes"):
        read_arrays(content.getvalue(), "file")


def test_objects_are_refused() -> None:
    with pytest.raises(StorageError, match="holds objects, which could run code"):
        read_arrays(npz(a=np.array([{"x": 1}], dtype=object)), "file")


def test_damage_is_reported() -> None:
    content = npz(a=np.arange(100.0), b=np.arange(3))
    for cut in range(0, len(content) - 1, 7):
        with pytest.raises(StorageError, match="file is damaged"):
            read_arrays(content[:cut], "file")
