"""A commented case file of a kind to begin with: what it starts with, and every other key with its default."""

from __future__ import annotations

import textwrap
from typing import Any

from tactsim.case.model import SCHEMA, experiment_class
from tactsim.case.writing import LONGEST_LINE, case_document, yaml_text
from tactsim.field_docstrings import field_descriptions, summary
from tactsim.materials.library import LIBRARY

MATERIALS = " Names of materials: tactsim list materials."
"""Where a value is a shipped material by its name."""

WORDS = {"dma": "DMA", "3d": "in 3D"}
"""What parts of the name of a kind are in a title, where that is not the same."""


def template(kind: str) -> str:
    """The text of a case file that runs as it is.

    Raises
    ------
    UnknownName
        If there is no such kind of experiment, with the nearest one.
    """
    cls = experiment_class(kind)
    example = cls.starting_case()
    given = case_document(example)["experiment"]
    every = case_document(example, complete=True)["experiment"]
    lines = [
        "# yaml-language-server: $schema=case.schema.json",
        "# An editor completes the keys once that schema lies beside this file: tactsim schema --out case.schema.json",
        *_comment(summary(cls), ""),
        f"schema: {SCHEMA}",
        f"title: {_title(kind)}",
        "experiment:",
        f"  kind: {kind}",
    ]
    described = field_descriptions(cls)
    for name in given:
        if name != "kind":
            about = described.get(name, "") + (MATERIALS if _names_material(given[name]) else "")
            lines += ["", *_comment(about, "  "), *_entry(name, given[name])]
    left = [name for name in every if name not in given]
    if left:
        lines += ["", "  # What follows are defaults: take the # before a key away to change one."]
    for name in left:
        lines += ["", *_comment(described.get(name, ""), "  "), *(f"  #{line[2:]}" for line in _entry(name, every[name]))]
    return "\n".join(lines) + "\n"


def _title(kind: str) -> str:
    """A kind in words, such as ``Indentation in 3D``."""
    title = " ".join(WORDS.get(part, part) for part in kind.split("_"))
    return title[0].upper() + title[1:]


def _names_material(value: Any) -> bool:
    """Whether a part of a written case is the name of a shipped material, or holds one."""
    if isinstance(value, dict | list):
        return any(map(_names_material, value.values() if isinstance(value, dict) else value))
    return isinstance(value, str) and value in set(LIBRARY)


def _comment(text: str, indent: str) -> list[str]:
    """Lines of a comment; the marks that a docstring puts around names of keys say nothing in a case file."""
    return textwrap.wrap(text.replace("``", ""), LONGEST_LINE, initial_indent=f"{indent}# ", subsequent_indent=f"{indent}# ")


def _entry(name: str, value: Any) -> list[str]:
    """A key and its value as indented lines of YAML."""
    entry = yaml_text({name: value}).rstrip()
    if entry.startswith("{"):  # a single value: the mapping itself went into one line
        entry = entry[1:-1]
    return [f"  {line}" for line in entry.split("\n")]
