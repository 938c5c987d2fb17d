"""What draws one figure of a result, and the figure within a page."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterable
from typing import Any, Protocol, runtime_checkable


@runtime_checkable
class Drawing(Protocol):
    """Draws one figure when it is wanted, such as `tactsim.plotting.canvas.Plot`."""

    @property
    def figure(self) -> Callable[[], Any]:
        """Returns it as a figure of matplotlib."""

    def __call__(self, form: str = "png") -> bytes:
        """It as a file of this form, ``png``, ``svg`` or ``pdf``."""


@runtime_checkable
class BegunDrawing(Drawing, Protocol):
    """One of which a part, such as a rendering, may run in a process of its own while others are drawn."""

    def begin(self) -> None:
        """Starts that part; what fails is told when the figure is drawn."""


def begin_all(drawings: Iterable[object]) -> None:
    """Begins those of several drawings that can be: before the first of them is drawn."""
    for drawing in drawings:
        if isinstance(drawing, BegunDrawing):
            drawing.begin()


def png_source(content: bytes) -> str:
    """A PNG as the address of a picture that stands within its HTML page."""
    return f"data:image/png;base64,{base64.b64encode(content).decode()}"
