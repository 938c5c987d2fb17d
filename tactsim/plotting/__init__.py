"""What figures share: canvas, off-screen window, cuts; each experiment's own figures stand in its folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tactsim.interfaces import Drawing
    from tactsim.results import Result


def figures_for(result: Result) -> dict[str, Drawing]:
    """File name -> drawing of every figure of a result, the main one first; empty for a kind without figures."""
    from tactsim.errors import UnknownName  # here, since the renderer, a process of its own, does without them
    from tactsim.interfaces import ResultFigures
    from tactsim.registry import kind_class

    try:
        figures = kind_class(ResultFigures, result.kind)
    except UnknownName:
        return {}
    return dict(figures().drawings(result))
