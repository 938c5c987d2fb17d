"""The labels along the dimensions of a store, which xarray reads as coordinates: jaws, rows, columns, and the axes of a vector.

They are arrays without samples beside the variables. A store of an earlier tactsim has none until it is resumed; all that tactsim
reads has them, for they follow from the dimensions.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.store.arrays import CHUNK_SAMPLES, META, described
from tactsim.dataset.store.files import GuardedFiles
from tactsim.dataset.store.opening import Store
from tactsim.errors import StorageError
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.interfaces.variable import Variable

if TYPE_CHECKING:
    import zarr

NAMED: Mapping[str, tuple[str, ...]] = {"jaw": JAWS, "axis": ("x", "y", "z")}
COUNTED = ("row", "column")
"""Dimensions whose entries are counted from one, as messages and figures count them."""


def labels_along(sizes: Mapping[str, int]) -> dict[str, Array]:
    """Dimension -> its labels (n,), of those that have labels."""
    named = {name: np.array(words) for name, words in NAMED.items() if sizes.get(name) == len(words)}
    counted = {name: np.arange(1, sizes[name] + 1) for name in COUNTED if 0 < sizes.get(name, 0) <= CHUNK_SAMPLES}
    return named | counted


def labels_of(variables: Iterable[Variable]) -> dict[str, Array]:
    """Labels (n,) along the dimensions of variables that have labels, by their names."""
    return labels_along({name: size for one in variables for name, size in zip(one.dimensions, one.sizes, strict=True)})


def add_label(group: zarr.Group, name: str, labels: Array) -> None:
    """Writes the labels (n,) along a dimension."""
    kind: Any = str if labels.dtype.kind == "U" else labels.dtype
    words = f"{name}, counted from 1" if name in COUNTED else name
    attributes: dict[str, Any] = {"units": "1", "long_name": words, "role": "index"}
    shape = labels.shape
    array = group.create_array(name, shape=shape, chunks=shape, dtype=kind, dimension_names=(name,), attributes=attributes)
    array[:] = labels


def missing_labels(store: Store, variables: Iterable[Variable]) -> dict[str, Array]:
    """Labels (n,) that a store does not have, as one of an earlier tactsim, by the names of the dimensions."""
    return {name: one for name, one in labels_of(variables).items() if not os.path.lexists(store.path / name / META)}


def label_faults(store: Store, variables: Iterable[Variable]) -> Iterator[str]:
    """What is wrong with the labels that a store has."""
    variables = list(variables)
    missing = missing_labels(store, variables)
    for name, labels in labels_of(variables).items():
        if name in missing:
            continue
        remedy = f"remove the folder {name} and go on with --resume, which makes it anew"
        try:
            array = described(store.path, name)
            written = GuardedFiles(store.path, {name: array}).rows(name, ...)
        except StorageError as error:
            yield f"{error}, or {remedy}"
            continue
        if array.dimensions != (name,) or written.tolist() != labels.tolist():
            yield f"the labels along {name} are not {labels[0]} to {labels[-1]}; {remedy}"
