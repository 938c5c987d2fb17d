"""Which seeds of random numbers a case holds."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import BaseModel

SEED = "seed"
"""Name of every field that holds a seed."""


def seeds_in(value: object, path: tuple[str, ...] = ()) -> Iterator[tuple[str, int]]:
    """Key path, such as ``readout.seed``, and number of every seed in a model, at whatever depth."""
    if isinstance(value, BaseModel):
        entries = [(name, getattr(value, name)) for name in type(value).model_fields]
    elif isinstance(value, dict):
        entries = [(str(key), item) for key, item in value.items()]
    elif isinstance(value, list | tuple):
        entries = [(str(index), item) for index, item in enumerate(value)]
    else:
        return
    for name, item in entries:
        if name == SEED and isinstance(item, int):
            yield ".".join((*path, name)), item
        else:
            yield from seeds_in(item, (*path, name))
