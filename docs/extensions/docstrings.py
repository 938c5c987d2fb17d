"""Makes the docstrings ready for autodoc: short entries of sections, types without the machinery of pydantic, short names."""

from __future__ import annotations

import builtins
import re
import typing
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

from docutils import nodes
from pydantic import BaseModel
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.ext.autodoc import _generate
from sphinx.ext.autodoc._dynamic import _loader, _type_annotations
from sphinx.ext.napoleon.docstring import NumpyDocstring
from sphinx.transforms import SphinxTransform
from sphinx.util import inspect

from tactsim.field_docstrings import docstrings_alone

SECTIONS = ("Parameters", "Attributes", "Returns")
ENTRY = re.compile(r"^(?P<names>[\w, *]+?) : (?P<text>.+)$")
NAMES = re.compile(r"^[\w.*]+(, [\w.*]+)*$")
TYPES = {
    "float",
    "str",
    "int",
    "bool",
    "array",
    "array_like",
    "(float, float)",
    "GeneralizedKelvin",
    "sequence of Segment",
    "tuple of Harmonic",
}
TYPES |= {"TaxelLayout", "(n,) array", "(n, ...) array", "array of any shape", "array_like of float"}
"""What stands behind the colon of an entry that has its description below it."""


def setup(app: Sphinx) -> dict[str, Any]:
    """Connects what this module does to Sphinx."""
    whole_build = ExitStack()
    whole_build.enter_context(docstrings_alone())  # the fields of a model stand below it as attributes
    app.connect("build-finished", lambda app, error: whole_build.close())
    for module in (_generate, _loader, _type_annotations, inspect):
        _without_metadata(module)
    app.connect("autodoc-process-docstring", _prepare, priority=100)  # before napoleon reads the sections
    app.connect("autodoc-process-signature", _drop_signature_of_models)
    app.connect("autodoc-skip-member", _skip_machinery)
    app.add_transform(BuiltinNames)
    NumpyDocstring._consume_inline_attribute = lambda self: ("", self._dedent(self._consume_to_end()))
    app.connect("missing-reference", _unique_name)
    return {"parallel_read_safe": True}


def _without_metadata(module: Any) -> None:
    """Lets a module of autodoc write ``Annotated[float, ...]`` as ``float``."""
    for name in ("stringify_annotation", "restify"):
        if hasattr(module, name):
            setattr(module, name, _plainly(getattr(module, name)))


def _plainly(write: Callable[..., str]) -> Callable[..., str]:
    """The function that writes a type as text, without what stands beside the type in ``Annotated``."""

    def plain(annotation: Any, *arguments: Any, **options: Any) -> str:
        known = isinstance(annotation, str)
        bare = _first_of_annotated(annotation) if known else typing._strip_annotations(annotation)  # type: ignore[attr-defined]
        return write(bare, *arguments, **options)

    return plain


def _first_of_annotated(text: str) -> str:
    """The text of a type with each ``Annotated[X, ...]`` in it as ``X``."""
    while (start := text.find("Annotated[")) >= 0:
        inside, depth, comma = start + len("Annotated["), 1, 0
        end = inside
        while depth:
            depth += {"[": 1, "(": 1, "]": -1, ")": -1}.get(text[end], 0)
            comma = end if text[end] == "," and depth == 1 and not comma else comma
            end += 1
        text = f"{text[:start]}{text[inside : comma or end - 1]}{text[end:]}"
    return text


def _prepare(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Makes a docstring what napoleon and docutils read in it: sections that end, entries with descriptions, plain signs."""
    section, in_math, in_example, prepared = "", False, False, []
    for number, line in enumerate(lines):
        follows = lines[number + 1] if number + 1 < len(lines) else ""
        if follows.startswith("---") and set(follows) == {"-"}:
            section, line = line.strip(), line.replace("Attributes", "Parameters")  # the fields of a dataclass are both
        elif section and line and not line.startswith((" ", "---")) and not ENTRY.match(line) and not NAMES.match(line):
            prepared.append("")  # two blank lines end a section
            section = ""
        in_example = bool(line.strip()) and (in_example or line.startswith(">>> "))
        if line.strip():
            in_math = line.strip().startswith((".. math::", "::")) or (in_math and line.startswith(" "))
        entry = ENTRY.match(line) if section in SECTIONS else None
        if entry is not None and not (follows.startswith("    ") and entry["text"] in TYPES):
            prepared += [entry["names"], f"    {entry['text']}"]
        else:
            prepared.append(line)
        if not (in_math or in_example):
            prepared[-1] = _plain_signs(prepared[-1])
    lines[:] = prepared


def _plain_signs(line: str) -> str:
    """The line with signs escaped that docutils would take for marks: ``|s|``, ``*channels``."""
    parts = re.split(r"(``.*?``|:\w+:`[^`]*`|`[^`]*`)", line)
    return "".join(part if number % 2 else re.sub(r"(?<![\w\\])([*|])(?=\w)", r"\\\1", part) for number, part in enumerate(parts))


class BuiltinNames(SphinxTransform):
    """A name of Python itself is not looked for among the attributes of the package."""

    default_priority = 5

    def apply(self, **options: Any) -> None:
        """Make every reference to such a name exact."""
        for node in self.document.findall(addnodes.pending_xref):
            if node.get("refdomain") == "py" and hasattr(builtins, node["reftarget"]):
                for key in ("py:class", "py:module", "refspecific"):
                    node.attributes.pop(key, None)


def _drop_signature_of_models(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str | None, returns: str | None
) -> tuple[str | None, str | None] | None:
    """The fields of a model stand below it; its signature would list them again with pydantic's types."""
    return ("", None) if isinstance(obj, type) and issubclass(obj, BaseModel) else None


def _skip_machinery(app: Sphinx, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """What pydantic and matplotlib add to a class is not a part of the interface."""
    added = name.startswith("model_") or name == "linregress" or hasattr(obj, "_autogenerated_signature")
    return True if added else None


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
