"""``tactsim completion``: completion of commands, options, shipped names and files for a shell."""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tactsim.cli import console

NAME = "completion"
SUMMARY = "print the completion of commands, options and names for bash, zsh or fish"
DESCRIPTION = """\
Prints a script that teaches a shell to complete the commands and options of tactsim, the names of shipped cases,
materials and tables, the kinds of a new case, and files.

  bash   tactsim completion bash > ~/.local/share/bash-completion/completions/tactsim
  zsh    tactsim completion zsh > ~/.zfunc/_tactsim     (a folder of $fpath)
  fish   tactsim completion fish > ~/.config/fish/completions/tactsim.fish
"""
EXAMPLES = """\
examples:
  eval "$(tactsim completion bash)"
"""
SHELLS = ("bash", "zsh", "fish")
FILES = {
    "run": ("*.yaml", "schema: tactsim/case/"),
    "show": ("*.yaml", "schema: tactsim/case/"),
    "sweep": ("*.yaml", "schema: tactsim/sweep/"),
    "validate": ("*/*.yaml", "rows:"),
}
"""Command -> which of the shipped files its first argument may name: their places and how a line begins."""
NAMED = (*FILES, "material", "new")
"""Commands whose first argument may be a name of what ships."""
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
    for command, summary, sub in _commands(parser):
        sub.description = summary  # a line; of a longer description the shells show the beginning
        actions = sub._get_positional_actions()
        if command in NAMED:
            actions.pop(0).complete = _completed(command)  # type: ignore[attr-defined]
        for action in (*actions, *sub._get_optional_actions()):
            if action.type is Path or action.metavar in PATHS:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    console.out(shtab.complete(parser, shell=arguments.shell))
    return 0


def _commands(parser: argparse.ArgumentParser) -> Iterator[tuple[str, str, argparse.ArgumentParser]]:
    """Name, summary and parser of every command, and of what a command such as ``data`` does."""
    for action in parser._get_positional_actions():
        if isinstance(action, argparse._SubParsersAction):
            for entry in action._choices_actions:
                sub = action.choices[entry.dest]
                yield entry.dest, entry.help or "", sub
                yield from _commands(sub)


def _names(command: str) -> list[str]:
    """What ships and can be the first argument of a command."""
    from tactsim.shipped import CASES

    if command == "new":  # the shipped schema names the kinds; loading them all would hold up every shell that begins
        schema = json.loads((CASES / "case.schema.json").read_text(encoding="utf-8"))
        return list(schema["properties"]["experiment"]["discriminator"]["mapping"])
    if command == "material":
        from tactsim.materials.library import LIBRARY

        return sorted(LIBRARY)
    places, beginning = FILES[command]
    files = [path for path in sorted(CASES.glob(places)) if re.search(f"^{beginning}", path.read_text("utf-8"), re.MULTILINE)]
    return [*(path.stem for path in files), *sorted({path.parent.name for path in files} - {CASES.name})]


def _completed(command: str) -> dict[str, Any]:
    """What shtab is to complete the first argument of a command with: a function or words for each shell.

    A shipped name or a file, but for the kind of a new case.
    """
    import shtab

    names, function = " ".join(_names(command)), f"_tactsim_{command}_argument"
    bash, zsh, fish = (
        ("", "", "") if command == "new" else ('; compgen -f -- "$1"', " 'files:file:_files'", f" {shtab.FILE['fish']}")
    )
    return {
        "bash": function,
        "zsh": function,
        "fish": names + fish,
        "preamble": {
            "bash": f'{function}() {{ compgen -W "{names}" -- "$1"{bash}; }}',
            "zsh": f"{function}() {{ _alternative 'names:name:({names})'{zsh} }}",
        },
    }
