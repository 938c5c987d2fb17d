"""The examples of the gallery run as they stand, from stored results where a run takes long."""

from __future__ import annotations

import ast
import runpy
from pathlib import Path

import matplotlib
import pytest

import tactsim as ts

GALLERY = Path(__file__).parents[1] / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("plot_*.py"))
QUICK = {"annulus_design", "calibration", "film_creep", "film_test", "tactile_bands", "thermogravimetry"}
"""Those that take less than two seconds each, once the libraries are loaded."""
ANYWHERE = {"story_lump_detector", "story_threshold_sensor"}
"""Stories, which go through several experiments."""


def name_of(path: Path) -> str:
    return path.stem.removeprefix("plot_")


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=() if name_of(path) in QUICK else pytest.mark.slow, id=name_of(path)) for path in SCRIPTS],
)
def test_an_example_runs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib.pyplot as plt

    matplotlib.use("agg")
    monkeypatch.chdir(GALLERY)
    before = sorted(Path("stored").rglob("*"))
    runpy.run_path(str(path))
    plt.close("all")
    assert sorted(Path("stored").rglob("*")) == before, "an example of the gallery computed what should be stored"


def test_there_is_one_example_of_each_kind_of_experiment() -> None:
    assert {name_of(path) for path in SCRIPTS} - ANYWHERE == set(ts.kinds("experiment"))


def test_the_order_lists_every_example() -> None:
    source = ast.parse((GALLERY.parent / "extensions" / "gallery_pages.py").read_text())
    order = next(node.value for node in source.body if isinstance(node, ast.Assign) and node.targets[0].id == "ORDER")
    assert sorted(ast.literal_eval(order)) == [name_of(path) for path in SCRIPTS]


@pytest.mark.usefixtures("reader_here")
@pytest.mark.parametrize(
    "folder", sorted(path.parent for path in GALLERY.glob("stored/*/result.json")), ids=lambda path: path.name
)
def test_a_stored_result_converged_and_is_small(folder: Path) -> None:
    result = ts.load_result(folder)
    assert result.status == "converged"
    assert not (folder / "figures").exists(), "figures are drawn anew"
    assert sum(file.stat().st_size for file in folder.iterdir()) < 1e6
