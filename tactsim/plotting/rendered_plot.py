"""A figure around pictures of a scene in 3D, which another process renders while other figures are drawn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from matplotlib.figure import Figure

from tactsim.errors import TactsimError
from tactsim.plotting.canvas import encoded

Made = TypeVar("Made")


class RenderedPlot(Generic[Made]):
    """A figure that is drawn when it is wanted; what it has to wait for can be begun before.

    Parameters
    ----------
    begun : starts the rendering
    drawn : the figure, around what ``begun`` returns
    """

    def __init__(self, begun: Callable[[], Made], drawn: Callable[[Made], Figure]):
        self._begun, self._drawn = begun, drawn
        self._waiting: Made | None = None

    def begin(self) -> None:
        """Starts the rendering; if that fails, drawing tries again and says why."""
        try:
            self._waiting = self._begun()
        except (TactsimError, OSError):
            self._waiting = None

    def figure(self) -> Figure:
        """The figure; its rendering is waited for, or begun if it has not been."""
        waiting, self._waiting = self._waiting, None
        return self._drawn(self._begun() if waiting is None else waiting)

    def __call__(self, form: str = "png") -> bytes:
        return encoded(self.figure(), form)
