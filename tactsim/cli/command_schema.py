"""``tactsim schema``: the JSON Schema of case files and of sweep files."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from tactsim.cli import console
from tactsim.errors import StorageError

NAME = "schema"
SUMMARY = "print the JSON Schema of case or sweep files, for editors"
DESCRIPTION = """\
Prints the JSON Schema of case files, or with --sweep that of sweep files. An editor with a YAML
language server completes and checks a file whose first line names its schema:

  # yaml-language-server: $schema=case.schema.json
  # yaml-language-server: $schema=sweep.schema.json
"""
EXAMPLES = """\
examples:
  tactsim schema --out case.schema.json
  tactsim schema --sweep --out sweep.schema.json
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("--sweep", action="store_true", help="of sweep files, in which values vary, instead")
    parser.add_argument("--out", metavar="FILE", type=Path, help="write to a file instead")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    StorageError
        If another file than a JSON Schema stands in the place, or it cannot be written.
    """
    import json

    from tactsim.storage.files import replace_file

    text = json.dumps(_schema(arguments.sweep), indent=2)
    if arguments.out is None:
        console.out(text)
    else:
        _refuse_other(arguments.out)
        replace_file(arguments.out, f"{text}\n".encode())
    return 0


def _refuse_other(path: Path) -> None:
    """Refuses a file in the place of a schema that is none, such as a case.

    Raises
    ------
    StorageError
        If the file is no JSON Schema.
    """
    from tactsim.outside.files import opened
    from tactsim.outside.json_text import read_json
    from tactsim.outside.text import one_line

    if not path.is_file() or not (text := opened(path, "description").read()):
        return
    try:
        content = read_json(text.decode(), path.name)
    except (StorageError, ValueError):
        content = None
    if not isinstance(content, dict) or "properties" not in content:
        raise StorageError(f"{one_line(path)} exists and is no JSON Schema; choose another FILE")


def _schema(sweep: bool) -> dict[str, Any]:
    if sweep:
        from tactsim.dataset.sampling.json_schema import sweep_json_schema

        return sweep_json_schema()
    from tactsim.case import case_json_schema

    return case_json_schema()
