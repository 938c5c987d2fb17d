"""Plain data of figures with curves, as the report draws them: panels one above the other over the same quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import Field

from tactsim.array import Array

Data = dict[str, Any]
"""Text, numbers, lists and mappings, which JSON can hold."""
Title = Annotated[str, Field(description="Title of the figure.")]


def series(label: str, x: Array, y: Array, style: str = "line") -> Data:
    """A curve through the points ``x``, ``y`` of the same shape (n,), drawn as ``line`` or ``points``."""
    return {"label": label, "x": x.tolist(), "y": y.tolist(), "style": style}


def panel(y_axis: str, unit: str, curves: Sequence[Data], **options: bool) -> Data:
    """Curves over the same axis; values with a unit are in SI, others are drawn as they are; ``logarithmic`` is optional."""
    return {"y_axis": y_axis, "unit": unit, "curves": list(curves), **options}


def curves_figure(title: str, x_axis: str, x_unit: str, panels: Sequence[Data], **options: bool) -> Data:
    """The whole figure; ``even_panels`` (of the same height) and ``x_logarithmic`` are optional."""
    return {"form": "curves", "title": title, "x_axis": x_axis, "x_unit": x_unit, "panels": list(panels), **options}
