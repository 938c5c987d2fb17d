"""The order of the rooms as ``pyproject.toml`` holds it."""

from __future__ import annotations

from print_rules import BEGIN, END, printed_rules


def rule_pages() -> dict[str, str]:
    """What the page about the house includes."""
    return {"rules.inc": printed_rules().replace(BEGIN, "").replace(END, "").strip() + "\n"}
