"""A figure that waits for a rendering, drawn after others."""

from __future__ import annotations

from matplotlib.figure import Figure

from tactsim.cli.figures.result_figures import drawn_figures
from tactsim.plotting.canvas import Plot, new_figure
from tactsim.plotting.rendered_plot import RenderedPlot


class Course:
    """What is begun and drawn, in its order."""

    def __init__(self, failures: int = 0):
        self.order: list[str] = []
        self.failures = failures
        self.drawings = {"maps.png": Plot(lambda: self._figure("maps")), "view.png": RenderedPlot(self._begun, self._figure)}

    def _begun(self) -> str:
        self.order.append("begun")
        if self.order.count("begun") <= self.failures:
            raise OSError("no more processes")
        return "view"

    def _figure(self, name: str) -> Figure:
        self.order.append(name)
        return new_figure(1.0, 1.0)


def test_a_rendering_begins_before_the_other_figures() -> None:
    course = Course()
    drawn, warnings = drawn_figures(lambda: course.drawings)
    assert (list(drawn), warnings) == (["maps.png", "view.png"], [])
    assert course.order == ["begun", "maps", "view"]


def test_one_that_was_not_begun_is_when_it_is_drawn_and_so_it_is_again() -> None:
    course = Course()
    view = course.drawings["view.png"]
    assert all(view().startswith(b"\x89PNG") for _ in range(2))
    assert course.order == ["begun", "view"] * 2


def test_what_fails_as_it_begins_is_tried_again_and_costs_no_other_figure() -> None:
    once, always = Course(failures=1), Course(failures=2)
    assert list(drawn_figures(lambda: once.drawings)[0]) == ["maps.png", "view.png"]
    drawn, (warning,) = drawn_figures(lambda: always.drawings)
    assert list(drawn) == ["maps.png"]
    assert "no more processes" in warning
