"""Writes the pages that follow from the code, before Sphinx reads them, into ``docs/generated``; none of them is kept in git."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from case_pages import case_pages
from command_pages import command_pages
from module_pages import module_pages
from name_pages import name_pages
from point_pages import point_pages
from rule_pages import rule_pages
from sphinx.application import Sphinx
from sphinx.config import Config
from validation_pages import validation_pages
from verification_pages import verification_pages

Pages = dict[str, str]
"""Path below ``docs/generated`` -> text."""
SOURCES: tuple[Callable[[], Pages], ...] = (
    case_pages,
    command_pages,
    module_pages,
    name_pages,
    point_pages,
    rule_pages,
    validation_pages,
    verification_pages,
)


def setup(app: Sphinx) -> dict[str, Any]:
    """Connects what this module does to Sphinx."""
    app.connect("config-inited", _write)
    return {"parallel_read_safe": True}


def _write(app: Sphinx, config: Config) -> None:
    """Writes what has changed, so that an unchanged page is not read again, and removes what is no longer made."""
    folder = Path(app.confdir) / "generated"
    pages = {place: text for source in SOURCES for place, text in source().items()}
    for place, text in pages.items():
        path = folder / place
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    for path in folder.rglob("*"):
        if path.is_file() and path.relative_to(folder).as_posix() not in pages:
            path.unlink()
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_dir() and not any(path.iterdir()):
            shutil.rmtree(path)
