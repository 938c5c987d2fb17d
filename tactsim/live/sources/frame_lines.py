"""Frames of a running sensor or program as JSON lines, format ``tactsim/frames/1``.

Each line is one JSON object in UTF-8 and ends with a newline. The first describes the matrices, lengths in m
(or text with a unit)::

    {"schema": "tactsim/frames/1", "matrix": {"rows": 3, "columns": 3, "pitch": 0.01, "size": 0.009},
     "block_size": [0.04, 0.04, 0.02], "title": "right hand"}

(here in two lines, in a stream in one). ``title`` may be left out. Every other line is a frame::

    {"time": 0.033, "closing": 0.0005, "taxel_force_upper": [[0.1, 0.2, 0.1], ...], "taxel_force_lower": [[...], ...]}

``time`` is in s, forces are in N pressing into the taxels, [row][column], row 1 nearest the front (smallest y), column 1 the
smallest x. ``null`` or ``"NaN"`` stands for a taxel that gives no number. May be left out: ``closing``, of each jaw from first
touch in m; ``saturated_upper`` and ``saturated_lower``, [row][column] of true and false. Another description may follow at any
time: it begins anew. A line that cannot be read is counted and reported, and the stream goes on. The latest frame wins.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from tactsim.array import Array
from tactsim.errors import InputError, shown
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.live.sources.scene import LARGEST_FORCE, Frame, PageScene, plain_scene
from tactsim.model import FrozenModel
from tactsim.outside.text import one_line
from tactsim.refusals import first_fault
from tactsim.units import Length, Positive

SCHEMA = "tactsim/frames/1"
LONGEST_LINE = 8 * 2**20
"""Bytes of the longest line that is read: two matrices of 256 x 256 numbers take less."""
KNOWN = ("time", "closing", *(f"{name}_{side}" for name in ("taxel_force", "saturated") for side in JAWS))


class Description(FrozenModel):
    """The first line."""

    schema_name: Annotated[Literal["tactsim/frames/1"], Field(alias="schema")]
    """Version of the format."""
    matrix: TaxelLayout
    """Taxels on each jaw."""
    block_size: tuple[Positive[Length], Positive[Length], Positive[Length]]
    """Of the undeformed tissue along x, y and z."""
    title: Annotated[str, Field(max_length=200)] = "live"
    """What the page calls it."""

    def scene(self) -> PageScene:
        """What is drawn."""
        return plain_scene(one_line(self.title), np.array(self.block_size), self.matrix)


def read_line(line: bytes | None, scene: PageScene | None) -> PageScene | Frame:
    """The content of a line, None for one that was too long, after the description that is in force, None before the first.

    Raises
    ------
    InputError
        If it cannot be read: what is wrong with it, and where.
    """
    if line is None:
        raise InputError(f"longer than {LONGEST_LINE} bytes")
    try:
        content = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise InputError(f"not JSON: {str(error)[:120]}") from None
    if not isinstance(content, dict):
        raise InputError(f"{shown(content)} is not an object; needed: {{...}}")
    if "schema" in content:
        return _description(content).scene()
    if scene is None:
        raise InputError(f'a frame before any description; the first line needs "schema": "{SCHEMA}", "matrix" and "block_size"')
    return _frame(content, scene)


def _description(content: dict[str, Any]) -> Description:
    try:
        return Description.model_validate_json(json.dumps(content), strict=True)  # true is no number, a list is a tuple
    except ValidationError as error:
        raise InputError(f"description: {first_fault(error)}"[:300]) from None


def _frame(content: dict[str, Any], scene: PageScene) -> Frame:
    unknown = [name for name in content if name not in KNOWN]
    if unknown:
        raise InputError(f"unknown key {shown(unknown[0])}; known: {', '.join(KNOWN)}")
    time = _number(content, "time")
    if time is None:
        raise InputError("time: missing; needed: a number of seconds")
    forces = np.stack([_matrix(content, f"taxel_force_{side}", scene) for side in JAWS])
    large = np.argwhere(np.isfinite(forces) & (np.abs(forces) > LARGEST_FORCE))
    if len(large):
        jaw, row, column = (int(k) for k in large[0])
        value = f"{forces[jaw, row, column]:g} N; allowed: up to {LARGEST_FORCE:g} N"
        raise InputError(f"taxel_force_{JAWS[jaw]}: row {row + 1}, column {column + 1} is {value}")
    saturated = [_matrix(content, f"saturated_{side}", scene, missing=0.0) for side in JAWS]
    return Frame(forces, np.isfinite(forces) & (np.stack(saturated) == 0), time, _number(content, "closing"))


def _number(content: dict[str, Any], name: str) -> float | None:
    value = content.get(name)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        raise InputError(f"{name}: {shown(value)}; needed: a finite number")
    return float(value)


def _matrix(content: dict[str, Any], name: str, scene: PageScene, *, missing: float | None = None) -> Array:
    """Numbers (row, column), NaN where there is none."""
    rows, columns = scene.layout.rows, scene.layout.columns
    if name not in content:
        if missing is None:
            raise InputError(f"{name}: missing; needed: {rows} rows of {columns} numbers")
        return np.full((rows, columns), missing)
    value = content[name]
    if not isinstance(value, list) or len(value) != rows:
        raise InputError(f"{name}: {_count(value, 'rows')}; needed: {rows} rows of {columns} numbers")
    for number, row in enumerate(value, 1):
        if not isinstance(row, list) or len(row) != columns:
            raise InputError(f"{name}, row {number}: {_count(row, 'numbers')}; needed: {columns} numbers")
    return np.array(
        [list(_numbers(row, f"{name}, row {number}", flags=missing is not None)) for number, row in enumerate(value, 1)]
    )


def _count(value: Any, what: str) -> str:
    return f"{len(value)} {what}" if isinstance(value, list) else shown(value)


def _numbers(row: list[Any], place: str, flags: bool) -> Iterator[float]:
    for column, value in enumerate(row, 1):
        if isinstance(value, int | float) and (flags or not isinstance(value, bool)):
            yield float(value) if abs(value) < 1e300 or value != value else float("nan")
        elif value is None or (isinstance(value, str) and value.lower() == "nan"):
            yield float("nan")
        else:
            raise InputError(f'{place}, column {column}: {shown(value)}; needed: a number, null or "NaN"')


class LineSplitter:
    """Cuts a stream of bytes into lines, with bounded memory: of a line that is too long only the fact is kept."""

    def __init__(self, longest: int = LONGEST_LINE):
        self._longest = longest
        self._waiting = bytearray()
        self._skipping = False

    def lines(self, chunk: bytes) -> Iterator[bytes | None]:
        """The lines that end in a chunk; None stands for one that was too long."""
        *ended, rest = chunk.split(b"\n")
        for part in ended:
            whole, skipped = bytes(self._waiting) + part, self._skipping
            self._waiting.clear()
            self._skipping = False
            if skipped or len(whole) > self._longest:
                yield None
            elif whole.strip():
                yield whole
        if not self._skipping:
            self._waiting += rest
        if len(self._waiting) > self._longest:
            self._waiting.clear()
            self._skipping = True
