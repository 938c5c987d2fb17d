"""Reading of a data set: samples that are done, of one part or of all, as an xarray data set."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tactsim.dataset.variable import DONE, FAILED
from tactsim.errors import InputError, StorageError, UnknownName

if TYPE_CHECKING:
    import xarray

    from tactsim.dataset.store import Store

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
        If the folder is not a data set, was written by another version, or has holes: arrays or chunks of these samples that are
        gone. What a chunk holds is looked at when it is read; a damaged one is refused then.
    """
    from tactsim.dataset.holes import refuse_holes
    from tactsim.dataset.store import Store

    place = Store.open(store)
    whole = dataset_of(place)
    names = [*map(str, whole.data_vars), *place.missing]
    keep = names if variables is None else list(map(str, variables))
    for name in keep:
        if name not in names:
            raise UnknownName("variable", name, names)
    chosen = chosen_samples(whole, split, failed=failed)
    refuse_holes(place, dict.fromkeys((*keep, "split")), chosen)
    return whole[keep].assign_coords(sample=np.arange(whole.sizes["sample"])).isel(sample=chosen)


def opened(store: str | Path) -> xarray.Dataset:
    """The whole store, lazily.

    Raises
    ------
    StorageError
        If the folder is not a data set, was written by another version, or has holes.
    """
    from tactsim.dataset.holes import refuse_holes
    from tactsim.dataset.store import Store

    place = Store.open(store)
    whole = dataset_of(place)
    refuse_holes(place, [*map(str, whole.data_vars), *place.missing], chosen_samples(whole, failed=True))
    return whole


def dataset_of(store: Store) -> xarray.Dataset:
    """The store by xarray, without Dask.

    Raises
    ------
    StorageError
        If its arrays do not fit together.
    """
    import xarray

    from tactsim.dataset.store import reading

    lengths = {name: array.shape[0] for name, array in store.described.items()}
    if len(set(lengths.values())) > 1:
        told = f"its arrays have {min(lengths.values())} to {max(lengths.values())} samples"
        raise StorageError(f"{store.path} cannot be opened: {told}: a run was killed while it made room; go on with --resume")
    with reading(store.path):
        return xarray.open_zarr(store.group.store, chunks=None, consolidated=False)


def split_names(dataset: xarray.Dataset) -> list[str]:
    """Names of the parts of a data set."""
    return str(dataset["split"].attrs["flag_meanings"]).split()


def chosen_samples(dataset: xarray.Dataset, split: str | Iterable[str] | None = None, *, failed: bool = False) -> Array:
    """Numbers of the samples of a part that are done, or also of those that failed."""
    status = dataset["status"].values
    chosen = (status == DONE) | (status == FAILED) if failed else status == DONE
    if split is not None:
        known, wanted = split_names(dataset), [split] if isinstance(split, str) else list(split)
        if not wanted:
            raise InputError("split: an empty list; leave it out for all samples")
        for name in wanted:
            if name not in known:
                raise UnknownName("split", name, known)
        chosen &= np.isin(dataset["split"].values, [known.index(name) for name in wanted])
    return np.flatnonzero(chosen)
