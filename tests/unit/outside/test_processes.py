"""Child processes: bounded in time and memory, ended with their parent."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tactsim.errors import InputError
from tactsim.outside import processes
from tactsim.outside.environment import check_environment
from tactsim.outside.processes import Worker, ending, run_child


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> object:
    """Makes a module that children can run, in a package root of its own."""
    monkeypatch.setattr(processes, "ROOT", tmp_path)

    numbers = itertools.count()

    def made(text: str) -> str:
        name = f"child_of_a_test_{next(numbers)}"
        (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
        return name

    return made


def test_a_child_that_ends_reports_how(module) -> None:
    done = run_child(module("import sys\nprint('a\\x1b[31m', sys.argv[1:])\nsys.exit(3)"), ["b"], time_limit=30)
    assert (done.code, done.ending, done.out_of_time) == (3, "exit code 3", False)
    assert done.last_line == "a\\x1b[31m ['b']"


def test_a_child_that_never_ends_is_stopped(module) -> None:
    begin = time.monotonic()
    assert run_child(module("while True: pass"), [], time_limit=1.0).out_of_time
    assert time.monotonic() - begin < 10


def test_a_child_that_takes_too_much_memory_is_refused_it(module) -> None:
    done = run_child(module("x = bytearray(10**9)"), [], time_limit=30, memory=300_000_000)
    assert done.out_of_memory
    assert done.code == 1
    assert run_child(module("x = bytearray(10**8)"), [], time_limit=30, memory=300_000_000).code == 0


def test_a_child_that_talks_without_end_fills_no_memory(module) -> None:
    done = run_child(module("for k in range(300000): print('x' * 99)\nprint('end')"), [], time_limit=60)
    assert len(done.error_output) <= processes.LAST_WORDS
    assert done.last_line == "end"


def test_a_child_ends_with_its_parent(tmp_path: Path) -> None:
    parent = (
        "import pathlib, tactsim.outside.processes as p\n"
        f"p.ROOT = pathlib.Path({str(tmp_path)!r})\n"
        "p.run_child('sleeper', [], time_limit=60)\n"
    )
    mark = tmp_path / "pid"
    sleeper = f"import os, time\nopen({str(mark)!r}, 'w').write(str(os.getpid()))\ntime.sleep(60)\n"
    (tmp_path / "sleeper.py").write_text(sleeper, encoding="utf-8")
    started = subprocess.Popen([sys.executable, "-c", parent])
    for _ in range(300):
        if mark.exists() and mark.read_text():
            break
        time.sleep(0.05)
    child = int(mark.read_text())
    started.kill()
    started.wait()
    for _ in range(100):
        if not Path(f"/proc/{child}").exists() or "State:\tZ" in Path(f"/proc/{child}/status").read_text():
            return
        time.sleep(0.05)
    os.kill(child, 9)
    pytest.fail("the child outlived its parent")


def test_a_worker_answers_and_its_end_is_reported(module) -> None:
    worker = Worker(
        module(
            "import sys\nfrom multiprocessing.connection import Connection\nc = Connection(int(sys.argv[1]))\n"
            "c.send_bytes(c.recv_bytes()[::-1])\nsys.exit(7)"
        )
    )
    worker.connection.send_bytes(b"abc")
    assert worker.connection.recv_bytes() == b"cba"
    assert worker.ended() == "exit code 7"


def test_endings_are_words() -> None:
    assert ending(-9) == "SIGKILL, perhaps out of memory"
    assert ending(-11) == "SIGSEGV"
    assert ending(-1000) == "exit code -1000"


@pytest.mark.parametrize("value", ["0", "-1", "two", "1e3", "99999", "0,2"])
def test_numbers_of_threads_that_crash_libraries_are_refused(value: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"OMP_NUM_THREADS is '.*'; allowed: 1 to 4096, or unset"):
        check_environment({"OMP_NUM_THREADS": value}, tmp_path)
    check_environment({"OMP_NUM_THREADS": "2", "MKL_NUM_THREADS": "", "NUMBA_NUM_THREADS": "1"}, tmp_path)
    check_environment({"OMP_NUM_THREADS": "4,2"}, tmp_path)


def test_a_folder_that_would_steer_the_compiler_is_refused(tmp_path: Path) -> None:
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: evil")
    with pytest.raises(InputError, match=r"the working folder holds \.numba_config\.yaml"):
        check_environment({}, tmp_path)
