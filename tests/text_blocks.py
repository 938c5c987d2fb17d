"""Code blocks of Markdown files, and how the tests that execute them run what they hold."""

from __future__ import annotations

import importlib.util
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from fork_server import forked_command, forked_python

Block = tuple[str, str]
"""Language and text."""
UNTOLD = "block.yaml"
"""Name of a case of which the text does not say where to save it."""


def blocks_of(text: str) -> list[Block]:
    """Every block of a Markdown text, in order."""
    return re.findall(r"^```(\w+)\n(.*?)^```", text, re.M | re.S)


def without_missing(text: str) -> str:
    """The text less its blocks below a comment ``<!-- needs PACKAGE -->`` whose package is not installed."""
    parts = re.split(r"^<!-- needs (\w+) -->\n(```.*?^```)", text, flags=re.M | re.S)
    kept = [parts[0]]
    for package, block, rest in zip(parts[1::3], parts[2::3], parts[3::3], strict=True):
        kept += [block if importlib.util.find_spec(package) else "", rest]
    return "".join(kept)


def file_names(text: str, blocks: list[Block]) -> list[str]:
    """Under which name the text tells to save each YAML block; empty for the others."""
    told = iter(re.findall(r"Save this as\s+`(\w+\.yaml)`", text))
    return [next(told, UNTOLD) if language == "yaml" else "" for language, _ in blocks]


def provide_command(folder: Path, *, installed: bool = False) -> None:
    """The command ``.venv/bin/tactsim`` that the blocks name: the installed one, or one forked from a loaded process."""
    command = folder / ".venv" / "bin" / "tactsim"
    command.parent.mkdir(parents=True, exist_ok=True)
    command.unlink(missing_ok=True)
    if installed:
        command.symlink_to(Path(sys.executable).with_name("tactsim"))
    else:
        command.write_text(f'#!/bin/sh\nexec {shlex.join(forked_command())} "$@"\n')
        command.chmod(0o755)


def execute(language: str, text: str, folder: Path, *, installed: bool = False) -> None:
    """Runs a block of ``sh`` or ``python`` in a folder; fails with what it wrote if it does not end well.

    Python is ``installed``, a process of its own, or forked from one that has loaded tactsim.
    """
    python = [sys.executable, "-c"] if installed else forked_python()
    command = ["sh", "-e", "-c", text] if language == "sh" else [*python, text]
    environment = {**os.environ, "HOME": str(folder), "PATH": f"{folder / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, env=environment)
    assert done.returncode == 0, done.stderr + done.stdout
