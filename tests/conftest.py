"""What the tests of several rooms share."""

from __future__ import annotations

import gc
import io
import json
import os
import signal
import subprocess
import sys
import traceback
import warnings
from collections.abc import Callable, Generator, Iterator
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any

import pretence
import pytest
from fork_server import forked_pretended_command, share

from tactsim.registry import forget, registered_outside

TESTS = Path(__file__).parent


def _forget_classes_of_tests() -> None:
    for cls in registered_outside("tactsim"):
        forget(cls)


_forget_classes_of_tests()  # the pretended experiment


gc.disable()  # until all tests are collected: what is loaded stays, and to look through it again and again takes seconds


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    """What is loaded by now is looked through no more."""
    gc.collect()
    gc.freeze()
    gc.enable()


def pytest_configure(config: pytest.Config) -> None:
    """One server of forks for all workers."""
    if getattr(config.option, "numprocesses", None):
        share()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The browser's file first: it waits more than it computes, and as the last one it would leave a core idle."""
    items.sort(key=lambda item: item.path.parent.name != "web")


def pytest_xdist_auto_num_workers() -> int:
    """One worker more than cores, for tests wait for files, sockets and children."""
    return (os.cpu_count() or 1) + 1


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Generator[None, Any, Any]:
    """What a module of tests defines is known to nobody until a test registers it."""
    report = yield
    _forget_classes_of_tests()
    return report


@pytest.fixture(scope="session", autouse=True)
def _without_waiting_for_the_disk() -> Iterator[None]:
    """No file of a test must outlive a power cut; that ``fsync`` is called is seen where it is made to fail."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda descriptor: None)
        yield


@pytest.fixture(autouse=True)
def _unregistered() -> Iterator[None]:
    """What a test defines or registers is forgotten after it."""
    yield
    _forget_classes_of_tests()


@pytest.fixture
def pretended(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pretended experiment is the only one that a case can ask for, and has one figure."""
    from tactsim import plotting, registry
    from tactsim.interfaces import Experiment

    registry.kinds(Experiment)  # what is loaded later would be forgotten with the patch below
    monkeypatch.setitem(registry._registered, Experiment, {"pretence": pretence.Pretence})
    monkeypatch.setattr(registry, "kinds_in_source", lambda *_: {})
    monkeypatch.setattr(plotting, "figures_for", lambda result: {"pretence": lambda: pretence.PNG})


@pytest.fixture
def case_file(tmp_path: Path, pretended: None) -> Path:
    """A valid case file of the pretended experiment."""
    path = tmp_path / "case.yaml"
    path.write_text(pretence.CASE_TEXT, encoding="utf-8")
    return path


def _heeding() -> None:
    """In a child: heeds the signals that a background shell or ``nohup`` lets its processes ignore."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


@pytest.fixture
def start(tmp_path: Path) -> Callable[..., subprocess.Popen[str]]:
    """Starts the command line with the pretended experiment in ``tmp_path``, in a process of its own or a ``forked`` one."""

    def started(*arguments: str, forked: bool = False, **options: object) -> subprocess.Popen[str]:
        own = [sys.executable, str(TESTS / "pretended_cli.py")]
        command = [*(forked_pretended_command() if forked else own), *arguments]
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "preexec_fn": _heeding}
        environment = {**os.environ, "PYTHONPATH": str(TESTS), "PYTHONWARNINGS": "error"}
        return subprocess.Popen(command, text=True, cwd=tmp_path, env=environment, **{**streams, **options})  # type: ignore[call-overload]

    return started


@pytest.fixture
def reader_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Mesh files are read in this process; where the child is what is tried, it is started as ever."""
    from tactsim.outside import mesh_files
    from tactsim.outside.processes import Ended

    def read(module: str, arguments: list[str], **limits: object) -> Ended:
        words, code = io.StringIO(), 1
        with warnings.catch_warnings(), redirect_stderr(words):
            warnings.simplefilter("default")
            try:
                code = mesh_files.main(*arguments)
            except BaseException:  # noqa: BLE001  with which a child would end
                traceback.print_exc()
        return Ended(code, words.getvalue())

    monkeypatch.setattr(mesh_files, "run_child", read)


@pytest.fixture
def hdf5_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """HDF5 is written in this process; where the child is what is tried, it is started as ever."""
    from tactsim.dataset.use import export

    def write(store: Path, split: object, waiting: Path, target: Path) -> None:
        assert not export.main(str(store), str(waiting), json.dumps(split))

    monkeypatch.setattr(export, "_hdf5_apart", write)


@pytest.fixture
def one_thread() -> Iterator[None]:
    """Small bodies in one thread: a barrier per colour costs more than it saves, a time slice each when the machine is busy."""
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(before)
