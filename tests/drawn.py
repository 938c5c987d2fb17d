"""What a drawn figure says, and what it covers."""

from __future__ import annotations

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
