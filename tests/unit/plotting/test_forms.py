"""Pictures as PNG and in vector form."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from tactsim.plotting.canvas import Plot, entitle, new_figure, styled


def drawn() -> Figure:
    """Words beside an image of noise, which no file can make small."""
    with styled():
        figure = new_figure(6.0, 4.0)
        axis = figure.add_subplot()
        axis.pcolormesh(np.random.default_rng(1).random((200, 200)), rasterized=True)
        entitle(figure, "The first line", "the second line")
    return figure


@pytest.mark.parametrize(("form", "beginning"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_every_form_is_the_same_each_time_and_small(form: str, beginning: bytes) -> None:
    content = Plot(drawn)(form)
    assert content.startswith(beginning)
    assert content == Plot(drawn)(form)
    assert len(content) < 1_000_000


def test_letters_stay_letters_and_what_is_dense_is_a_picture() -> None:
    content = Plot(drawn)("svg").decode()
    assert ">The first line<" in content
    assert ">the second line<" in content
    assert content.count("<image") == 1
    assert b"/FontFile2" in Plot(drawn)("pdf"), "TrueType, embedded"


def test_a_figure_has_the_size_that_was_asked_for() -> None:
    size = np.frombuffer(Plot(drawn)("png")[16:24], ">u4")
    np.testing.assert_array_equal(size, [960, 640])


def test_a_title_in_several_lines_of_a_user_stays_one_line() -> None:
    figure = drawn()
    entitle(figure, "a\nb")
    assert "\n" not in figure.get_suptitle()
