"""Which figures a result has: found by the kind of its experiment."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import ClassVar

from tactsim.interfaces import Kind
from tactsim.registry import kinds
from tactsim.results import Result

Drawing = Callable[[], bytes]
"""Draws one figure and returns it as PNG."""


class ResultFigures(Kind):
    """The figures of one kind of experiment: subclass it in a module ``figures`` of its folder, with that kind as default."""

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.figures(\.\w+)?"

    @abstractmethod
    def drawings(self, result: Result) -> dict[str, Drawing]:
        """File name -> drawing, the main figure first; only what the result has the data for."""


def figures_for(result: Result) -> dict[str, Drawing]:
    """File name -> drawing of every figure of a result, the main one first; empty for a kind without figures."""
    found = kinds(ResultFigures).get(result.kind)
    return found().drawings(result) if found else {}
