"""``tactsim completion``: completion of commands, options, shipped names and files for a shell."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tactsim.cli import console

NAME = "completion"
SUMMARY = "print the completion of commands, options and names for bash, zsh or fish"
DESCRIPTION = """\
Prints a script that teaches a shell to complete the commands and options of tactsim, the names of shipped cases
and tables, and files.

  bash   tactsim completion bash > ~/.local/share/bash-completion/completions/tactsim
  zsh    tactsim completion zsh > ~/.zfunc/_tactsim     (a folder of $fpath)
  fish   tactsim completion fish > ~/.config/fish/completions/tactsim.fish
"""
EXAMPLES = """\
examples:
  eval "$(tactsim completion bash)"
"""
SHELLS = ("bash", "zsh", "fish")
NAMED = {
    "run": ("*.yaml", "schema: tactsim/case/"),
    "show": ("*.yaml", "schema: tactsim/case/"),
    "sweep": ("*.yaml", "schema: tactsim/sweep/"),
    "validate": ("*/*.yaml", "rows:"),
}
"""Command -> which of the shipped files its first argument may name: their places and how a line begins."""
PATHS = ("FOLDER", "RESULT", "NAME|CASE")
"""What arguments are called that take a path as text."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("shell", metavar="SHELL", choices=SHELLS, help="bash, zsh or fish")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command."""
    import shtab

    make: Callable[[], argparse.ArgumentParser] = arguments.parser
    parser = make()
    for command, sub in _commands(parser):
        actions = sub._get_positional_actions()
        if command in NAMED:
            actions.pop(0).complete = _names_and_files(command)  # type: ignore[attr-defined]
        for action in (*actions, *sub._get_optional_actions()):
            if action.type is Path or action.metavar in PATHS:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    console.out(shtab.complete(parser, shell=arguments.shell))
    return 0


def _commands(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """Name and parser of every command, and of what a command such as ``data`` does."""
    for action in parser._get_positional_actions():
        if isinstance(action, argparse._SubParsersAction):
            for name, sub in action.choices.items():
                yield name, sub
                yield from _commands(sub)


def _names_and_files(command: str) -> dict[str, Any]:
    """What shtab is to complete an argument with that is a shipped name or a file: a function or words for each shell."""
    import shtab

    from tactsim.shipped import CASES

    places, beginning = NAMED[command]
    texts = ((path.stem, path.read_text(encoding="utf-8")) for path in sorted(CASES.glob(places)))
    names = " ".join(name for name, text in texts if re.search(f"^{beginning}", text, re.MULTILINE))
    function = f"_tactsim_{command}_names_and_files"
    return {
        "bash": function,
        "zsh": function,
        "fish": f"{names} {shtab.FILE['fish']}",
        "preamble": {
            "bash": f'{function}() {{ compgen -W "{names}" -- "$1"; compgen -f -- "$1"; }}',
            "zsh": f"{function}() {{ _alternative 'names:name:({names})' 'files:file:_files' }}",
        },
    }
