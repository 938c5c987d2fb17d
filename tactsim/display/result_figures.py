"""Which figures a result has: found by the kind of its experiment."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from tactsim.registry import kinds
from tactsim.results import Result
from tactsim.units import FrozenModel

Drawing = Callable[[], bytes]
"""Draws one figure and returns it as PNG."""


class ResultFigures(FrozenModel, ABC):
    """The figures of one kind of experiment: subclass it in a new file of this package, with that kind as default."""

    kind: str

    @abstractmethod
    def drawings(self, result: Result) -> dict[str, Drawing]:
        """File name -> drawing, the main figure first; only what the result has the data for."""


def figures_for(result: Result) -> dict[str, Drawing]:
    """File name -> drawing of every figure of a result, the main one first; empty for a kind without figures."""
    found = kinds("tactsim.display", ResultFigures).get(result.kind)
    return found().drawings(result) if found else {}
