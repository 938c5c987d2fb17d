"""What a drawn figure says, and what it covers."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox


def text_of(figure: Figure) -> str:
    """All that is written in a figure."""
    return " ".join(text.get_text() for text in figure.findobj(Text))


def covered_lines(figure: Figure) -> list[str]:
    """Labels of the lines of a figure's panels that run through a legend."""
    figure.draw_without_rendering()
    legends = [*figure.legends, *(legend for axis in figure.axes if (legend := axis.get_legend()))]
    covered = []
    for legend in legends:
        for axis in figure.axes:
            box = Bbox.intersection(legend.get_window_extent(), axis.bbox)
            for line in axis.lines if box is not None else ():
                path = line.get_transform().transform_path(line.get_path())
                if path.intersects_bbox(box, filled=False):
                    covered.append(str(line.get_label()))
    return covered


COMMON = 3.0
"""Pixels in both directions that the boxes of words may have in common: letters do not fill them."""


def colliding_words(figure: Figure) -> list[str]:
    """Pairs of words in a figure that stand on each other, and words that reach beyond its border."""
    figure.draw_without_rendering()
    boxes = [(text.get_text(), text.get_window_extent()) for text in _drawn_words(figure)]
    width, height = figure.bbox.width + COMMON, figure.bbox.height + COMMON
    found = [words for words, box in boxes if min(box.x0, box.y0) < -COMMON or box.x1 > width or box.y1 > height]
    for (words, box), (others, other) in itertools.combinations(boxes, 2):
        common = Bbox.intersection(box, other)
        if common is not None and min(common.width, common.height) > COMMON:
            found.append(f"{words} | {others}")
    return found


def _drawn_words(artist: Artist) -> Iterator[Text]:
    """The words that an artist draws: of an axis only the labels of ticks that are in sight, and nothing of one that is off."""
    if not artist.get_visible():
        return
    if isinstance(artist, Text):
        if artist.get_text().strip():
            yield artist
        return
    hidden: set[Artist] = set()
    if isinstance(artist, Axes) and not artist.axison:
        hidden = {artist.xaxis, artist.yaxis}
    if isinstance(artist, Axis):
        low, high = sorted(artist.get_view_interval())
        ticks = [*artist.get_major_ticks(), *artist.get_minor_ticks()]
        hidden = {tick for tick in ticks if not low <= tick.get_loc() <= high}
    for child in artist.get_children():
        if child not in hidden:
            yield from _drawn_words(child)
