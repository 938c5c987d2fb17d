"""Figures without a window: made, styled and turned into PNG."""

from __future__ import annotations

import io
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from tactsim.outside.text import one_line

RESOLUTION = 160
"""In dots per inch."""

COMPRESSION = 4
"""Level of PNG: twice as fast as the usual 6, for files a tenth larger."""
PRINTED_RESOLUTION = 240
"""In dots per inch, of what is dense and therefore a picture inside a vector file."""
LONGEST_TITLE = 200
"""Characters; a case allows no longer title."""
VECTOR = {"svg.fonttype": "none", "svg.hashsalt": "tactsim", "pdf.fonttype": 42}
UNDATED = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
STYLE = {"font.size": 9.0, "axes.titlesize": 9.5, "axes.linewidth": 0.7, "legend.frameon": False, "lines.linewidth": 1.5}


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of a size in inches."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def encoded(figure: Figure, form: str = "png") -> bytes:
    """The figure as ``png``, ``svg`` or ``pdf``; the letters of a vector file stay letters, and no file holds the date."""
    content = io.BytesIO()
    if form == "png":
        figure.dpi = RESOLUTION
        # savefig would draw all of it twice, first to lay it out
        FigureCanvasAgg(figure).print_png(content, pil_kwargs={"compress_level": COMPRESSION})
    else:
        with rc_context(VECTOR):  # type: ignore[arg-type]
            figure.savefig(content, format=form, dpi=PRINTED_RESOLUTION, metadata=UNDATED[form])
    return content.getvalue()


def png(figure: Figure) -> bytes:
    """The figure as PNG."""
    return encoded(figure)


@dataclass(frozen=True)
class Plot:
    """A figure that is drawn when it is wanted, and encoded as it is wanted."""

    figure: Callable[[], Figure]

    def __call__(self, form: str = "png") -> bytes:
        return encoded(self.figure(), form)


def styled() -> AbstractContextManager[Any]:
    """A context in which new axes take the style of tactsim."""
    return rc_context(STYLE)  # type: ignore[arg-type]


def entitle(figure: Figure, title: str, below: str = "", *, size: float = 11) -> None:
    """Writes a title above a figure letter by letter, what a user wrote is no TeX, and a second line below it."""
    lines = [one_line(line, LONGEST_TITLE) for line in (title, below) if line]
    figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=size, fontweight="bold", parse_math=False)


def scale_of(largest: float, unit: str) -> tuple[float, str]:
    """Factor and prefixed unit in which a size in SI reads well, like ``(1e3, "mm")``."""
    for exponent, prefix in ((6, "M"), (3, "k"), (0, ""), (-3, "m"), (-6, "µ")):
        if largest >= 10.0**exponent:
            return 10.0**-exponent, f"{prefix}{unit}"
    return 1.0, unit


def despined(axis: Axes) -> None:
    """Takes away the upper and right line of the frame."""
    axis.spines[["top", "right"]].set_visible(False)


def weighted_percentiles(values: np.ndarray, weights: np.ndarray, percentiles: tuple[float, ...]) -> np.ndarray:
    """Values below which the given percentages of the weight lie."""
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    return np.interp(np.asarray(percentiles) / 100, share, values[order])


def extension(values: np.ndarray, limits: tuple[float, float]) -> str:
    """Which ends of a colour bar with these limits are pointed, as matplotlib calls it: those that values lie beyond."""
    beyond = bool(values.min() < limits[0]), bool(values.max() > limits[1])
    return {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[beyond]
