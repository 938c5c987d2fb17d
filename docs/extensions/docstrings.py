"""Makes the docstrings of tactsim ready for autodoc: short entries of sections, types without pydantic's machinery, short names."""

from __future__ import annotations

import re
import typing
from typing import Any

from docutils import nodes
from pydantic import BaseModel
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.ext.autodoc import _generate
from sphinx.ext.autodoc._dynamic import _loader, _type_annotations
from sphinx.util import inspect

SECTIONS = ("Parameters", "Attributes", "Returns")
ENTRY = re.compile(r"^(?P<names>[\w, *]+?) : (?P<text>.+)$")


def setup(app: Sphinx) -> dict[str, Any]:
    """Connects what this module does to Sphinx."""
    for module in (_generate, _loader, _type_annotations, inspect):
        _without_metadata(module)
    app.connect("autodoc-process-docstring", _spread_short_entries, priority=100)  # before napoleon reads the sections
    app.connect("autodoc-process-signature", _drop_signature_of_models)
    app.connect("autodoc-skip-member", _skip_machinery)
    app.connect("missing-reference", _unique_name)
    return {"parallel_read_safe": True}


def _without_metadata(module: Any) -> None:
    """Lets a module of autodoc write ``Annotated[float, ...]`` as ``float``."""
    original = module.stringify_annotation

    def plain(annotation: Any, *arguments: Any, **options: Any) -> str:
        return str(original(typing._strip_annotations(annotation), *arguments, **options))  # type: ignore[attr-defined]

    module.stringify_annotation = plain


def _spread_short_entries(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Turns ``radius : of the ball in m`` into an entry with a description where nothing indented follows."""
    section, spread = "", []
    for number, line in enumerate(lines):
        follows = lines[number + 1] if number + 1 < len(lines) else ""
        if follows.startswith("---") and set(follows) == {"-"}:
            section = line.strip()
        entry = ENTRY.match(line) if section in SECTIONS else None
        is_type = follows.startswith("    ") and (lines[number].rstrip().endswith(TYPE_WORDS) or "array" in line)
        if entry is None or is_type:
            spread.append(line)
        else:
            spread += [entry["names"], f"    {entry['text']}"]
    lines[:] = spread


TYPE_WORDS = ("float", "str", "int", "bool", "array", "array_like", "Harmonic", "GeneralizedKelvin", "Segment", "(float, float)")
"""How an entry ends that names a type, with the description below it."""


def _drop_signature_of_models(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str | None, returns: str | None
) -> tuple[str | None, str | None] | None:
    """The fields of a model stand below it; its signature would list them again with pydantic's types."""
    return ("", None) if isinstance(obj, type) and issubclass(obj, BaseModel) else None


def _skip_machinery(app: Sphinx, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """What pydantic adds to a class is not a part of the interface."""
    return True if name.startswith("model_") else None


def _unique_name(app: Sphinx, env: BuildEnvironment, node: addnodes.pending_xref, content: nodes.Element) -> nodes.Node | None:
    """Resolves a short name, such as that of an error in a ``Raises`` section, if one object of the package has it."""
    if node.get("refdomain") != "py":
        return None
    domain = env.get_domain("py")
    short = node["reftarget"].rpartition(".")[2]
    found = [full for full in domain.objects if full.rpartition(".")[2] == short and full.startswith("tactsim.")]  # type: ignore[attr-defined]
    if len(found) != 1:
        return None
    return domain.resolve_xref(env, node["refdoc"], app.builder, "obj", found[0], node, content)
