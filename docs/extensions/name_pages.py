"""The names that ``import tactsim as ts`` offers, in groups: a line for each, then its docstring with the example."""

from __future__ import annotations

import inspect

import tactsim as ts
from tactsim.interfaces import Experiment

GROUPS = {
    "Cases and results": ("tactsim.case", "tactsim.presentation", "tactsim.results"),
    "Experiments": ("tactsim.experiments",),
    "Parts of an experiment": ("tactsim",),
    "Materials and measured curves": ("tactsim.materials", "tactsim.relaxation", "tactsim.identification"),
    "Data sets": ("tactsim.dataset", "tactsim.interfaces.variation"),
    "Kinds of your own": ("tactsim.interfaces.points",),
    "Errors": ("tactsim.errors",),
}
"""Title -> modules whose names stand there; a name belongs to the group of the longest one that fits."""


def name_pages() -> dict[str, str]:
    """The page of all names."""
    lines = [
        *_title("Names in Python", "="),
        "``import tactsim as ts`` offers these names; each is loaded when it is first used. :doc:`/guide/python` shows how they",
        "work together, and every example below runs as it stands. All other names are on the pages of :doc:`modules/index`.",
        "",
    ]
    for group in GROUPS:
        names = [name for name in ts.__all__ if group_of(name) == group]
        lines += [*_title(group, "-"), ".. list-table::", "   :widths: 1 3", ""]
        lines += [f"   * - :ref:`{name} <{_label(name)}>`\n     - {_summary(name)}" for name in names]
        for name in names:
            lines += ["", f".. _{_label(name)}:", "", *_title(name, "~")]
            lines += [f".. auto{_directive(name)}:: tactsim.{name}", "   :no-index:"]
        lines.append("")
    return {"python.rst": "\n".join(lines)}


def group_of(name: str) -> str:
    """The group of a public name."""
    value = getattr(ts, name)
    if inspect.isabstract(value):
        return "Kinds of your own"
    if inspect.isclass(value) and value.__module__.startswith("tactsim.experiments") and not issubclass(value, Experiment):
        return "Parts of an experiment"
    fits = [(len(module), group) for group, modules in GROUPS.items() for module in modules if _below(value.__module__, module)]
    return max(fits)[1]


def _below(name: str, module: str) -> bool:
    return name == module or name.startswith(f"{module}.")


def _directive(name: str) -> str:
    value = getattr(ts, name)
    if not inspect.isclass(value):
        return "function"
    return "exception" if issubclass(value, Exception) else "class"


def _label(name: str) -> str:
    """Target of a link to a name; the case of letters does not tell labels apart."""
    return f"{_directive(name)}-{name}"


def _summary(name: str) -> str:
    return " ".join((inspect.getdoc(getattr(ts, name)) or "").split("\n\n")[0].split())


def _title(text: str, line: str) -> list[str]:
    return [text, line * len(text), ""]
