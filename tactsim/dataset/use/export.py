"""A data set in the formats of others: one HDF5 file, or an index (Parquet) with shards (npz). No pickle in either."""

from __future__ import annotations

import importlib.util
import json
import os
import sys
from collections.abc import Hashable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.store.arrays import FAILED, refuse_link
from tactsim.dataset.store.files import CARD, FIGURES
from tactsim.dataset.store.opening import Store
from tactsim.dataset.use.loading import load, names_in, split_names
from tactsim.errors import InputError, StorageError, TactsimError
from tactsim.outside.extras import extras_named
from tactsim.outside.files import opened
from tactsim.outside.processes import run_child
from tactsim.outside.text import one_line
from tactsim.storage.building import built_beside, remove_leftover
from tactsim.storage.files import naming, write_bytes
from tactsim.storage.locking import only_one
from tactsim.storage.own_files import OwnFiles

if TYPE_CHECKING:
    import xarray

SHARD_SAMPLES = 1000
"""Samples in a shard."""
INDEX = "index.parquet"
META = "dataset.json"
MODULE = "tactsim.dataset.use.export"
LONGEST = 6 * 3600.0
"""Time in s after which writing is given up: no disk is so slow."""


OF_HDF5 = (
    "import h5py",
    'with h5py.File("EXPORT.h5") as file:',
    '    values = file["NAME"][...]  # the sample first; units and dimensions are attributes',
    '    samples = file["sample"][...]  # their numbers in the data set',
)
OF_SHARDS = (
    "import numpy, pandas",
    'index = pandas.read_parquet("index.parquet")  # a row for each sample: numbers and texts, and its place in the shards',
    'first = numpy.load("shard_00000.npz")  # arrays of the samples with index.shard == 0; dataset.json has dimensions and units',
    'values = first["NAME"][index.row[index.shard == 0]]',
)
"""How an export is read, for its card; NAME stands for a variable."""
HDF5 = (".h5", ".hdf5")
"""Endings of files; folders have none."""


def exported(store: str | Path, place: str | Path, *, split: str | Iterable[str] | None = None) -> int:
    """Writes the samples that are done, of all splits or some, and returns how many.

    A place that ends in ``.h5`` or ``.hdf5`` becomes a file, any other a folder; nothing that exists is replaced. The card of the
    store goes with it (README.md, or ``card``), and the numbers of the samples that failed, with their reasons (``failed``).

    Raises
    ------
    InputError
        If the place has another ending, h5py or pyarrow is missing, or the split is empty or unknown.
    StorageError
        If the place exists or cannot be written.
    """
    target = Path(place)
    if target.suffix[1:].isalpha() and target.suffix not in HDF5:
        allowed = f"{' or '.join(HDF5)} for a file, no ending for a folder of Parquet and npz"
        raise InputError(f"{one_line(target)} ends in {target.suffix}; allowed: {allowed}")
    _refuse_inside(target, Path(store))
    with only_one(
        target, f"{one_line(target)} is being written by another export; wait for it or choose another place with --to"
    ):
        with naming(target):
            remove_leftover(target)
        if os.path.lexists(target):
            raise StorageError(f"{one_line(target)} exists; choose another place with --to")
        parts = None if split is None else names_in(split, "split")
        data = load(store, split=parts)
        if not data.sizes["sample"]:
            named = f" in {', '.join(parts)}" if parts else ""
            raise InputError(f"{one_line(store)} has no sample that is done{named}")
        with built_beside(target) as waiting, naming(target):
            if target.suffix in HDF5:
                _hdf5_apart(store, parts, waiting, target)
            else:
                _shards(data, Store.open(store).attributes | {"failed": _failed(store, parts)}, waiting)
                if card := _card(Path(store), data, parts, OF_SHARDS):
                    write_bytes(waiting / CARD, card.encode())
                    _copy_figures(Path(store), waiting)
    return int(data.sizes["sample"])


def _refuse_inside(target: Path, store: Path) -> None:
    if Path(os.path.realpath(target)).is_relative_to(os.path.realpath(store)):
        raise StorageError(f"{one_line(target)} lies in the data set itself; choose another place with --to")


def _card(store: Path, data: xarray.Dataset, split: list[str] | None, reading: tuple[str, ...]) -> str:
    """The card of a store with what was exported of it and how that is read before its sections; empty if the store has none."""
    path = store / CARD
    if not os.path.lexists(path):
        return ""
    refuse_link(path)
    head, mark, rest = opened(path, "description").text().partition("\n## ")
    parts = "all splits" if split is None else f"the split {', '.join(split)}"
    count = f"{data.sizes['sample']} samples that are done, of {parts}."
    name = max(
        _arrays(data), key=lambda one: (data[one].attrs["role"] == "reading", data[one].attrs["units"] == "N", data[one].size)
    )
    lines = ["## This export", f"{count} What follows is about the whole data set; read the export so:", "```python"]
    here = "\n".join([*lines, *(line.replace("NAME", name) for line in reading), "```", ""])
    return f"{head.rstrip()}\n\n{here}{mark}{rest}"


def _copy_figures(store: Path, target: Path) -> None:
    """Copies the pictures that the card shows."""
    files = OwnFiles(store)
    for name in files.sums():
        if name.startswith(f"{FIGURES}/") and files.written(name):
            (target / FIGURES).mkdir(exist_ok=True)
            write_bytes(target / name, (store / name).read_bytes())


def _arrays(data: xarray.Dataset) -> list[str]:
    """Names of the variables that are several numbers of a sample."""
    return [str(name) for name, values in data.data_vars.items() if values.ndim > 1]


def _labels(data: xarray.Dataset) -> dict[str, Array]:
    """Dimension -> its labels (n,), such as the jaws, of those that have labels."""
    return {str(name): values.values for name, values in data.coords.items() if name != "sample"}


def _failed(store: str | Path, split: list[str] | None) -> list[dict[str, Any]]:
    """Number and reason of every sample that failed."""
    whole = load(store, split=split, failed=True)
    failed = whole.isel(sample=whole["status"].values == FAILED)
    pairs = zip(failed["sample"].values, failed["reason"].values, strict=True)
    return [{"sample": int(sample), "reason": str(reason)} for sample, reason in pairs]


def _hdf5_apart(store: str | Path, split: list[str] | None, waiting: Path, target: Path) -> None:
    """Writes HDF5 in a child process: on a full disk the library ends the process that it runs in."""
    if importlib.util.find_spec("h5py") is None:
        raise InputError("HDF5 needs h5py; install it with: pip install 'tactsim[export]'")
    arguments = [str(Path(store).absolute()), str(waiting.absolute()), json.dumps(split)]
    done = run_child(MODULE, arguments, time_limit=LONGEST)
    if done.out_of_time:
        raise StorageError(f"cannot write {one_line(target)}: it took longer than {LONGEST:g} s")
    if done.code == StorageError.exit_code and done.last_line:
        raise StorageError(done.last_line)
    if done.code:
        full = "No space left" in done.error_output or "File too large" in done.error_output
        raise StorageError(
            f"cannot write {one_line(target)}: {'no room left on the disk' if full else done.last_line or done.ending}"
        )


def _hdf5(data: xarray.Dataset, attributes: dict[str, Any], target: Path, *, failed: list[dict[str, Any]], card: str) -> None:
    """One data set per variable, the first dimension the sample; dimensions and units as attributes. What failed and the card are
    data sets too: attributes would be too small for them."""
    with extras_named():
        import h5py

    with h5py.File(target, "w") as file:
        file.attrs.update({name: _plain(value) for name, value in attributes.items()})
        file["card"] = card
        file["failed/sample"] = np.array([sample["sample"] for sample in failed], dtype=np.int64)
        file["failed/reason"] = np.array([sample["reason"].encode() for sample in failed], dtype=h5py.string_dtype())
        file["sample"] = data["sample"].values
        for along, labels in _labels(data).items():
            file[along] = labels if labels.dtype.kind in "iu" else labels.astype("S")
        for name, values in data.data_vars.items():
            content = np.asarray(values.values)
            written = content if content.dtype.kind in "fiub" else np.array([str(value).encode() for value in content])
            file[str(name)] = written
            file[str(name)].attrs.update({key: _plain(value) for key, value in values.attrs.items()})
            file[str(name)].attrs["dimensions"] = ",".join(map(str, values.dims))


def _shards(data: xarray.Dataset, attributes: dict[str, Any], target: Path) -> None:
    """The index has one row per sample with every variable that is one number or text, and the shard of its arrays."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError("Parquet needs pyarrow; install it with: pip install 'tactsim[export]'") from None
    target.mkdir()
    count = data.sizes["sample"]
    numbers = np.arange(count)
    columns: dict[str, Any] = {"sample": data["sample"].values, "shard": numbers // SHARD_SAMPLES, "row": numbers % SHARD_SAMPLES}
    columns |= {_headed(name, values): _column(name, values, data) for name, values in data.data_vars.items() if values.ndim == 1}
    pyarrow.parquet.write_table(pyarrow.table(columns), target / INDEX)
    for number, part in enumerate(_parts(data)):
        arrays = {name: part[name].values for name in _arrays(part)}
        np.savez(target / f"shard_{number:05d}.npz", allow_pickle=False, sample=part["sample"].values, **arrays)
    described = {str(name): {"dimensions": list(v.dims), **v.attrs} for name, v in data.data_vars.items()}
    content = {"attributes": attributes, "labels": _labels(data), "variables": described}
    text = json.dumps(content, indent=1, default=_listed)
    (target / META).write_text(text + "\n", encoding="utf-8")


def _parts(data: xarray.Dataset) -> Iterator[xarray.Dataset]:
    for begin in range(0, data.sizes["sample"], SHARD_SAMPLES):
        yield data.isel(sample=slice(begin, begin + SHARD_SAMPLES))


def _headed(name: Hashable, values: xarray.DataArray) -> str:
    unit = values.attrs.get("units", "1")
    return str(name) if unit == "1" else f"{name} [{unit}]"


def _column(name: Hashable, values: xarray.DataArray, data: xarray.Dataset) -> Array | list[str]:
    content = values.values
    if name == "split":
        known = split_names(data)
        if content.size and content.max() >= len(known):
            raise StorageError("a sample has an unknown split; tactsim data check names it")
        return [known[int(number)] for number in content]
    return content if content.dtype.kind in "fiub" else [str(value) for value in content]


def _plain(value: Any) -> str | int | float:
    return value if isinstance(value, str | int | float) else json.dumps(value, default=_listed)


def _listed(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else str(value)


def main(store: str, target: str, splits: str) -> int:
    """Writes HDF5; what the child process does. What is wrong with the store is its last line, without a traceback."""
    names = json.loads(splits)
    try:
        attributes = Store.open(store).attributes
        data, failed = load(store, split=names), _failed(store, names)
        _hdf5(data, attributes, Path(target), failed=failed, card=_card(Path(store), data, names, OF_HDF5))
    except TactsimError as error:
        sys.stderr.write(f"{one_line(error)}\n")
        return StorageError.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
