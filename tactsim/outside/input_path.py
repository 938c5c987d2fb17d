"""The type of a field of a case that names a file or folder to be read."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ValidationInfo, ValidatorFunctionWrapHandler, WrapValidator

from tactsim.outside.files import CasePath

LONGEST_PATH = 4096
"""Characters; no usual system takes a longer path."""


def _placed(value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> CasePath:
    if isinstance(value, CasePath):
        return value
    text = str(handler(value))
    if not text.strip() or "\0" in text or len(text) > LONGEST_PATH:
        raise ValueError(f"a path of 1 to {LONGEST_PATH} characters without a null character is needed")
    folder = (info.context or {}).get("folder")
    return CasePath(text, None if folder is None else Path(folder))


InputPath = Annotated[str, WrapValidator(_placed)]
"""Text that is looked for beside the case first and then in the working folder; the case's identity holds it as it is written."""


def input_paths(value: Any, place: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], CasePath]]:
    """Every path in a case that a file is read from, with its key path."""
    if isinstance(value, CasePath):
        yield place, value
        return
    entries: Any = ()
    if isinstance(value, BaseModel):
        entries = ((name, getattr(value, name)) for name in type(value).model_fields)
    elif isinstance(value, dict):
        entries = value.items()
    elif isinstance(value, list | tuple):
        entries = enumerate(value)
    for key, item in entries:
        yield from input_paths(item, (*place, key))
