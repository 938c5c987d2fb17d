"""What draws one figure of a result."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Drawing(Protocol):
    """Draws one figure when it is wanted, such as `tactsim.plotting.canvas.Plot`."""

    @property
    def figure(self) -> Callable[[], Any]:
        """Returns it as a figure of matplotlib."""

    def __call__(self, form: str = "png") -> bytes:
        """It as a file of this form, ``png``, ``svg`` or ``pdf``."""
