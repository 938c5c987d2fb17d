"""``tactsim schema``: the JSON Schema of case files."""

from __future__ import annotations

import argparse
from pathlib import Path

from tactsim.cli import console

NAME = "schema"
SUMMARY = "print the JSON Schema of case files, for editors"
DESCRIPTION = """\
Prints the JSON Schema of case files. An editor with a YAML language server completes and checks
a case file whose first line names the schema:

  # yaml-language-server: $schema=case.schema.json
"""
EXAMPLES = """\
example:
  tactsim schema --out case.schema.json
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("--out", metavar="FILE", type=Path, help="write to a file instead")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command."""
    import json

    from tactsim.case import case_json_schema
    from tactsim.results.storage import replace_file

    text = json.dumps(case_json_schema(), indent=2)
    if arguments.out is None:
        console.out(text)
    else:
        replace_file(arguments.out, f"{text}\n".encode())
    return 0
