"""Every name of ``tactsim.__all__`` has an example in its docstring, which gives what it says."""

from __future__ import annotations

import doctest
import inspect
from pathlib import Path

import pytest
from sweeps import Inline

import tactsim as ts
from tactsim.dataset.running.executors import LocalWorkers

STORE = "annuli.zarr"
"""What the example of `sweep` makes and that of `load_data` reads."""


def example(name: str) -> doctest.DocTest:
    """The example in the docstring of a public name, empty without one; classes are defined in no module of the package."""
    text = inspect.getdoc(getattr(ts, name)) or ""
    return doctest.DocTestParser().get_doctest(text, {"__name__": "example"}, name, None, None)


def run(name: str) -> None:
    """Run an example in the working folder; the test fails with what differs."""
    report: list[str] = []
    doctest.DocTestRunner(verbose=False).run(example(name), out=report.append)
    if report:
        pytest.fail("".join(report), pytrace=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where all of them run."""
    return tmp_path_factory.mktemp("examples")


@pytest.mark.parametrize("name", ts.__all__)
def test_the_example_of_a_name_gives_what_it_says(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(LocalWorkers, "of", lambda sweep, workers: Inline(sweep))  # test_public_surface starts a real worker
    lines = example(name).examples
    assert any("ts." in line.source for line in lines), f"ts.{name} has no example"
    assert lines[-1].want, "an example ends with what it gives"
    if name in ("sweep", "load_data") and not Path(STORE).exists():
        run("sweep")
    if name != "sweep":
        run(name)


def test_an_example_that_gives_something_else_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ts.Sphere, "__doc__", ">>> 1 + 1\n3\n")
    with pytest.raises(pytest.fail.Exception, match="Expected:\n    3\nGot:\n    2"):
        run("Sphere")
