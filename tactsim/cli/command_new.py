"""``tactsim new``: a commented case file to begin with."""

from __future__ import annotations

import argparse
from pathlib import Path

from tactsim.cli import console
from tactsim.errors import StorageError
from tactsim.outside.text import one_line

NAME = "new"
SUMMARY = "write a commented case file of a kind, which runs as it is"
DESCRIPTION = """\
Writes a case of a kind of experiment: what it needs with values of an example, and every other
key as a comment with its default and its meaning. It runs as it is. A file that exists is left
alone unless --force is given; - as the file prints the case.
"""
EXAMPLES = """\
examples:
  tactsim new grasp
  tactsim new indentation my_sensor.yaml
  tactsim list kinds
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("kind", metavar="KIND", help="kind of the experiment; tactsim list kinds names them")
    parser.add_argument("file", metavar="FILE", type=Path, nargs="?", help="case file (default: KIND.yaml)")
    parser.add_argument("--force", action="store_true", help="replace a file that exists")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    StorageError
        If the file exists or cannot be written.
    """
    from tactsim.case.template import template
    from tactsim.storage.files import replace_file

    text = template(arguments.kind)
    place = arguments.file or Path(f"{arguments.kind}.yaml")
    if str(place) == "-":
        console.out(text.rstrip("\n"))
        return 0
    if place.exists() and not arguments.force:
        raise StorageError(f"{one_line(place)} exists; choose another FILE, or replace it with --force")
    replace_file(place, text.encode())
    console.out(f"case {one_line(place)}; run it with: {console.command('run', place)}")
    return 0
