"""Every code block of the README is executed as it stands; the two set-up commands are what CI itself calls."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from fork_server import forked_command

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", README, re.M | re.S)
FILES = iter(re.findall(r"Save this as\s+`(\w+\.yaml)`", README))
NAMES = [next(FILES) if language == "yaml" else "" for language, _ in BLOCKS]
"""Under which name the text says to save each case."""
FIRST = 1
"""The block that starts the installed command itself; the others fork it from a process that has loaded it."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A clone's folder as the commands of the README see it."""
    place = tmp_path_factory.mktemp("readme")
    shutil.copytree(ROOT / "cases", place / "cases")
    (place / ".venv" / "bin").mkdir(parents=True)
    return place


def provide_command(folder, number):
    """The command that the blocks name."""
    command = folder / ".venv" / "bin" / "tactsim"
    command.unlink(missing_ok=True)
    if number == FIRST:
        command.symlink_to(Path(sys.executable).with_name("tactsim"))
    else:
        command.write_text(f'#!/bin/sh\nexec {shlex.join(forked_command())} "$@"\n')
        command.chmod(0o755)


def test_setup_commands_are_those_of_ci():
    commands = [line.split("#")[0].strip() for line in BLOCKS[0][1].splitlines()]
    assert commands == ["scripts/run", "scripts/test"]
    called = (ROOT / ".ci" / "run").read_text().splitlines()
    assert called[-2:] == commands


def test_no_block_is_left_out():
    assert len(BLOCKS) >= 6
    assert {language for language, _ in BLOCKS} == {"sh", "yaml", "python"}


@pytest.mark.parametrize("number", range(1, len(BLOCKS)))
def test_block(number, folder):
    language, text = BLOCKS[number]
    if language == "yaml":
        (folder / NAMES[number]).write_text(text)
        return
    provide_command(folder, number)
    command = ["sh", "-e", "-c", text] if language == "sh" else [sys.executable, "-c", text]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=600, env={**os.environ, "HOME": str(folder)}
    )
    assert done.returncode == 0, done.stderr + done.stdout
