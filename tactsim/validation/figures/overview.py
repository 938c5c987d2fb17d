"""One figure of all rows: what is computed over what is expected."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tactsim.plotting.canvas import despined, encoded, new_figure, styled
from tactsim.validation.comparison import RowOutcome
from tactsim.validation.figures.forms import label_decades, write_title

WIDTH_OF_CHAPTER = 0.8
"""Width over which the points of a chapter lie, over the distance between two chapters."""


def overview(rows: Sequence[RowOutcome], chapters: Sequence[str], colours: Mapping[str, str]) -> bytes:
    """PNG with every row as a point: computed over expected by chapter, coloured by class; below, rows without such a ratio.

    ``chapters`` holds the chapter of each row.
    """
    with styled():
        return encoded(overview_figure(rows, chapters, colours))


def overview_figure(rows: Sequence[RowOutcome], chapters: Sequence[str], colours: Mapping[str, str]) -> Figure:
    """The figure of `overview`."""
    names, places = _in_order(chapters), _places(chapters)
    figure = new_figure(9.5, 5.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3.2, 1.0))
    labels = [label for label in colours if any(row.label == label for row in rows)]
    for height, label in enumerate(labels):
        for axis, with_ratio in ((upper, True), (lower, False)):
            chosen = [k for k, row in enumerate(rows) if row.label == label and _has_ratio(row) == with_ratio]
            x = [places[k] for k in chosen]
            y = [rows[k].ratio if with_ratio else len(labels) - height for k in chosen]
            axis.plot(x, y, "o", markersize=4.5, markeredgewidth=0.4, markeredgecolor="white", color=colours[label])
    upper.set_yscale("log")
    upper.axhline(1.0, color="0.7", linewidth=0.8, zorder=0)
    label_decades(upper)
    upper.set_ylabel("computed over expected")
    lower.set_ylabel("no ratio")
    lower.set_yticks([])
    lower.set_xticks(range(len(names)), [f"chapter {name}" if name.isdigit() else name for name in names])
    counts = {label: sum(row.label == label for row in rows) for label in labels}
    handles = [
        Line2D([], [], marker="o", linestyle="", color=colours[label], label=f"{label} ({counts[label]})") for label in labels
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=8, frameon=False)
    for axis in (upper, lower):
        despined(axis)
    write_title(figure, f"{len(rows)} rows: what is computed over what is expected")
    return figure


def _has_ratio(row: RowOutcome) -> bool:
    return row.ratio is not None and row.ratio > 0


def _in_order(chapters: Sequence[str]) -> list[str]:
    """Every chapter once, as they stand in the book, and after them what is no chapter."""
    return sorted(set(chapters), key=lambda name: (not name.isdigit(), int(name) if name.isdigit() else 0, name))


def _places(chapters: Sequence[str]) -> list[float]:
    """Place of each point along the axis: chapter by chapter, the rows of a chapter side by side in their order."""
    counts, seen = Counter(chapters), Counter[str]()
    names, places = _in_order(chapters), []
    for chapter in chapters:
        places.append(names.index(chapter) + WIDTH_OF_CHAPTER * ((seen[chapter] + 0.5) / counts[chapter] - 0.5))
        seen[chapter] += 1
    return places
