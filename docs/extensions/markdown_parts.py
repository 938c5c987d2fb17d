"""Pieces of Markdown as MyST reads it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from inspect import cleandoc


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Lines of a table; a cell is one line."""
    return [_line(header), _line(["---"] * len(header)), *(_line(row) for row in rows), ""]


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(one_line(cell).replace('|', chr(92) + '|') for cell in cells)} |"


def one_line(text: str) -> str:
    """The text without line breaks."""
    return " ".join(text.split())


def first_paragraph(text: str | None) -> str:
    """The first paragraph of a docstring as Markdown on one line."""
    return of_docstring(cleandoc(text or "").split("\n\n")[0].strip())


def of_docstring(text: str) -> str:
    """A paragraph of a docstring in Markdown: formulas and literals in its marks."""
    text = re.sub(r":math:`([^`]+)`", r"$\1$", text)
    text = re.sub(r":\w+:`~?(?:[\w.]+\.)?(\w+)`", r"`\1`", text)
    text = text.replace("``", "`")
    parts = re.split(r"(`[^`]*`|\$[^$]+\$)", text)  # outside these, an asterisk or an angle bracket is itself
    plain = [part if number % 2 else re.sub(r"([*<>\[\]_])", r"\\\1", part) for number, part in enumerate(parts)]
    return one_line("".join(plain))


def toctree(entries: Iterable[str], *, depth: int = 1, caption: str = "", hidden: bool = False) -> list[str]:
    """Lines of a table of contents; entries are documents. A hidden one stands beside the page, not in it."""
    options = [f":maxdepth: {depth}", *([f":caption: {caption}"] if caption else []), *([":hidden:"] if hidden else [])]
    return ["```{toctree}", *options, "", *entries, "```", ""]


def page(*lines: str | Iterable[str]) -> str:
    """The text of a page from its lines and lists of lines."""
    flat = [part for line in lines for part in ([line] if isinstance(line, str) else line)]
    return "\n".join(flat).rstrip() + "\n"
