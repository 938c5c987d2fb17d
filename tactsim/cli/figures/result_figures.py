"""Figures of a command, and the forms of their files."""

from __future__ import annotations

from pathlib import Path

from tactsim.errors import InputError
from tactsim.outside.text import one_line
from tactsim.plotting.drawn import drawn_figures, rendered_figures

__all__ = ["FORMS", "drawn_figures", "form_of", "rendered_figures"]
FORMS = ("png", "svg", "pdf")
"""Forms of a figure's file."""


def form_of(path: Path) -> str:
    """The form that the ending of a file names.

    Raises
    ------
    InputError
        If it is none of them.
    """
    form = path.suffix.lower().removeprefix(".")
    if form not in FORMS:
        raise InputError(f"--save {one_line(path)}: a figure is saved as {', '.join(f'.{known}' for known in FORMS)}")
    return form
