"""The confusion table of a data set as files: all numbers, and a table to read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tactsim.localization.confusion import ConfusionTable
from tactsim.localization.estimators.hypotheses import CLASSES
from tactsim.units import format_quantity

SCHEMA = "tactsim/confusion/1"


def record(table: ConfusionTable, others: int, about: Mapping[str, Any]) -> dict[str, Any]:
    """Everything; ``about`` is what is told of the run beside it, with the ``noise`` in N, ``others`` belong to no class."""
    return {
        "schema": SCHEMA,
        **about,
        "classes": list(CLASSES),
        "counts": table.counts.tolist(),
        "samples": table.total,
        "of_no_class": others,
        "share_right": table.share_right,
        "recalls": dict(zip(CLASSES, table.recalls, strict=True)),
    }


def verdict(content: Mapping[str, Any]) -> str:
    """How many were told right, in words."""
    right = sum(row[k] for k, row in enumerate(content["counts"]))
    return f"{right} of {content['samples']} grasps told right"


def as_text(content: Mapping[str, Any], figures: Mapping[str, bytes]) -> str:
    """The table in Markdown, true classes down and estimated ones across; a class that does not occur has no row."""
    names = [name.replace("_", " ") for name in content["classes"]]
    lines = [
        "# Confusion table",
        "",
        f"{verdict(content)} by `{content['estimator']}`, noise of a reading {format_quantity(content['noise'], 'N')}; "
        f"{content['of_no_class']} samples belong to no class.",
        "",
        f"| true, estimated across | {' | '.join(names)} | told right |",
        "|" + " --- |" * (len(names) + 2),
    ]
    for name, shown, counts in zip(content["classes"], names, content["counts"], strict=True):
        recall = content["recalls"][name]
        if recall is not None:
            lines.append(f"| {shown} | {' | '.join(map(str, counts))} | {recall:.0%} |")
    return "\n".join([*lines, "", *(f"![{name}]({name})" for name in figures), ""])
