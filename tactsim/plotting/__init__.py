"""What figures share: canvas, off-screen window, cuts; each experiment's own figures stand in its folder."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tactsim.interfaces import Drawing
    from tactsim.results import Result


def figures_for(result: Result) -> dict[str, Drawing]:
    """File name -> drawing of every figure of a result, the main one first; empty for a kind without figures.

    Raises
    ------
    InvalidQuantity
        If the class of the kind's figures returns something else.
    """
    from tactsim.errors import (
        InvalidQuantity,
        UnknownName,
        shown,
    )  # here, since the renderer, a process of its own, does without them
    from tactsim.interfaces import Drawing, ResultFigures
    from tactsim.registry import kind_class

    try:
        figures = kind_class(ResultFigures, result.kind)
    except UnknownName:
        return {}
    drawings: object = figures().drawings(result)
    if not isinstance(drawings, Mapping) or not all(isinstance(one, Drawing) for one in drawings.values()):
        needed = "file name -> Drawing, such as {'a.png': Plot(lambda: a figure of matplotlib)} with tactsim.plotting.canvas.Plot"
        raise InvalidQuantity(f"drawings() of {figures.__name__} returned {shown(drawings)}; needed: {needed}")
    return dict(drawings)
