"""``tactsim show --web``."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from fork_server import forked_command
from live_pages import grasp_folder, made_up_store

from tactsim.cli import main
from tactsim.interfaces.readings import ROUNDING_NOISE
from tactsim.live.sources.noise import MESH_SHARE
from tactsim.units import format_quantity


@contextmanager
def page(*arguments: str, forked: bool = True) -> Iterator[subprocess.Popen[str]]:
    """The command in a process that is forked from a loaded one, or starts by itself."""
    begin = forked_command("-W", "error") if forked else [sys.executable, "-W", "error", "-m", "tactsim.cli"]
    command = [*begin, "show", *arguments, "--web", "--no-browser"]
    with subprocess.Popen(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.mark.parametrize(("number", "forked"), [(signal.SIGINT, False), (signal.SIGTERM, True)])
def test_the_address_is_reported_once_and_a_signal_ends_it_in_good_order(
    tmp_path: Path, number: signal.Signals, forked: bool
) -> None:
    with page(str(grasp_folder(tmp_path / "a")), forked=forked) as process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{32}/", address)
        with urllib.request.urlopen(address, timeout=10) as answer:
            assert b"<title>tactsim</title>" in answer.read()
        with pytest.raises(urllib.error.HTTPError, match="403") as refused:
            urllib.request.urlopen(address[:-10], timeout=10)
        refused.value.close()
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
        assert (process.returncode, err) == (0, "")
        assert address not in out


def test_the_help_gives_the_noise_that_is_taken_without_the_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "--help"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert f"{MESH_SHARE:.1%}".replace("%", " %") + " of the largest force" in words
    assert f"{format_quantity(ROUNDING_NOISE, 'N')} for any others" in words


def test_another_address_is_warned_of(tmp_path: Path) -> None:
    with page(str(grasp_folder(tmp_path / "a")), "--host", "0.0.0.0") as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("http://127.0.0.1:")
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20)
        assert err.startswith("warning: the page is served on 0.0.0.0")
        assert process.returncode == 0


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--web"], 2, "nothing to show"),
        ([], 2, "RESULT_STORE_OR_CASE is missing"),
        (["{grasp}", "--port", "8000"], 2, "--port: for the live page only; add --web"),
        (["{grasp}", "--live", "-"], 2, "--live: for the live page only"),
        (["{grasp}", "--web", "--save", "a.png"], 2, "one at a time"),
        (["{grasp}", "--web", "--noise", "0 N"], 2, "--noise 0 N: allowed: more than 0 N"),
        (["{grasp}", "--web", "--noise", "2"], 2, "--noise: '2' has no unit"),
        (["{grasp}", "--noise", "2 mN"], 2, "--noise: for the live page only; add --web"),
        (["{grasp}", "--web", "--port", "70000"], 2, "--port 70000: not a port"),
        (["{grasp}", "--web", "--port", "{taken}"], 5, "cannot serve on 127.0.0.1"),
        (["{grasp}", "--web", "--reference", "{none}"], 5, "is not a folder with a result"),
        (["{none}", "--web"], 5, "is not a folder with a result"),
        (["{empty}", "--web"], 2, "none of its 6 samples is done"),
        (["--web", "--live", "{none}"], 5, "cannot read"),
        (["--web", "--live", "tcp://10.0.0.1:5000"], 2, "listens on this machine only"),
        (["--web", "--live", "tcp://127.0.0.1:{taken}"], 5, "cannot listen"),
    ],
)
def test_what_cannot_be_shown_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, words: str
) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        known = {"grasp": grasp_folder(tmp_path / "a"), "none": tmp_path / "none", "taken": taken.getsockname()[1]}
        if "{empty}" in arguments:
            known["empty"] = made_up_store(tmp_path, done=0)
        assert main(["show", *(one.format(**known) for one in arguments)]) == code
    assert words in capsys.readouterr().err
