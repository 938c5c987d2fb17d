"""``tactsim completion``: completion of commands and options for a shell."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from tactsim.cli import console

NAME = "completion"
SUMMARY = "print the completion of commands and options for bash, zsh or fish"
DESCRIPTION = """\
Prints a script that teaches a shell to complete the commands and options of tactsim.

  bash   tactsim completion bash > ~/.local/share/bash-completion/completions/tactsim
  zsh    tactsim completion zsh > ~/.zfunc/_tactsim     (a folder of $fpath)
  fish   tactsim completion fish > ~/.config/fish/completions/tactsim.fish
"""
EXAMPLES = """\
examples:
  eval "$(tactsim completion bash)"
"""
SHELLS = ("bash", "zsh", "fish")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("shell", metavar="SHELL", choices=SHELLS, help="bash, zsh or fish")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command."""
    import shtab

    make: Callable[[], argparse.ArgumentParser] = arguments.parser
    console.out(shtab.complete(make(), shell=arguments.shell))
    return 0
