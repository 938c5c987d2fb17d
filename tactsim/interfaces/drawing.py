"""What draws one figure of a result, and the figure within a page."""

from __future__ import annotations

import base64
from collections.abc import Callable
from typing import Any, Protocol


class Drawing(Protocol):
    """Draws one figure when it is wanted, such as `tactsim.plotting.canvas.Plot`."""

    @property
    def figure(self) -> Callable[[], Any]:
        """Returns it as a figure of matplotlib."""

    def __call__(self, form: str = "png") -> bytes:
        """It as a file of this form, ``png``, ``svg`` or ``pdf``."""


def png_source(content: bytes) -> str:
    """A PNG as the address of a picture that stands within its HTML page."""
    return f"data:image/png;base64,{base64.b64encode(content).decode()}"
