"""The lines of a CSV file, and what of it a message may show.

A case of a stranger may name any file of this machine as a table; what stands in it is shown only if it is a table and stands
where a table of a case belongs.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from tactsim.errors import InvalidQuantity
from tactsim.outside.files import opened
from tactsim.outside.text import one_line

MOST_LINES, MOST_CELLS = 3_000_000, 10_000_000
"""Lines and cells of a table, each of which takes some 50 bytes in memory: days of a signal of 10 Hz."""
LINE_ENDS = "\n\r\v\f\x1c\x1d\x1e\x85\u2028\u2029"
"""Characters at which text is cut into lines."""
SEPARATORS = (",", ";", "\t")
"""Of columns, the first that stands in the first line; where it is no comma, a comma is that of a decimal fraction."""
HIDDEN = "(contents hidden: shown only for table files beside the case or in the working folder)"
"""What a message says instead of the content of another file."""
NO_TABLE = "(contents hidden: no row of the file holds two numbers or more and nothing else, as every table has one)"
"""The same of a file that is no table, wherever it stands."""
LONGEST_CELL = 80
"""Characters of a cell or a line that a message shows."""


@dataclass(frozen=True)
class Table:
    """Header and data lines of a file with their numbers, without blanks and comments.

    ``quotable`` is as of ``OutsideFile``, ``numeric`` states whether any row holds numbers.
    """

    name: str
    lines: tuple[tuple[int, str], ...]
    quotable: bool
    numeric: bool
    separator: str = ","

    @property
    def header(self) -> list[str]:
        """The cells of the first line.

        Raises
        ------
        InvalidQuantity
            If the line is no row of a table.
        """
        number, line = self.lines[0]
        return self.cells(number, line)

    def below(self, number: int) -> Table:
        """The table whose header is the line of this number, counted from 0, of those that are left."""
        return replace(self, lines=self.lines[number:])

    def cells(self, number: int, line: str) -> list[str]:
        """The cells of a line, without blanks around them.

        Raises
        ------
        InvalidQuantity
            If the line is no row of a table.
        """
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=self.separator), [])]
        except csv.Error as error:
            raise InvalidQuantity(f"{self.place(number)}: {one_line(error)}; allowed: one number per column") from None

    def place(self, number: int) -> str:
        """A line as messages name it."""
        return f"{one_line(self.name)}:{number}"

    def quoted(self, text: str) -> str:
        """A cell of a row as a message shows it, once the header is known to be that of a table."""
        return f"'{one_line(text, LONGEST_CELL)}'" if self.quotable else HIDDEN

    def quoted_header(self, text: str) -> str:
        """What stands in the first line as a message shows it."""
        return self.quoted(text) if self.numeric or not self.quotable else NO_TABLE

    def numbers(self, names: Sequence[str] = ()) -> list[list[float]]:
        """The finite numbers of every row below the header, as many as it has columns, which messages call by ``names``.

        Raises
        ------
        InvalidQuantity
            With file and line.
        """
        columns = names or [f"column {number}" for number in range(1, len(self.header) + 1)]
        return [self._row(number, line, columns) for number, line in self.lines[1:]]

    def _row(self, number: int, line: str, columns: Sequence[str]) -> list[float]:
        cells, place = self.cells(number, line), self.place(number)
        if len(cells) != len(columns):
            raise InvalidQuantity(f"{place}: {len(cells)} values in a row of {len(columns)} columns")
        values = [_number(cell, self.separator) for cell in cells]
        for value, cell, name in zip(values, cells, columns, strict=True):
            if not math.isfinite(value):
                raise InvalidQuantity(f"{place}: {name} is {self.quoted(cell)}; allowed: a finite number")
        return values


def read_table(path: str | Path) -> Table:
    """The table in a CSV file in UTF-8; blank lines and lines that begin with ``#`` are skipped.

    Columns are separated by commas, or by semicolons or tabs, with decimal commas or points, as other languages write them.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If nothing is left, or it is too long.
    """
    file = opened(path, "table")
    text, name = file.text(), one_line(path)
    if sum(map(text.count, LINE_ENDS)) > MOST_LINES or max(map(text.count, SEPARATORS)) > MOST_CELLS:
        raise InvalidQuantity(f"{name}: more than {MOST_LINES} lines or {MOST_CELLS} cells; leave out what is not needed")
    rows = ((number, line) for number, line in enumerate(text.splitlines(), 1))
    lines = tuple((number, line) for number, line in rows if line.strip() and not line.lstrip().startswith("#"))
    if not lines:
        raise InvalidQuantity(f"{name}: no header and no data")
    separator = next((one for one in SEPARATORS if one in lines[0][1]), ",")
    return Table(str(path), lines, file.quotable, any(_is_row(line, separator) for _, line in lines[1:]), separator)


def _is_row(line: str, separator: str) -> bool:
    """Whether a line consists of two numbers or more, as every table has and no other text."""
    cells = line.split(separator)
    return len(cells) > 1 and all(math.isfinite(_number(cell, separator)) for cell in cells)


def _number(cell: str, separator: str) -> float:
    """The number in a cell, NaN if there is none."""
    try:
        return float(cell if separator == "," else cell.replace(",", ".", 1))
    except ValueError:
        return math.nan
