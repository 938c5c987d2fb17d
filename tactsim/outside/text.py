"""Text that others wrote, made harmless: what it says is shown, what it could do to a terminal, a page or a table is not."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Sequence
from itertools import zip_longest

LONGEST_LINE = 500
"""Characters of a foreign text that are shown: more than any title or reason of this program has."""
_ESCAPED = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})
"""Unicode categories that move the cursor, reverse the reading order, end a line or show as nothing."""
_KEPT = frozenset("\n\t")


def one_line(text: object, longest: int = LONGEST_LINE) -> str:
    """``text`` on one line of at most ``longest`` characters, with control characters spelled out, such as ``\\x1b``.

    Long text is cut in the middle, where a name or a reason says least.
    """
    return _bounded(_harmless(_bounded(str(text), longest), frozenset()), longest)


def printable(text: str) -> str:
    """Several lines as they may go to a terminal or a log: line breaks and tabs stay, all other control characters are spelled
    out."""
    return _harmless(text, _KEPT)


def first_names(names: Sequence[object], most: int) -> str:
    """The first ``most`` names, and how many others there are, such as ``a, b and 4 more``."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(map(str, names[:most])) + more


def counted(count: int, name: str, plural: str = "") -> str:
    """How many there are of something, such as ``1 sample`` and ``2 samples``; the plural is the name with an s by default."""
    return f"{count} {name if count == 1 else plural or name + 's'}"


def aligned(table: Sequence[Sequence[str]], *, left: int = 1, least: Sequence[int] = (), indent: str = "") -> list[str]:
    """Lines of a table for a terminal: the cells of the first ``left`` columns begin in line, those of the others end in line.

    A column is as wide as its widest cell, and at least as wide as ``least`` has it in characters.
    """
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    widths = [max(width) for width in zip_longest(widths, least, fillvalue=0)]
    lines = ([*map(str.ljust, row[:left], widths), *map(str.rjust, row[left:], widths[left:])] for row in table)
    return [indent + "  ".join(line).rstrip() for line in lines]


def markdown_table(header: Sequence[object], rows: Iterable[Iterable[object]]) -> list[str]:
    """Lines of a table in Markdown."""
    return [markdown_row(header), markdown_row(["---"] * len(header)), *map(markdown_row, rows)]


def markdown_row(cells: Iterable[object]) -> str:
    """Line of a table in Markdown; a bar in a cell does not end it."""
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def _harmless(text: str, kept: frozenset[str]) -> str:
    return text if text.isascii() and text.isprintable() else "".join(_spelled(character, kept) for character in text)


def _spelled(character: str, kept: frozenset[str]) -> str:
    if character in kept or unicodedata.category(character) not in _ESCAPED:
        return character
    return character.encode("unicode_escape").decode("ascii")


def _bounded(text: str, longest: int) -> str:
    if len(text) <= longest:
        return text
    head = (longest - 3) // 2
    return f"{text[:head]}...{text[head + 3 - longest :]}"
