"""Every code block of the README is executed as it stands; the two set-up commands are what CI itself calls."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from text_blocks import UNTOLD, blocks_of, execute, file_names, provide_command

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
BLOCKS = blocks_of(README)
NAMES = file_names(README, BLOCKS)
LONG = {1}
"""The run of a shipped case on its own mesh; `docs/start/index.md` runs it on a coarse one."""
INSTALLED = {[language for language, _ in BLOCKS].index(language, 1) for language in ("sh", "python")}
"""Blocks that start the installed command or Python themselves; the others fork it from a process that has loaded tactsim."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A clone's folder as the commands of the README see it."""
    place = tmp_path_factory.mktemp("readme")
    shutil.copytree(ROOT / "cases", place / "cases")
    return place


def test_setup_commands_are_those_of_ci():
    commands = [line.split("#")[0].strip() for line in BLOCKS[0][1].splitlines()]
    assert commands == ["scripts/run", "scripts/test"]
    called = (ROOT / ".ci" / "run").read_text().splitlines()
    assert called[-2:] == commands


def test_the_installed_command_starts(tmp_path):
    provide_command(tmp_path, installed=True)
    done = subprocess.run([tmp_path / ".venv" / "bin" / "tactsim", "--help"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: tactsim")


def test_no_block_is_left_out():
    assert len(BLOCKS) >= 4
    assert {language for language, _ in BLOCKS} == {"sh", "python"}
    assert UNTOLD not in NAMES


@pytest.mark.parametrize(
    "number", [pytest.param(number, marks=pytest.mark.slow) if number in LONG else number for number in range(1, len(BLOCKS))]
)
def test_block(number, folder):
    language, text = BLOCKS[number]
    if language == "yaml":
        (folder / NAMES[number]).write_text(text)
        return
    provide_command(folder, installed=number in INSTALLED)
    execute(language, text, folder, installed=number in INSTALLED)
