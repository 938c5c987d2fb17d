"""The case format from its JSON Schema: a page for each experiment, one for each extension point, one for shared parts."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from markdown_parts import first_paragraph, page, table, toctree

from tactsim.case.json_schema import case_json_schema, described
from tactsim.dataset.sampling.json_schema import sweep_json_schema
from tactsim.interfaces import ContactLaw, Estimator, Experiment, Inclusion, Material, RigidBody, SensorFilm
from tactsim.materials.library import LIBRARY
from tactsim.model import FrozenModel
from tactsim.registry import kinds

Fragment = dict[str, Any]
HEADER = ("key", "type or unit", "default", "meaning")
POINTS = {
    "bodies": ("Rigid bodies", RigidBody, "What `body` takes."),
    "contact_laws": ("Contact laws", ContactLaw, "What `contact` takes."),
    "inclusions": ("Inclusions", Inclusion, "What `shape` takes in an entry of `inclusions`."),
    "films": ("Sensor films", SensorFilm, "What `film` takes; without a `kind` it is `film`."),
    "estimators": ("Estimators", Estimator, "What `estimator` takes."),
}
BOUNDS = {
    "exclusiveMinimum": ">",
    "minimum": "≥",
    "exclusiveMaximum": "<",
    "maximum": "≤",
    "minItems": "at least",
    "maxItems": "at most",
}
OWN_SWEEP = "sweep_settings_"


@dataclass(frozen=True)
class Schema:
    """A schema's definitions, and the labels that links to them use."""

    definitions: dict[str, Fragment]

    @staticmethod
    def label(name: str) -> str:
        """Target of a link to a definition."""
        return f"case-{re.sub('[^a-z0-9]+', '-', re.sub('(?<=[a-z0-9])(?=[A-Z])', '-', name).lower())}"

    def title(self, name: str) -> str:
        """What a definition is called: its ``kind`` if it has one."""
        definition = self.definitions[name]
        kind = definition.get("properties", {}).get("kind", {}).get("const")
        return f"`{kind}`" if kind else str(definition.get("title", name))

    def link(self, name: str) -> str:
        """A link to a definition."""
        return f"[{self.title(name)}](#{self.label(name)})"

    def section(self, name: str, level: int = 2) -> list[str]:
        """A definition in full: what it is, and a row for each key."""
        definition = self.definitions[name]
        return [f"({self.label(name)})=", f"{'#' * level} {self.title(name)}", "", *self.body(definition)]

    def body(self, definition: Fragment) -> list[str]:
        """What a definition is, and a row for each key."""
        required = definition.get("required", ())
        model = _model_of(definition)
        rows = [self.row(key, value, key in required, model) for key, value in definition.get("properties", {}).items()]
        lines = [first_paragraph(definition.get("description")), ""]
        return [*lines, *table(HEADER, rows)] if rows else [*lines, "No keys.", ""]

    def row(self, key: str, value: Fragment, required: bool, model: Any = None) -> tuple[str, str, str, str]:
        """Key, type, default and meaning; the schema has no bounds of quantities, which are text there: those of the model."""
        default = "required" if required and "default" not in value else self.default(value)
        if "const" in value:
            default = "required" if required else f"`{value['const']}`"
        bounds = _bounds(model, key) if "unit" in value else ""
        return f"`{key}`", self.type_of(value) + bounds, default, first_paragraph(value.get("description"))

    def default(self, value: Fragment) -> str:
        """The default as a case file would write it; of a part with keys of its own, those that the part lists."""
        default = value.get("default")
        if isinstance(default, dict):
            kind = default.get("kind")
            return f"`{kind}`" if isinstance(kind, str) else "its own defaults"
        return f"`{json.dumps(default, ensure_ascii=False)}`" if "default" in value else ""

    def type_of(self, value: Fragment) -> str:
        """What a value may be, in words."""
        if "$ref" in value:
            return self.link(value["$ref"].rpartition("/")[2])
        if "allOf" in value and len(value["allOf"]) == 1:
            return self.type_of(value["allOf"][0])
        for union in ("anyOf", "oneOf"):
            if union in value:
                return self.union_of(value[union])
        if "const" in value:
            return f"`{value['const']}`"
        if "enum" in value:
            return ", ".join(f"`{choice}`" for choice in value["enum"])
        return self.plain(value)

    def union_of(self, members: list[Fragment]) -> str:
        """Every member; the long union of all materials is a link."""
        if any(member.get("title") == "SetReference" for member in members):
            return "[material](#case-materials)" + (" or null" if {"type": "null"} in members else "")
        return " or ".join(dict.fromkeys(self.type_of(member) for member in members))

    def plain(self, value: Fragment) -> str:
        """A type without alternatives, with its bounds."""
        kind = value.get("type", "any")
        bounds = ", ".join(f"{sign} {value[name]:g}" for name, sign in BOUNDS.items() if name in value)
        if "unit" not in value and kind == "string" and "pattern" in value:
            return "quantity"
        if "unit" in value:
            return f"`{value['unit']}`" + (f", {bounds}" if bounds else "")
        if kind == "array":
            items = value.get("items", {})
            inside = ", ".join(self.type_of(item) for item in items) if isinstance(items, list) else self.type_of(items)
            return f"list of {inside}" + (f", {bounds}" if bounds else "")
        if kind == "object" and isinstance(value.get("additionalProperties"), dict):
            return f"map of name to {self.type_of(value['additionalProperties'])}"
        return f"{kind}, {bounds}" if bounds else str(kind)


def _model_of(definition: Fragment) -> Any:
    """The class that a definition describes, told by its name and keys; None if several are."""
    keys = set(definition.get("properties", ()))
    found = [cls for cls in _models(FrozenModel) if cls.__name__ == definition.get("title") and keys <= set(cls.model_fields)]
    return found[0] if len(found) == 1 else None


def _models(base: Any) -> Iterator[Any]:
    for cls in base.__subclasses__():
        yield cls
        yield from _models(cls)


def _bounds(model: Any, key: str) -> str:
    """Bounds of a field in words, in SI."""
    metadata = model.model_fields[key].metadata if model is not None else ()
    signs = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
    found = [f", {sign} {getattr(one, name):g}" for one in metadata for name, sign in signs.items() if hasattr(one, name)]
    return "".join(found)


def case_pages() -> dict[str, str]:
    """Every page of the case format and of the sweep format."""
    whole = case_json_schema()
    schema = Schema(whole["$defs"])
    experiments = dict(_named(schema, Experiment))
    pages = {f"case/{kind}.md": page(schema.section(name, level=1)) for kind, name in experiments.items()}
    used = set(experiments.values())
    for place, (title, point, what) in POINTS.items():
        names = [name for _, name in _named(schema, point)]
        used.update(names)
        pages[f"case/{place}.md"] = page([f"# {title}", "", what, ""], *(schema.section(name) for name in names))
    rest = sorted(
        (name for name in schema.definitions if name not in used), key=lambda name: schema.title(name).strip("`").lower()
    )
    heading = ["# Shared parts", "", "Parts of a case that several kinds use.", ""]
    pages["case/parts.md"] = page(heading, *(schema.section(name) for name in rest))
    pages["case/materials.md"] = _material_page()
    pages["case/sweep.md"] = _sweep_page()
    pages["case/index.md"] = _index(schema, whole, experiments)
    return pages


def _named(schema: Schema, point: type) -> Iterator[tuple[str, str]]:
    """Kind and name of its definition, of the kinds of a point that a case can name."""
    for kind, cls in sorted(kinds(point).items()):
        mangled = f"{cls.__module__}.{cls.__qualname__}".replace(".", "__")
        for name in (mangled, cls.__name__):
            if name in schema.definitions and schema.definitions[name]["properties"].get("kind", {}).get("const") == kind:
                yield kind, name
                break


def _material_page() -> str:
    sets = table(("name", "source"), [(f"`{name}`", first_paragraph(shipped.source)) for name, shipped in LIBRARY.items()])
    lines = [
        "(case-materials)=",
        "# Materials",
        "",
        "What `material`, `tissue` and similar keys take: the name of a shipped set,",
    ]
    lines += [
        "`{set: NAME}` with a bulk modulus or a relaxation of its own, or a `kind` with its constants.",
        "",
        "## Shipped sets",
        "",
    ]
    lines += sets
    for kind, cls in sorted(kinds(Material).items()):
        definition = described(cls)
        schema = Schema(definition.get("$defs", {}))
        lines += [f"## `{kind}`", "", *schema.body(definition)]
    return page(lines)


def _sweep_page() -> str:
    whole = sweep_json_schema()
    schema = Schema(whole["$defs"])
    lines = [
        "# Sweep files",
        "",
        "A sweep file is a case in which a distribution may stand for a value, and a section `sweep`.",
        "",
    ]
    lines += ["## `sweep`", "", *schema.body(whole["properties"]["sweep"])]
    own = [name for name in schema.definitions if name.startswith((OWN_SWEEP, "varying_"))]
    for name in own:
        definition = schema.definitions[name]
        if "oneOf" in definition or "anyOf" in definition:
            lines += [f"({schema.label(name)})=", f"## {name.replace('_', ' ')}", "", *_alternatives(schema, definition)]
        else:
            lines += schema.section(name)
    return page(lines)


def _alternatives(schema: Schema, definition: Fragment) -> list[str]:
    lines = [first_paragraph(definition.get("description")), ""]
    for member in definition.get("oneOf", definition.get("anyOf", ())):
        rows = [schema.row(key, value, key in member.get("required", ())) for key, value in member.get("properties", {}).items()]
        lines += table(HEADER, rows) if rows else []
    return lines


def _index(schema: Schema, whole: Fragment, experiments: dict[str, str]) -> str:
    required = whole.get("required", ())
    rows = [schema.row(key, value, key in required) for key, value in whole["properties"].items() if key != "experiment"]
    rows.insert(
        2,
        ("`experiment`", "one of the kinds below", "required", first_paragraph(whole["properties"]["experiment"]["description"])),
    )
    listed = [
        (f"[`{kind}`]({kind}.md)", first_paragraph(schema.definitions[name].get("description")))
        for kind, name in experiments.items()
    ]
    return page(
        [
            "# Case files",
            "",
            "These pages are made from the JSON Schema that `tactsim schema` prints. Where the second column is a",
        ],
        [
            "unit, the value is text with any unit of that dimension, such as `1.5 mm`; a bare number is an error.",
            "Bounds, and bare numbers among the defaults, are in that unit.",
            "",
        ],
        table(HEADER, rows),
        ["## Kinds of experiment", ""],
        table(("kind", "what it computes"), listed),
        toctree(experiments, hidden=True),
        ["## What they share", ""],
        toctree(["materials", *POINTS, "parts", "sweep"]),
    )
