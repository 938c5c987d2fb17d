"""What a case holds at any depth: its entries, and the seeds of random numbers among them."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import BaseModel

SEED = "seed"
"""Name of every field that holds a seed."""


def entries(value: object) -> list[tuple[str, object]]:
    """Name and value of each field of a model, key of a dictionary or place in a list; none of anything else."""
    if isinstance(value, BaseModel):
        return [(name, getattr(value, name)) for name in type(value).model_fields]
    if isinstance(value, dict):
        return [(str(key), item) for key, item in value.items()]
    if isinstance(value, list | tuple):
        return [(str(index), item) for index, item in enumerate(value)]
    return []


def seeds_in(value: object, path: tuple[str, ...] = ()) -> Iterator[tuple[str, int]]:
    """Key path, such as ``readout.seed``, and number of every seed in a model, at whatever depth."""
    for name, item in entries(value):
        if name == SEED and isinstance(item, int):
            yield ".".join((*path, name)), item
        else:
            yield from seeds_in(item, (*path, name))
