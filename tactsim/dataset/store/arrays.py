"""The variables that every store has, and what the ``zarr.json`` files of a store say of its arrays.

They are read within bounds and held against what a sweep can have written. Nothing is allocated by a number in a file alone: an
array with other types, chunks or codecs than a sweep writes, or with more samples than a sweep may have, is refused before Zarr
sees it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.dataset.cost import COST, cost_variables
from tactsim.errors import StorageError
from tactsim.interfaces.variable import Variable
from tactsim.outside import json_text
from tactsim.outside.files import opened
from tactsim.outside.text import one_line

META = "zarr.json"
"""What describes an array or the group, in its folder."""
CHUNK_SAMPLES = 1024
"""Most samples in a chunk."""
LARGEST_CHUNK = 256 * 2**20
"""Bytes of a chunk beyond which a single sample is no longer sensible: a history of 100 000 times of 2 x 16 x 10 taxels."""
LONGEST_TEXT = 2**14
"""Bytes of one stored text; reasons are cut at 500 characters, the warnings of a sample at 2 000."""
MOST_NESTED = 64
"""Levels of lists and mappings in a description; a sweep file has some ten."""
TYPES = ("float64", "float32", "int64", "int32", "int16", "int8", "uint64", "uint32", "uint16", "uint8", "bool", "string")
IN_WORDS = ("units", "long_name", "role")
"""Attributes in words that every variable has."""
BYTES, TEXT, PACKED = "bytes", "vlen-utf8", "zstd"
"""Codecs of numbers and of text, and the compression of both."""
MOST_SAMPLES = 10_000_000
"""Samples of a data set: a month of a thousand processes at a sample in four minutes, or a day of the closed form."""
STATUS = ("pending", "done", "failed")
PENDING, DONE, FAILED = range(3)
CHECKSUM_BYTES = 32
WORDS = ("long_name", "flag_meanings")
"""Attributes whose wording may change from one version of tactsim to the next."""


@dataclass(frozen=True)
class ArrayDescription:
    """One array: the values of its ``zarr.json`` that are relied on, and all of it as ``metadata``."""

    name: str
    shape: tuple[int, ...]
    chunks: tuple[int, ...]
    dtype: str
    """As ``Variable.dtype`` calls it."""
    dimensions: tuple[str, ...]
    metadata: dict[str, Any]

    @property
    def attributes(self) -> dict[str, Any]:
        """Units, meaning and role, and the meanings of whole numbers."""
        return dict(self.metadata["attributes"])

    @property
    def chunk_bytes(self) -> int:
        """Bytes of an unpacked chunk; of text the most that it can take."""
        return math.prod(self.chunks) * (4 + LONGEST_TEXT) + 4 if self.dtype == "str" else _bytes(self.chunks, self.dtype)

    @property
    def stored_type(self) -> np.dtype[Any]:
        """Type of the values in a chunk, of text that of objects."""
        return np.dtype(object) if self.dtype == "str" else np.dtype(self.dtype).newbyteorder("<")

    def chunk_key(self, number: int) -> str:
        """Path in the store of the chunk with this number."""
        return "/".join((self.name, "c", str(number), *("0" for _ in self.shape[1:])))


def parsed_json(text: str, name: str) -> Any:
    """The value of a JSON text.

    Raises
    ------
    StorageError
        If it is none, holds a number that is not finite, or is nested more deeply than anything that a sweep writes.
    """
    try:
        return json_text.read_json(text, name, deepest=MOST_NESTED)
    except StorageError as error:
        raise StorageError(f"{error}; bring back a copy") from None


def read_json(path: Path) -> Any:
    """The value of a JSON file in a store.

    Raises
    ------
    StorageError
        If it is missing, a link, no regular file, too large, or not JSON.
    """
    refuse_link(path)
    return parsed_json(opened(path, "description").text(), one_line(path))


def refuse_link(path: Path) -> None:
    """Refuses a link in a store, which could lead anywhere.

    Raises
    ------
    StorageError
        If the path is one.
    """
    if path.is_symlink():
        raise StorageError(f"{one_line(path)} is a link; a data set holds none; put a copy of the file in its place")


def described(folder: Path, name: str) -> ArrayDescription:
    """The array of a name in a store.

    Raises
    ------
    StorageError
        If its description is missing, cannot be read, or is none that a sweep writes.
    """
    refuse_link(folder / name)
    metadata = read_json(folder / name / META)
    fault = next(_faults(metadata), "")
    if fault:
        raise StorageError(f"{one_line(folder / name / META)} is damaged: {fault}; bring back a copy of it")
    kind = str(metadata["data_type"])
    chunks = tuple(metadata["chunk_grid"]["configuration"]["chunk_shape"])
    dtype = "str" if kind == "string" else kind
    return ArrayDescription(name, tuple(metadata["shape"]), chunks, dtype, tuple(metadata["dimension_names"]), metadata)


def index_fault(array: ArrayDescription, samples: int, per_chunk: int) -> str:
    """What is wrong with an array beside the others of its store, empty if nothing is."""
    known = {variable.name: variable for variable in index_variables(()) if variable.name not in COST}  # may be readings
    if array.name in known and (array.dtype, array.shape[1:]) != (known[array.name].dtype, known[array.name].sizes):
        expected = known[array.name]
        return f"{array.dtype} of shape {array.shape}; expected: {expected.dtype} of shape {(samples, *expected.sizes)}"
    if array.chunks[0] != per_chunk:
        return f"chunks of {array.chunks[0]} samples; expected: {per_chunk}, as status has"
    meanings = array.attributes.get("flag_meanings", "")
    if not isinstance(meanings, str) or (array.name == "split" and not meanings):
        return f"flag_meanings is {one_line(meanings, 80)!r}; expected: names of numbers"
    return ""


def _faults(metadata: Any) -> Iterator[str]:
    """What no sweep writes."""
    if not isinstance(metadata, dict) or metadata.get("node_type") != "array" or metadata.get("zarr_format") != 3:
        yield "it is no array of Zarr format 3"
        return
    kind, shape = metadata.get("data_type"), metadata.get("shape")
    if kind not in TYPES:
        yield f"data_type is {one_line(kind, 80)!r}; allowed: {', '.join(TYPES)}"
    if not _lengths(shape, 0) or not shape or shape[0] > MOST_SAMPLES:
        yield f"shape is {one_line(shape, 80)}; allowed: up to {MOST_SAMPLES} samples"
        return
    yield from _chunk_faults(metadata, kind, shape)
    listed = metadata.get("codecs")
    codecs = [codec for codec in listed if isinstance(codec, dict)] if isinstance(listed, list) else []
    names: Any = [codec.get("name") for codec in codecs]
    if names != [TEXT if kind == "string" else BYTES, PACKED]:
        yield f"codecs are {one_line(names, 80)}; allowed: {TEXT if kind == 'string' else BYTES}, {PACKED}"
    elif kind in TYPES and kind != "string" and codecs[0] not in _plain_codecs(str(kind)):
        yield f"the codec {BYTES} is {one_line(codecs[0], 80)}; allowed: little endian"
    if metadata.get("storage_transformers"):
        yield f"storage_transformers are {one_line(metadata['storage_transformers'], 80)}; allowed: none"
    names = metadata.get("dimension_names")
    if not isinstance(names, list) or len(names) != len(shape) or not all(isinstance(name, str) for name in names):
        yield f"dimension_names is {one_line(names, 80)}; expected: {len(shape)} names"
    attributes = metadata.get("attributes")
    for key in IN_WORDS:
        if not isinstance(attributes, dict) or not isinstance(attributes.get(key), str):
            yield f"the attribute {key} is missing or no text"
            return


def _chunk_faults(metadata: dict[str, Any], kind: Any, shape: list[int]) -> Iterator[str]:
    grid: Any = metadata.get("chunk_grid")
    keys: Any = metadata.get("chunk_key_encoding")
    chunks: Any = grid.get("configuration", {}).get("chunk_shape") if _plain(grid, "regular") else None
    if not _lengths(chunks, 1) or len(chunks) != len(shape) or chunks[0] > CHUNK_SAMPLES:
        yield f"chunk_shape is {one_line(chunks, 80)}; expected: 1 to {CHUNK_SAMPLES} samples and {len(shape)} lengths"
    elif chunks[1:] != [max(1, size) for size in shape[1:]] or (kind in TYPES and _bytes(chunks, kind) > LARGEST_CHUNK):
        yield f"chunk_shape is {chunks} of {shape}; expected: whole samples of at most {LARGEST_CHUNK} bytes"
    if not _plain(keys, "default") or keys.get("configuration", {"separator": "/"}) != {"separator": "/"}:
        yield f"chunk_key_encoding is {one_line(keys, 80)}; expected: default"
    fill = metadata.get("fill_value")
    if not isinstance(fill, str if kind == "string" else int | float | str) or isinstance(fill, bool) is not (kind == "bool"):
        yield f"fill_value is {one_line(fill, 80)}"
    elif fill not in ("NaN", "", 0, False):
        yield f"fill_value is {one_line(fill, 80)}; allowed: NaN, 0 or empty text"


def _plain(value: Any, name: str) -> bool:
    return isinstance(value, dict) and value.get("name") == name and isinstance(value.get("configuration", {}), dict)


def _plain_codecs(kind: str) -> list[dict[str, Any]]:
    """How numbers may lie in a chunk; those of one byte have no order."""
    little = [{"name": BYTES, "configuration": {"endian": "little"}}]
    return [*little, {"name": BYTES}, {"name": BYTES, "configuration": {}}] if np.dtype(kind).itemsize == 1 else little


def _lengths(value: Any, least: int) -> bool:
    return isinstance(value, list) and all(type(length) is int and length >= least for length in value)


def _bytes(shape: Iterable[int], kind: str) -> int:
    return math.prod(shape) * (8 if kind in ("string", "str") else np.dtype(kind).itemsize)


def index_variables(splits: tuple[str, ...]) -> list[Variable]:
    """What every store has, whatever the experiment."""
    return [
        Variable("status", "1", "whether the sample was computed", "index", dtype="uint8", meanings=STATUS),
        Variable("reason", "1", "how the computation ended", "index", dtype="str"),
        Variable("warnings", "1", "what the run of the sample warned of, a line each", "index", dtype="str"),
        Variable("specimen", "1", "number of the specimen, which samples may share", "index", dtype="int64"),
        Variable("split", "1", "part of the data set, by specimen", "index", dtype="uint8", meanings=splits),
        Variable("seed", "1", "seed of the noise of the sample, where it has noise", "index", dtype="uint64"),
        Variable("redraws", "1", "draws of the specimen that were refused before", "index", dtype="uint32"),
        Variable("wall_time", "s", "time that the sample took", "index"),
        *cost_variables(),
        Variable("case_id", "1", "hash of the sample's resolved case", "index", dtype="str"),
        Variable("code", "1", "which entry of the attribute codes computed the sample", "index", dtype="uint8"),
        Variable("checksum", "1", "SHA-256 of the sample's other variables", "index", ("byte",), (CHECKSUM_BYTES,), "uint8"),
    ]


def differences(array: ArrayDescription, variable: Variable) -> Iterator[tuple[str, str]]:
    """What an array says, and how it differs from the variable that it holds; the number of samples is not looked at."""
    expected: dict[str, Any] = {
        "dtype": variable.dtype,
        "shape": [*variable.sizes],
        "dimension_names": ["sample", *variable.dimensions],
        "fill_value": "NaN" if variable.dtype.startswith("f") else variable.fill,
        **variable.attributes(),
    }
    stored: dict[str, Any] = {
        "dtype": array.dtype,
        "shape": [*array.shape[1:]],
        "dimension_names": [*array.dimensions],
        "fill_value": array.metadata["fill_value"],
        **array.attributes,
    }
    for key in sorted(expected.keys() | stored.keys()):
        if key not in expected:
            yield key, f"{key} is {_shown(stored[key])}, which tactsim does not write"
        elif key not in stored:
            yield key, f"{key} is missing; expected: {_shown(expected[key])}"
        elif stored[key] != expected[key]:
            yield key, f"{key} is {_shown(stored[key])}; expected: {_shown(expected[key])}"


def wrong_arrays(arrays: Iterable[ArrayDescription], variables: Iterable[Variable]) -> Iterator[tuple[str, str]]:
    """Name of an array -> how it differs, but for the wording."""
    known = {variable.name: variable for variable in variables}
    for array in arrays:
        if array.name in known:
            for key, words in differences(array, known[array.name]):
                if key not in WORDS:
                    yield array.name, words


def earlier_words(names: Iterable[str]) -> str:
    """What is reported of a store that never had some arrays."""
    return (
        f"an earlier version of tactsim began this data set, which did not store {', '.join(names)}; it can be read, and the "
        "long_name of each of its arrays says what that holds, but this version can neither resume nor check it"
    )


def _shown(value: Any) -> str:
    return one_line(json.dumps(value), 160)
