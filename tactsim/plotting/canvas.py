"""Figures without a window: made, styled, titled, marked if they show a run that did not end as it should, and encoded."""

from __future__ import annotations

import html as markup
import io
import math
import re
import textwrap
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from tactsim.errors import InvalidQuantity
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.interfaces.drawing import png_source
from tactsim.outside.text import one_line
from tactsim.results import Result, Status
from tactsim.unit_conversion import compact

EVEN = 1e-4
"""Spread of values over their size below which they count as even."""
SKETCH = "sketch.png"
"""File of the figure of what is at rest."""
RESOLUTION = 160
"""In dots per inch."""

COMPRESSION = 2
"""Level of PNG: nearly twice as fast as the usual 6, for files an eighth larger."""
PRINTED_RESOLUTION = 240
"""In dots per inch, of what is dense and therefore a picture inside a vector file."""
TRACED = 250
"""Points per direction on which the outline of a rigid body is traced."""
SMALL_TITLE = 10.5
"""Size in points of a title that stands over little."""
LINE_COLOURS = ("#1f4e79", "#b8540a", "#2e7d32", "#6a1b9a", "#b00020", "#00838f")
"""Of the curves of a panel, one after another."""
NEXT_TO_NOTHING = 1e-9
"""In SI: curves that are smaller are round-off, and would fill an axis in pN."""
LONGEST_TITLE = 200
"""Characters; a case allows no longer title."""
TITLE_MARGIN = 0.01
"""Left and right of a title, over the width of the figure."""
VECTOR = {"svg.fonttype": "none", "svg.hashsalt": "tactsim", "pdf.fonttype": 42}
UNDATED = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titley": 1.0,  # no figure has a title above ticks; to look for them there takes a twentieth of the drawing
    "axes.linewidth": 0.7,
    "legend.frameon": False,
    "lines.linewidth": 1.5,
}
FAILED_COLOUR = "#b00020"
LINE_SPACING = 1.2
"""Height of a line of words over the size of their letters."""
FAILED_SIZE, LETTERS_PER_INCH, LINES_PER_INCH = 9.5, 9, 72 / (LINE_SPACING * 9.5)
"""Of the words across the foot of a failed run; the size in points."""
BRIGHT, LUMA = 0.5, (0.299, 0.587, 0.114)
"""Brightness of a colour above which words on it are black, and the weights of red, green and blue in it (ITU-R BT.601)."""
REGION_COLOURS = ("#f2d7c9", "#8fb4d9", "#b7d3a8", "#d9b3d6", "#f0dc9a", "#b0b6bf")
"""Of tissue and of what lies in or on it, by region; told apart in grey by the outlines and names."""
PRESSURE_COLOURS = "viridis"
"""The colour map of pressures and forces, the same in every figure and on the page.

Its lightness rises evenly from dark to bright, so that it reads alike in grey print and with any colour blindness, and its hues
are far enough apart to distinguish one level from the next, which those of cividis, most of them grey, are not.

Source: S. van der Walt & N. Smith 2015, https://bids.github.io/colormap; compared by J. Nunez, C. Anderton & R. Renslow 2018,
doi:10.1371/journal.pone.0199239.
"""


class ShownFigure(Figure):
    """A figure that a notebook shows as a picture at the end of a cell, though pyplot did not make it."""

    def _repr_png_(self) -> bytes:
        return encoded(self)


class Figures(dict[str, Figure]):
    """Figures by name; a notebook shows all of them, in their order, instead of the words of a mapping."""

    def _repr_html_(self) -> str:
        return "\n".join(picture(name, encoded(figure)) for name, figure in self.items())


def picture(name: str, content: bytes) -> str:
    """A PNG as it stands in HTML."""
    return f'<img alt="{markup.escape(name)}" style="max-width:100%" src="{png_source(content)}">'


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of a size in inches."""
    figure = ShownFigure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def checked_figure(drawn: object, name: str = "this figure") -> Figure:
    """What a drawing returned, if it is a figure of matplotlib.

    Raises
    ------
    InvalidQuantity
        If it is none; ``name`` is how the message calls the figure.
    """
    if not isinstance(drawn, Figure):
        raise InvalidQuantity(f"what draws {name} returned a {type(drawn).__name__}; needed: a figure of matplotlib")
    return drawn


def encoded(figure: Figure, form: str = "png") -> bytes:
    """The figure as ``png``, ``svg`` or ``pdf``; the letters of a vector file stay letters, and no file holds the date.

    Raises
    ------
    InvalidQuantity
        As `checked_figure`.
    """
    checked_figure(figure)
    content = io.BytesIO()
    if form == "png":
        figure.dpi = RESOLUTION
        # savefig would draw all of it twice, first to lay it out
        FigureCanvasAgg(figure).print_png(content, pil_kwargs={"compress_level": COMPRESSION})
    else:
        with rc_context(VECTOR):  # type: ignore[arg-type]
            figure.savefig(content, format=form, dpi=PRINTED_RESOLUTION, metadata=UNDATED[form])
    return content.getvalue()


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
    """Writes a title above a figure letter by letter, what a user wrote is no TeX, and a second line below it.

    What is wider than the figure goes on in a new line, by which the figure grows.
    """
    lines = [one_line(line, LONGEST_TITLE) for line in (title, below) if line]
    text = figure.suptitle("\n".join(lines), x=TITLE_MARGIN, ha="left", fontsize=size, fontweight="bold", parse_math=False)
    room = (1 - 2 * TITLE_MARGIN) * figure.bbox.width / max(text.get_window_extent().width, 1.0)
    if room < 1:
        letters = int(room * max(map(len, lines)))
        wrapped = [part for line in lines for part in textwrap.wrap(line, letters)]
        text.set_text("\n".join(wrapped))
        figure.set_figheight(figure.get_figheight() + (len(wrapped) - len(lines)) * LINE_SPACING * size / 72)


@contextmanager
def titled_figure(width: float, height: float, title: str, below: str = "", *, title_size: float = 11) -> Iterator[Figure]:
    """An empty figure of a size in inches, in the style of tactsim; it gets its title when what draws it is done."""
    with styled():
        figure = new_figure(width, height)
        yield figure
        entitle(figure, title, below, size=title_size)


@contextmanager
def result_figure(
    result: Result,
    size: tuple[float, float],
    title: str = "",
    *,
    remark: str = "",
    below: str = "",
    where: str = "",
    title_size: float = 11,
) -> Iterator[Figure]:
    """The figure of a result: as `titled_figure`, and marked unless the run converged or is a sketch of one; no figure of a
    result is made otherwise.

    Parameters
    ----------
    size : width and height in inches
    title : stands above a result without a title of its own
    remark : follows the title and a colon
    below : second line of the title
    where : what follows the status of a run that did not converge, such as " at 2 s"
    """
    head = ": ".join(part for part in (result.title or title, remark) if part)
    with titled_figure(*size, head, below, title_size=title_size) as figure:
        yield figure
    if result.status is not Status.CONVERGED and not result.at_rest:
        _mark_failure(figure, result, where)


def _mark_failure(figure: Figure, result: Result, where: str) -> None:
    """Writes status and reason across a foot below the figure, in up to four lines above its legends, and a coloured frame."""
    words = f"{str(result.status).upper()}{where}: {result.reason.removeprefix(f'{result.status}; ')}"
    lines = textwrap.wrap(words, int(LETTERS_PER_INCH * figure.get_figwidth()), max_lines=4, placeholder=" …")
    legends = max((legend.get_window_extent().height / figure.dpi for legend in figure.legends), default=0.0)
    lines += [""] * int(np.ceil(LINES_PER_INCH * legends))
    figure.set_figheight(figure.get_figheight() + len(lines) / LINES_PER_INCH)
    figure.set_layout_engine("constrained", w_pad=0.12, h_pad=0.1)
    figure.supxlabel("\n".join(lines), color=FAILED_COLOUR, fontsize=FAILED_SIZE, fontweight="bold")
    figure.patch.set(edgecolor=FAILED_COLOUR, linewidth=5)


class SingleFigure(ResultFigures):
    """The figures of a kind that has one, in a file of the kind's name."""

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """The one figure, if there is anything to draw."""
        return {f"{self.kind}.png": Plot(lambda: self.figure(result))} if self.can_draw(result) else {}

    def can_draw(self, result: Result) -> bool:
        """Whether the result has what the figure shows: here, a step."""
        return bool(result.steps)

    @abstractmethod
    def figure(self, result: Result) -> Figure:
        """The figure of a result that has what it shows."""


def scale_of(largest: float, unit: str) -> tuple[float, str]:
    """Factor and prefixed unit in which a size in SI reads well, like ``(1e3, "mm")``; what is next to nothing has no prefix."""
    if not largest >= NEXT_TO_NOTHING:
        return 1.0, unit
    shown, prefixed = compact(largest, unit, "P")
    return float(f"1e{round(math.log10(shown / largest))}"), prefixed


def ink_on(colour: Sequence[float]) -> str:
    """Black or white, in which words are read on a colour of red, green and blue from 0 to 1."""
    return "k" if float(np.dot(colour[:3], LUMA)) > BRIGHT else "w"


def with_minus(words: str) -> str:
    """Numbers in words, and differences of which one is taken off, with the minus sign that axes have, not a hyphen."""
    return re.sub(r"(?<![\w.])-(?=[\d.])|(?<=[\w)] )-(?= [\d.])", "−", words)


def despined(axis: Axes) -> None:
    """Takes away the upper and right line of the frame."""
    axis.spines[["top", "right"]].set_visible(False)


def plain_decades(axis: Axes) -> None:
    """Ticks of a logarithmic ordinate at 1, 2 and 5 of each decade, as plain numbers."""
    axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def weighted_percentiles(values: np.ndarray, weights: np.ndarray, percentiles: tuple[float, ...]) -> np.ndarray:
    """Values below which the given percentages of the weight lie, one for each; ``values`` and ``weights`` (n,)."""
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    return np.interp(np.asarray(percentiles) / 100, share, values[order])


def robust_limits(values: np.ndarray, weights: np.ndarray) -> tuple[float, float]:
    """The 1st and the 99th percentile of the weight (n,) of values (n,), so that singular edges do not take all the colours.

    Values that differ by round-off only are no pattern: their limits lie apart by the values themselves.
    """
    low, high = weighted_percentiles(values, weights, (1, 99)).tolist()
    if high - low > EVEN * max(abs(low), abs(high)):
        return low, high
    spread = 0.5 * (abs(high) or 1.0)
    return low - spread, high + spread


def extension(values: np.ndarray, limits: tuple[float, float]) -> str:
    """Which ends of a colour bar with these limits are pointed, as matplotlib calls it: those that values (n,) lie beyond."""
    beyond = bool(values.min() < limits[0]), bool(values.max() > limits[1])
    return {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[beyond]
