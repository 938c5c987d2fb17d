"""Reading of a data set: samples that are done, of one part or of all, as an xarray data set."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tactsim.dataset.variable import DONE
from tactsim.errors import InputError, StorageError, UnknownName

if TYPE_CHECKING:
    import xarray

Array = np.ndarray


def load(
    store: str | Path, *, split: str | Iterable[str] | None = None, failed: bool = False, variables: Iterable[str] | None = None
) -> xarray.Dataset:
    """The samples of a data set, opened lazily.

    Parameters
    ----------
    store
        Folder that ``tactsim sweep`` wrote.
    split
        One part, such as ``"train"``, or several; by default all.
    failed
        Whether samples that failed, whose readings are NaN, are in it too; those that are pending never are.
    variables
        Names of the variables; by default all.

    Raises
    ------
    UnknownName
        If there is no such split or variable.
    StorageError
        If the folder is not a data set or was written by another version.
    """
    whole = opened(store)
    keep = list(map(str, whole.data_vars if variables is None else variables))
    for name in keep:
        if name not in whole:
            raise UnknownName("variable", name, map(str, whole.data_vars))
    chosen = chosen_samples(whole, split, failed=failed)
    return whole[keep].assign_coords(sample=np.arange(whole.sizes["sample"])).isel(sample=chosen)


def opened(store: str | Path) -> xarray.Dataset:
    """The whole store, lazily.

    Raises
    ------
    StorageError
        If the folder is not a data set or was written by another version.
    """
    from tactsim.dataset.store import Store

    Store.open(store)
    return without_chunks(store)


def without_chunks(store: str | Path) -> xarray.Dataset:
    """The store by xarray, without Dask."""
    import xarray

    try:
        return xarray.open_zarr(str(store), chunks=None)
    except (OSError, ValueError, KeyError) as error:
        raise StorageError(f"{store} cannot be opened: {error}") from None


def split_names(dataset: xarray.Dataset) -> list[str]:
    """Names of the parts of a data set."""
    return str(dataset["split"].attrs["flag_meanings"]).split()


def chosen_samples(dataset: xarray.Dataset, split: str | Iterable[str] | None = None, *, failed: bool = False) -> Array:
    """Numbers of the samples of a part that are done, or also of those that failed."""
    status = dataset["status"].values
    chosen = status >= DONE if failed else status == DONE
    if split is not None:
        known, wanted = split_names(dataset), [split] if isinstance(split, str) else list(split)
        if not wanted:
            raise InputError("split: an empty list; leave it out for all samples")
        for name in wanted:
            if name not in known:
                raise UnknownName("split", name, known)
        chosen &= np.isin(dataset["split"].values, [known.index(name) for name in wanted])
    return np.flatnonzero(chosen)
