"""Writes the layers and the fences that pyproject.toml holds into CONTRIBUTING.md: ``python scripts/print_rules.py``."""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
BEGIN, END = "<!-- printed by scripts/print_rules.py from pyproject.toml -->", "<!-- end of what is printed -->"
FIGURES = "tactsim.**.figures"


def printed_rules() -> str:
    """The layers of rooms and of families of experiments from top to bottom, and a line for each fence, as Markdown."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    rooms, families, *floors = (contract for contract in contracts if contract["type"] == "layers")
    lines = [
        BEGIN,
        "```text",
        *(layer.replace("tactsim.", "") for layer in rooms["layers"]),
        "```",
        "",
        "Within `experiments`, a family stands above those that it builds on; one that is not named here builds on none:",
        "",
        "```text",
        *families["layers"],
        "```",
        "",
    ]
    for room in floors:
        order = " > ".join(f"`{layer}`" for layer in room["layers"])
        lines.append(f"- Within `{room['containers'][0].removeprefix('tactsim.')}`: {order.replace(' | ', '` | `')}")
    lines += [
        "",
        "| fenced | imported only in |",
        "|---|---|",
    ]
    for contract in contracts:
        if contract["type"] == "protected":
            allowed = (
                "modules and packages named `figures`" if name == FIGURES else f"`{name}`"
                for name in contract["allowed_importers"]
            )
            lines.append(f"| {contract['name']} | {', '.join(allowed)} |")
    return "\n".join([*lines, END])


def with_printed_rules(text: str) -> str:
    """The text of CONTRIBUTING.md with the rules that hold now between its two marks."""
    before, rest = text.split(BEGIN)
    return before + printed_rules() + rest.split(END)[1]


if __name__ == "__main__":
    place = ROOT / "CONTRIBUTING.md"
    place.write_text(with_printed_rules(place.read_text(encoding="utf-8")), encoding="utf-8")
