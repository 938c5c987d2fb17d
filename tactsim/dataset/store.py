"""The Zarr store of a data set: created, opened, and written block by block so that a kill leaves whole samples."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.dataset.block import Block
from tactsim.dataset.variable import PENDING, Variable
from tactsim.errors import StorageError
from tactsim.results.storage import naming, read_text, sync

Array = np.ndarray
STORE_SCHEMA = "tactsim/dataset/1"
META = "zarr.json"
"""What describes an array or the group, in its folder."""
NEEDED = ("title", "description", "license", "sweep", "sweep_id", "samples_per_specimen", "seed", "codes", "versions", "limits")
"""Attributes without which a store is no data set."""
CHUNK_BYTES = 2 * 2**20
"""Largest chunk of a variable, about."""
CHUNK_SAMPLES = 1024
"""Most samples in a chunk."""


class Store:
    """A Zarr group (format 3) with one array per variable; the first dimension is the sample.

    A reader sees a sample by its ``status``, which is written after everything else of it.
    """

    def __init__(self, path: Path, group: Any):
        self.path, self.group = path, group

    @classmethod
    def create(cls, path: Path, variables: Sequence[Variable], samples: int, attributes: Mapping[str, Any]) -> Store:
        """A new store in which every sample is pending."""
        import zarr

        with naming(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            group = zarr.open_group(path, mode="w-", zarr_format=3, attributes={**attributes, "schema": STORE_SCHEMA})
            per_chunk = chunk_samples(variables, samples)
            for variable in variables:
                group.create_array(
                    variable.name,
                    shape=(samples, *variable.sizes),
                    chunks=(per_chunk, *(max(1, size) for size in variable.sizes)),
                    dtype=str if variable.dtype == "str" else variable.dtype,
                    fill_value=variable.fill,
                    dimension_names=("sample", *variable.dimensions),
                    attributes=variable.attributes(),
                )
        store = cls(path, group)
        store.consolidate()
        return store

    @classmethod
    def open(cls, path: str | Path, *, writing: bool = False) -> Store:
        """A store that a sweep wrote.

        Raises
        ------
        StorageError
            If there is none, it is damaged, or it is of another version.
        """
        import zarr

        folder = Path(path)
        _check_described(folder)
        try:
            group = zarr.open_group(folder, mode="r+" if writing else "r", zarr_format=3, use_consolidated=False)
            known = "status" in group
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise StorageError(f"{folder} cannot be opened: {error}") from None
        if not known:
            raise StorageError(f"{folder} is damaged: it has no variable status; compute it anew, or bring back a copy")
        return cls(folder, group)

    @property
    def attributes(self) -> dict[str, Any]:
        """What the store says of itself."""
        return dict(self.group.attrs)

    def tell(self, **attributes: Any) -> None:
        """Changes attributes."""
        with naming(self.path):
            self.group.attrs.update(attributes)
        self.consolidate()

    def consolidate(self) -> None:
        """Gathers the metadata in one file, which opens fast and without a word about other files beside the arrays."""
        import zarr

        with naming(self.path), warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Consolidated metadata", category=UserWarning)
            zarr.consolidate_metadata(self.path, zarr_format=3)
            sync(self.path / META)
            sync(self.path)

    def read(self, name: str) -> Array:
        """All values of a variable."""
        with naming(self.path / name, "read"):
            values = np.asarray(self.group[name][...])
        return values if values.dtype.kind in "fiub" else np.array([str(value) for value in values])

    @property
    def arrays(self) -> dict[str, Any]:
        """Name -> array, in the order of the names; what else stands in the folder is passed over."""
        with naming(self.path, "read"):
            names = sorted(place.parent.name for place in self.path.glob(f"*/{META}"))
            return {name: self.group[name] for name in names}

    @property
    def samples(self) -> int:
        """Number of samples, computed or not."""
        return int(self.group["status"].shape[0])

    def extend(self, samples: int, variables: Iterable[Variable]) -> None:
        """Makes room for more samples."""
        with naming(self.path):
            for variable in variables:
                array = self.group[variable.name]
                array.resize((samples, *array.shape[1:]))
                sync(self.path / variable.name / META)
        self.consolidate()

    def write(self, block: Block, variables: Sequence[Variable]) -> None:
        """Puts samples into the arrays and down to the disk: all variables, and only then their status.

        Each chunk is replaced as a whole, so that a kill leaves the earlier or the later one.
        """
        others = [variable for variable in variables if variable.name != "status"]
        status = [variable for variable in variables if variable.name == "status"]
        with naming(self.path):
            for part in (others, status):
                places = [place for variable in part for place in self._put(block, variable)]
                for place in dict.fromkeys(places):
                    if place.exists():  # a chunk of nothing but the fill value is no file
                        sync(place)

    def _put(self, block: Block, variable: Variable) -> list[Path]:
        """Puts a variable of some samples into its array; the files and folders that this changed."""
        array, folder, changed = self.group[variable.name], self.path / variable.name, []
        numbers, per_chunk = block["sample"], int(array.chunks[0])
        for chunk in np.unique(numbers // per_chunk).tolist():
            own = numbers // per_chunk == chunk
            begin, end = chunk * per_chunk, min((chunk + 1) * per_chunk, array.shape[0])
            content = folder / array.metadata.encode_chunk_key((chunk, *(0 for _ in variable.sizes)))
            new = [place for place in content.parents[: len(variable.dimensions) + 1] if not place.exists()]
            values = array[begin:end]
            values[numbers[own] - begin] = block[variable.name][own]
            array[begin:end] = values
            changed += [
                content,
                *new,
                content.parents[len(new)],
                *([folder / META] if content.parents[len(new)] == folder else ()),
            ]
        return changed

    def pending(self) -> Array:
        """Numbers of the samples that are not computed."""
        return np.flatnonzero(self.read("status") == PENDING)


def _check_described(folder: Path) -> None:
    """Refuse a folder that does not say of itself that it is a data set which this version reads."""
    if not folder.exists():
        raise StorageError(f"{folder} is not a data set of tactsim: there is nothing; name a folder that tactsim sweep wrote")
    if not (folder / META).is_file():
        older = "; it is of Zarr format 2, tactsim writes format 3" if (folder / ".zgroup").exists() else ""
        raise StorageError(f"{folder} is not a data set of tactsim: it holds no {META}{older}")
    try:
        told = json.loads(read_text(folder / META, "description"))
        attributes = dict(told.get("attributes", {}))
    except (ValueError, AttributeError, TypeError, RecursionError) as error:
        raise StorageError(f"{folder} cannot be opened: {META} is damaged: {error}") from None
    schema = attributes.get("schema")
    if schema is None or told.get("node_type") != "group":
        raise StorageError(
            f"{folder} is not a data set of tactsim: it is Zarr of another origin, without the schema {STORE_SCHEMA!r}"
        )
    if schema != STORE_SCHEMA:
        raise StorageError(
            f"{folder} has the schema {schema!r}; this tactsim reads {STORE_SCHEMA!r}; use the version that wrote it: "
            f"{attributes.get('codes', ['unknown'])[-1]}"
        )
    missing = [name for name in NEEDED if name not in attributes]
    if missing:
        raise StorageError(f"{folder} is damaged: {META} does not tell {', '.join(missing)}; bring back a copy")


def chunk_samples(variables: Iterable[Variable], samples: int) -> int:
    """Samples in a chunk, the same for every variable: a power of two."""
    largest = max(int(np.prod(v.sizes)) * (64 if v.dtype == "str" else np.dtype(v.dtype).itemsize) for v in variables)
    fitting = max(1, min(CHUNK_SAMPLES, CHUNK_BYTES // max(largest, 1), samples))
    return 1 << (fitting.bit_length() - 1)
