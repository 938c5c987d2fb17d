"""Which figures a result has: found by the kind of its experiment."""

from __future__ import annotations

from tactsim.errors import UnknownName
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.registry import kind_class
from tactsim.results import Result


def figures_for(result: Result) -> dict[str, Drawing]:
    """File name -> drawing of every figure of a result, the main one first; empty for a kind without figures."""
    try:
        figures = kind_class(ResultFigures, result.kind)
    except UnknownName:
        return {}
    return dict(figures().drawings(result))
