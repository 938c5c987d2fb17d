"""The ranking of estimators as files: all numbers, and a table to read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

import numpy as np

from tactsim.dataset.ranking.intervals import DRAWN, INTERVAL
from tactsim.dataset.ranking.measures import LABELS, Ranked
from tactsim.dataset.ranking.samples import JudgedSamples
from tactsim.interfaces.readings import noise_in_words
from tactsim.outside.text import aligned, markdown_table
from tactsim.units import format_quantity

SCHEMA = "tactsim/ranking/1"
SCORE = (
    "Mean over all samples of the distance in space between the estimated and the true centre, at most half the block's plan and "
    "height together; a missed lump and a false alarm count that much."
)
BASELINE = "thesis"


@dataclass(frozen=True)
class Column:
    """A column of a table of measures: its heading, the keys that lead to the measure, and its unit; lengths are shown in mm."""

    heading: str
    place: tuple[str, ...]
    unit: str


COLUMNS = (
    Column("score [mm]", ("score",), "m"),
    Column("detected", ("detection_rate",), "1"),
    Column("false alarms", ("false_alarm_rate",), "1"),
    Column("lateral error, median [mm]", ("lateral_error", "median"), "m"),
    Column("90 % quantile [mm]", ("lateral_error", "quantile_90"), "m"),
    Column("depth error, median [mm]", ("depth_error", "median"), "m"),
    Column("90 % quantile [mm]", ("depth_error", "quantile_90"), "m"),
    Column("radius error, median [mm]", ("radius_error", "median"), "m"),
    Column("coverage of 90 % regions", ("coverage",), "1"),
    Column("their width, median [mm]", ("region_width",), "m"),
    Column("their height, median [mm]", ("region_height",), "m"),
)
"""Of the whole report."""
BRIEF = (
    Column("score", ("score",), "m"),
    Column("found", ("detection_rate",), "1"),
    Column("alarms", ("false_alarm_rate",), "1"),
    Column("lateral", ("lateral_error", "median"), "m"),
    Column("depth", ("depth_error", "median"), "m"),
    Column("radius", ("radius_error", "median"), "m"),
    Column("coverage", ("coverage",), "1"),
)
"""The same of the columns that fit a terminal."""
BRIEFLY = (
    "score, and medians of the lateral, depth and radius errors, in mm; alarms: false ones; coverage: of 90 % regions. Their "
    "intervals and all else stand in report.md."
)
SCREEN = 79
"""Columns of a terminal."""
BINNED = (COLUMNS[1], COLUMNS[3], COLUMNS[5], COLUMNS[7], COLUMNS[8])


def record(ranked: Sequence[Ranked], samples: JudgedSamples, about: Mapping[str, Any]) -> dict[str, Any]:
    """All numbers of a ranking, in SI; ``about`` describes the run: store, split, seed. The noise is the median and the range."""
    low, high = float(samples.noise.min()), float(samples.noise.max())
    return {
        "schema": SCHEMA,
        **about,
        "score": SCORE,
        "readings": samples.source,
        "noise": {"value": float(np.median(samples.noise)), "low": low, "high": high, "unit": "N"},
        "block_size": {"value": samples.block_size.tolist(), "unit": "m"},
        "samples": len(samples.truths),
        "specimens": _specimens(samples),
        "interval": {"probability": INTERVAL, "rates": "Wilson", "bootstrap_samples": DRAWN},
        "labels": LABELS,
        "estimators": [one.record() for one in ranked],
        "against_baseline": against_baseline(ranked),
    }


def against_baseline(ranked: Sequence[Ranked]) -> dict[str, dict[str, float]]:
    """For each estimator, its median lateral and depth error over that of the thesis's algorithm, misses counted in both."""
    base = next((one for one in ranked if one.name == BASELINE), None)
    ratios: dict[str, dict[str, float]] = {}
    for one in ranked:
        if base is None or one is base:
            continue
        ratios[one.name] = {}
        for name in ("lateral_error_with_misses", "depth_error_with_misses"):
            ours, other = one.measures[name], base.measures[name]
            if ours is not None and other is not None and other["value"] > 0:
                ratios[one.name][name] = ours["value"] / other["value"]
    return ratios


def seen_words(seen: int, samples: JudgedSamples) -> str:
    """What a reader must know if an estimator was trained on ``seen`` of the samples; empty of none."""
    if not seen:
        return ""
    return (
        f"Warning: learned was trained on {seen} of these {len(samples.truths)} grasps, so its numbers do not say what it does "
        "with others; rank a part that it has not seen, such as --split test, or another data set."
    )


def _counted(samples: JudgedSamples) -> str:
    """How many grasps there are, and of how many specimens if they share some."""
    count, specimens = len(samples.truths), _specimens(samples)
    return f"{count} grasps" if specimens == count else f"{count} grasps of {specimens} specimens"


def _specimens(samples: JudgedSamples) -> int:
    return len({truth.group for truth in samples.truths})


def _noise_words(samples: JudgedSamples) -> str:
    """The noise of a reading, or its range if sensors vary."""
    low, high = (f"{noise:.3g}" for noise in (samples.noise.min(), samples.noise.max()))  # known to a few parts in a hundred
    if low == high:
        return noise_in_words(float(samples.noise[0]))
    return f"{format_quantity(float(low), 'N')} to {format_quantity(float(high), 'N')}"


def as_text(
    ranked: Sequence[Ranked],
    samples: JudgedSamples,
    figures: Sequence[str],
    seen: int = 0,
    *,
    failed: Mapping[str, str] | None = None,
) -> str:
    """The table in Markdown; ``seen`` samples were those of the training; ``failed`` estimators have reasons, not numbers."""
    lumps = sum(truth.present for truth in samples.truths)
    lines = [
        "# Ranking of estimators",
        "",
        f"{_counted(samples)}, {lumps} with a lump, {len(samples.truths) - lumps} without; readings {samples.source}, "
        f"noise of a reading {_noise_words(samples)}. {SCORE}",
        f"In brackets the {100 * INTERVAL:.0f} % interval over specimens, of rates by Wilson, of all else by the bootstrap. "
        "Depths are those of the centre below the upper face; inclusion_depth in the data set is that of the highest point.",
        "",
        *((words, "") if (words := seen_words(seen, samples)) else ()),
        *_table("estimator", [(one.name, one.measures) for one in ranked], COLUMNS),
        "",
        *(line for name, reason in (failed or {}).items() for line in (f"`{name}` failed and is not ranked: {reason}", "")),
    ]
    ratios = against_baseline(ranked)
    if ratios:
        lines += [f"Median errors over those of `{BASELINE}`, a missed lump counted as half the block:", ""]
        lines += [f"- {name}: {_ratios(ratio)}" for name, ratio in ratios.items()]
        lines += [""]
    for one in ranked:
        lines += [f"## {one.name}", "", *_of_one(one)]
    return "\n".join([*lines, *(f"![{name}]({name})" for name in figures), ""])


def as_summary(ranked: Sequence[Ranked], samples: JudgedSamples, seen: int = 0) -> str:
    """What a terminal of 80 columns shows of it: counts, the main numbers without their intervals, and the ratios; ``seen``
    samples were those of the training.
    """
    lumps = sum(truth.present for truth in samples.truths)
    counts = f"{_counted(samples)}, {lumps} with a lump; readings {samples.source}, noise of a reading {_noise_words(samples)}"
    rows = [["estimator", *(column.heading for column in BRIEF)]]
    for one in ranked:
        rows.append([one.name, *(_cell(one.measures, column).partition(" ")[0] for column in BRIEF)])
    ratios = [f"{name}: median errors over those of {BASELINE}: {_ratios(one)}" for name, one in against_baseline(ranked).items()]
    words = [line for given in (BRIEFLY, *ratios, seen_words(seen, samples)) for line in wrap(given, SCREEN)]
    return "\n".join([*wrap(counts, SCREEN), "", *aligned(rows), "", *words])


def _ratios(ratios: Mapping[str, float]) -> str:
    return ", ".join(f"{name.split('_')[0]} {value:.2f}" for name, value in ratios.items()) or "not known"


def _of_one(one: Ranked) -> list[str]:
    noises = [(f"{multiple:g} x", measures) for multiple, measures in one.noises.items()]
    lines = [*_table("noise", noises, (COLUMNS[0], COLUMNS[2], *BINNED)), ""]
    for label, bins in one.bins.items():
        rows = [(f"{_shown(part['low'], LABELS[label])} to {_shown(part['high'], LABELS[label])}", part) for part in bins]
        heading = f"{label} [mm]" if LABELS[label] == "m" else label
        lines += [*_table(heading, rows, BINNED), ""]
    return lines


def _table(first: str, rows: Sequence[tuple[str, Mapping[str, Any]]], columns: Sequence[Column]) -> list[str]:
    """The named ``rows`` of measures."""
    cells = ([name, *(_cell(measures, column) for column in columns)] for name, measures in rows)
    return markdown_table([first, *(column.heading for column in columns)], cells)


def _cell(measures: Mapping[str, Any], column: Column) -> str:
    entry: Any = measures
    for key in column.place:
        entry = None if entry is None else entry[key]
    if entry is None:
        return "-"
    value, low, high = (_shown(entry[name], column.unit) for name in ("value", "low", "high"))
    return f"{value} [{low}, {high}]"


def _shown(value: float, unit: str) -> str:
    return f"{1e3 * value:.2f}" if unit == "m" else f"{value:.2f}"
