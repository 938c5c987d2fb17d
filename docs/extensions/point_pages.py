"""The extension points with the kinds that are registered at each."""

from __future__ import annotations

from markdown_parts import first_paragraph, page, table

from tactsim import interfaces
from tactsim.kind import Kind
from tactsim.marked_functions import marked_functions
from tactsim.registry import kinds

ORDER = (
    "Material",
    "RigidBody",
    "ContactLaw",
    "Inclusion",
    "SensorFilm",
    "Experiment",
    "Estimator",
    "Recorder",
    "ResultFigures",
)


def point_pages() -> dict[str, str]:
    """One page: each point, what a subclass must offer, and what is registered."""
    lines = [
        "# Extension points",
        "",
        "A class of one of these points is registered as it is defined, by its literal `kind`. All of them stand in",
        "{py:mod}`tactsim.interfaces`; [Adding a kind](/building/adding.md) has an example of each.",
        "",
    ]
    for name in ORDER:
        point = getattr(interfaces, name)
        asked = sorted(point.__abstractmethods__)
        lines += [
            f"## {name}",
            "",
            first_paragraph(point.__doc__),
            "",
            f"Interface: {{py:class}}`tactsim.interfaces.{name}`.",
            "",
        ]
        lines += ["A subclass must define:", "", *table(("name", "what it is"), [_asked(point, member) for member in asked])]
        lines += [
            "Registered:",
            "",
            *table(("kind", "class", "what it is"), [_kind(*item) for item in sorted(kinds(point).items())]),
        ]
    for what in ("quantity", "drawing"):
        lines += [f"## @{what}", "", first_paragraph(getattr(interfaces, what).__doc__), "", "Registered:", ""]
        rows = [
            (f"`{name}`", _unit(marked), first_paragraph(marked.function.__doc__))
            for name, marked in sorted(marked_functions("tactsim.validation.quantities", what).items())
        ]
        lines += table(("name", "unit", "what it is"), rows)
    return {"points.md": page(lines)}


def _asked(point: type[Kind], member: str) -> tuple[str, str]:
    return f"`{member}`", first_paragraph(getattr(point, member).__doc__)


def _kind(kind: str, cls: type[Kind]) -> tuple[str, str, str]:
    return f"`{kind}`", f"{{py:class}}`~{cls.__module__}.{cls.__qualname__}`", first_paragraph(cls.__doc__)


def _unit(marked: object) -> str:
    unit = getattr(marked, "unit", None)
    return f"`{unit}`" if isinstance(unit, str) else ("as its argument says" if callable(unit) else "")
