"""Reading of a data set: its samples that are done, as an xarray data set or as PyTorch's loaders take them."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.store.arrays import DONE, FAILED
from tactsim.errors import InputError, StorageError, UnknownName, shown
from tactsim.outside.extras import extras_named
from tactsim.outside.files import named_path
from tactsim.outside.text import one_line

if TYPE_CHECKING:
    import xarray

    from tactsim.case.model import Case
    from tactsim.dataset.store.opening import Store


DATA_SET = "the folder of a data set"
"""What a path is of, as messages say."""


def load(
    store: str | Path,
    *,
    split: str | Iterable[str] | None = None,
    failed: bool = False,
    variables: str | Iterable[str] | None = None,
    verified: bool = False,
) -> xarray.Dataset:
    """The samples of a data set, opened lazily.

    >>> import tactsim as ts
    >>> train = ts.load_data("annuli.zarr", split="train")  # of the example of `sweep`
    >>> train["varied_outer_radius"].attrs["units"]
    'm'

    Parameters
    ----------
    store : folder that ``tactsim sweep`` wrote
    split : one part, such as ``"train"``, or several; by default all
    failed : whether samples that failed, whose readings are NaN, are in it too; those that are pending never are
    variables : names of the variables; by default all
    verified : whether all that is stored of these samples is read and held against their checksums first

    Raises
    ------
    UnknownName
        If there is no such split or variable.
    InputError
        If the store is neither a path nor a text.
    StorageError
        If the folder is not a data set, was written by another version, or has holes: arrays or chunks of these samples that are
        gone, or arrays whose units or other attributes were changed; if ``verified``, also if a sample is not what was written.
        Else a damaged chunk is refused when it is read.
    """
    from tactsim.dataset.store.opening import Store
    from tactsim.dataset.store.verifying import refuse_changed, refuse_holes, refuse_redescribed

    place = Store.open(named_path(store, DATA_SET))
    refuse_redescribed(place)
    whole = dataset_of(place)
    names = [*map(str, whole.data_vars), *place.missing]
    keep = names if variables is None else names_in(variables, "variables")
    if unknown := [name for name in keep if name not in names]:
        raise UnknownName("variable", unknown[0], names)
    chosen = chosen_samples(whole, split, failed=failed)
    refuse_holes(place, dict.fromkeys((*(names if verified else keep), "split")), chosen)
    if verified:
        refuse_changed(place, chosen)
    return whole[keep].assign_coords(sample=np.arange(whole.sizes["sample"])).isel(sample=chosen)


def opened(store: str | Path) -> xarray.Dataset:
    """The whole store, lazily.

    Raises
    ------
    StorageError
        If the folder is not a data set, was written by another version, has holes or arrays whose attributes were changed.
    """
    from tactsim.dataset.store.opening import Store
    from tactsim.dataset.store.verifying import refuse_holes, refuse_redescribed

    place = Store.open(store)
    refuse_redescribed(place)
    whole = dataset_of(place)
    refuse_holes(place, [*map(str, whole.data_vars), *place.missing], chosen_samples(whole, failed=True))
    return whole


def sample_case(store: str | Path, sample: int) -> Case:
    """The case of one sample, as it was computed, of a failed one and of one that is still pending too.

    ``sample_case("lumps.zarr", 7).run()`` repeats sample 7; `tactsim.save_case` writes it for the command line.

    Raises
    ------
    InputError
        If there is no such sample, no draw of it was possible, or the store is neither a path nor a text.
    StorageError
        If the folder is not a data set, or this tactsim draws another case than was computed.
    """
    from tactsim.dataset.sampling.drawing import stored_cases
    from tactsim.dataset.sampling.stored import stored_sweep
    from tactsim.dataset.store.opening import Store

    place = Store.open(named_path(store, DATA_SET))
    known = f"the data set has samples 0 to {place.samples - 1}"
    if isinstance(sample, bool) or not hasattr(sample, "__index__"):
        raise InputError(f"sample_case: {shown(sample)} is not the number of a sample; {known}")
    sample = operator.index(sample)
    if not 0 <= sample < place.samples:
        raise InputError(f"sample {sample}: {known}")
    sweep = stored_sweep(place)
    return next(stored_cases(sweep, [sample], [place.read("case_id")[sample]], str(store)))


def dataset_of(store: Store) -> xarray.Dataset:
    """The store by xarray, without Dask; jaws, rows, columns and axes have labels, in a store of an earlier tactsim too.

    Variables stand in the order in which they were declared; Zarr finds them in that of the folder, another in every copy.

    Raises
    ------
    StorageError
        If its arrays do not fit together.
    """
    import xarray

    from tactsim.dataset.store.labels import labels_along
    from tactsim.dataset.store.opening import ARRAYS, reading

    refuse_half_extended(store)
    with reading(store.path):
        whole = xarray.open_zarr(store.group.store, chunks=None, consolidated=False)
    declared = dict.fromkeys([*store.attributes.get(ARRAYS, ()), *store.described])
    whole = whole[[name for name in declared if name in whole.data_vars]]
    return whole.assign_coords(labels_along({str(name): size for name, size in whole.sizes.items()}))


def refuse_half_extended(store: Store) -> None:
    """Refuses arrays of different lengths, as a run leaves them that was killed while it made room for more samples.

    Raises
    ------
    StorageError
        With the lengths.
    """
    lengths = {array.shape[0] for array in store.described.values()}
    if len(lengths) > 1:
        raise StorageError(
            f"{one_line(store.path)} cannot be opened: its arrays have {min(lengths)} to {max(lengths)} samples: a run was "
            "killed while it made room; go on with --resume"
        )


def names_in(given: str | Iterable[str], what: str) -> list[str]:
    """The names that a user gave in Python, one as a text or several; ``what`` they are of begins the message.

    Raises
    ------
    InputError
        If it is neither.
    """
    if isinstance(given, str):
        return [given]
    if not isinstance(given, Iterable):
        raise InputError(f"{what}: {shown(given)}; needed: a name, or a list of names")
    return list(map(str, given))


def split_names(dataset: xarray.Dataset) -> list[str]:
    """Names of the parts of a data set."""
    return str(dataset["split"].attrs["flag_meanings"]).split()


def chosen_samples(dataset: xarray.Dataset, split: str | Iterable[str] | None = None, *, failed: bool = False) -> Array:
    """Numbers (m,) of the samples of a part that are done, or also of those that failed.

    Raises
    ------
    UnknownName
        If there is no such split.
    InputError
        If the list of splits is empty.
    StorageError
        If status or split cannot be read.
    """
    status = dataset["status"].values
    chosen = (status == DONE) | (status == FAILED) if failed else status == DONE
    if split is not None:
        known, wanted = split_names(dataset), names_in(split, "split")
        if not wanted:
            raise InputError("split: an empty list; leave it out for all samples")
        for name in wanted:
            if name not in known:
                raise UnknownName("split", name, known)
        chosen &= np.isin(dataset["split"].values, [known.index(name) for name in wanted])
    return np.flatnonzero(chosen)


class TorchSamples:
    """A map-style data set: ``(inputs, targets)`` of one sample, two mappings from variable to a tensor of 32-bit floats.

    The store is opened in each process when its first sample is taken, so that any number of loader workers share nothing.
    Whole numbers stay whole. NaN of padded inclusions stays NaN.

    Raises
    ------
    UnknownName
        If there is no such variable or split.
    InputError
        If a variable holds text, the list of splits is empty, or a name is not text.
    StorageError
        If the store cannot be opened.
    """

    def __init__(
        self,
        store: str | Path,
        *,
        inputs: str | Iterable[str],
        targets: str | Iterable[str] = (),
        split: str | Iterable[str] | None = None,
        transform: Callable[[dict[str, Any], dict[str, Any]], Any] | None = None,
    ):
        inputs, targets = names_in(inputs, "inputs"), names_in(targets, "targets")
        whole = load(store, split=split, variables=dict.fromkeys((*inputs, *targets, "status")))
        for name in (*inputs, *targets):
            if whole[name].dtype.kind not in "fiub":
                raise InputError(f"{name} holds text, which a tensor cannot; take numbers")
        self.store, self.inputs, self.targets, self.transform = str(store), tuple(inputs), tuple(targets), transform
        self.numbers = whole["sample"].values
        self._opened: tuple[int, dict[str, Any]] | None = None

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, index: int) -> Any:
        return self.__getitems__([index])[0]

    def __getitems__(self, indices: Sequence[int]) -> list[Any]:
        """Several samples by one reading of each chunk, which PyTorch's loaders ask for."""
        values = {name: self._tensors(name, self.numbers[list(indices)]) for name in (*self.inputs, *self.targets)}
        samples = []
        for row in range(len(indices)):
            inputs, targets = ({name: values[name][row] for name in names} for names in (self.inputs, self.targets))
            samples.append(self.transform(inputs, targets) if self.transform else (inputs, targets))
        return samples

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_opened": None}

    def _tensors(self, name: str, numbers: np.ndarray) -> Any:
        with extras_named():
            import torch

        values = np.asarray(self._arrays()[name].oindex[numbers])
        return torch.from_numpy(np.array(values, dtype=np.float32 if values.dtype.kind == "f" else np.int64))

    def _arrays(self) -> dict[str, Any]:
        """The arrays of this process."""
        if self._opened is None or self._opened[0] != os.getpid():
            from tactsim.dataset.store.opening import Store

            store = Store.open(self.store)
            self._opened = os.getpid(), {name: store.array(name) for name in (*self.inputs, *self.targets)}
        return self._opened[1]
