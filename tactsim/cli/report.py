"""A result in words, for the end of a run and for ``tactsim show``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.outside.text import one_line
from tactsim.progress import Extent
from tactsim.results import Quantity, Result, Status, StepRecord
from tactsim.results.quantity import ROUND_OFF, format_values
from tactsim.units import format_quantity, rough_time


def result_report(result: Result, title: str = "") -> str:
    """Title, status, quantities with units, each with assumptions that name it, warnings, and the number of assumptions."""
    shown = grouped(result.quantities)
    width = max((len(one_line(name)) for name in shown), default=0)
    lines = [one_line(title)] if title else []
    lines.append(_ending(result))
    for name, q in shown.items():
        lines.append(f"  {one_line(name):<{width}}  {one_line(format_values(q)):<14}  {one_line(q.description)}".rstrip())
        lines += [f"  {'':<{width}}  assumption: {one_line(words)}" for words in assumptions_about(name, result.assumptions)]
    lines += [f"  warning: {one_line(warning)}" for warning in result.warnings]
    counted = [_counted(len(result.steps), "accepted step"), *([_duration(result.timing)] if result.timing else [])]
    lines.append(f"  {', '.join(counted)}; {_counted(len(result.assumptions), 'assumption')} listed in result.json")
    return "\n".join(lines)


NUMBERED = re.compile(r"(.+)_(\d+)")
"""Name of a quantity of one of several specimens, touches or films."""
MOST_ALONE = 4
"""Quantities that differ in their number alone and have a line each; more of them share one."""


def grouped(quantities: Mapping[str, Quantity]) -> dict[str, Quantity]:
    """The quantities, those of one name with many numbers as one of all their values, where the first of them stands.

    Its description is what theirs begin with in common, and what the first and the last go on with.
    """
    families: dict[str, list[str]] = {}
    for name in quantities:
        if numbered := NUMBERED.fullmatch(name):
            families.setdefault(numbered[1], []).append(name)
    alike = {family: names for family, names in families.items() if len({quantities[name].unit for name in names}) == 1}
    large = {family: names for family, names in alike.items() if len(names) > MOST_ALONE}
    placed = {name: family for family, names in large.items() for name in names}
    shown: dict[str, Quantity] = {}
    for name, quantity in quantities.items():
        if name not in placed:
            shown[name] = quantity
        elif name == large[placed[name]][0]:
            names = large[placed[name]]
            shown[f"{name} to _{names[-1].rpartition('_')[2]}"] = _together([quantities[one] for one in names])
    return shown


def _together(quantities: Sequence[Quantity]) -> Quantity:
    """All values of several quantities of one unit."""
    values = np.concatenate([quantity.numbers.ravel() for quantity in quantities])
    first, last = (quantity.description.rpartition(", ") for quantity in (quantities[0], quantities[-1]))
    alike = first[0] and first[0] == last[0]
    return Quantity(values, quantities[0].unit, f"{first[0]}, {first[2]} to {last[2]}" if alike else quantities[0].description)


def assumptions_about(name: str, assumptions: Iterable[str]) -> list[str]:
    """Those that name a quantity, such as "threshold pressure": they say what its number owes to them.

    A name of a single word, such as ``time``, is a word of any sentence.
    """
    words = name.replace("_", " ")
    return [assumption for assumption in assumptions if words in assumption] if " " in words else []


def last_line(result: Result, place: Path, figures: Mapping[str, Any]) -> str:
    """What matters most and where to look: a threshold pressure only if the run converged."""
    threshold = result.quantities.get("threshold_pressure")
    if result.status is not Status.CONVERGED:
        headline = _ending(result)
    elif threshold is None:
        headline = str(result.status)
    else:
        headline = "threshold pressure " + ("not reached" if threshold.value is None else format_values(threshold))
    figure = next(iter(figures), None)
    return f"{headline}; " + (f"figure {place / 'figures' / figure}" if figure else f"result {place}")


def _ending(result: Result) -> str:
    """Status and reason, once where the reason begins with the status."""
    reason = one_line(result.reason)
    adds = reason and not reason.startswith(str(result.status))
    return f"{result.status}: {reason}" if adds else reason or str(result.status)


COMPONENT = re.compile(r"(.+)_[xyz]")
"""Name of a component of a vector."""
VALUES_IN_A_LINE = 4
"""How many history values a progress line shows."""


def step_line(record: StepRecord, units: Mapping[str, str], extent: Extent | None = None, elapsed: float = 0.0) -> str:
    """One line per accepted step: the first values that the units name, of which the rest stand in ``history.csv``, and what
    Newton's method took, if the step is one of its solutions.

    Parameters
    ----------
    record, units : the step, and the unit of each of its values
    extent : how far the run goes, of which the step has reached so many per cent
    elapsed : time in s since the run began, without compiling; from a second on the time left is given, as if all took as long
    """
    shown = [name for name in units if name in record.values][:VALUES_IN_A_LINE] or list(record.values)
    values = [f"{name} {format_quantity(_without_round_off(name, record.values), units.get(name, ''))}" for name in shown]
    share = extent.share(record) if extent else 0.0
    reached = f" {share:4.0%}" if extent else ""
    solved = record.newton_iterations > 0 or record.residual > 0
    effort = [f"{record.newton_iterations} iterations, residual {record.residual:.1e}"] if solved else []
    left = [f"about {rough_time(elapsed * (1 / share - 1))} left"] if elapsed >= 1 and 0 < share < 1 else []
    return "  ".join([f"step {record.step:4d}{reached}", *values, *effort, *left])


def _without_round_off(name: str, values: Mapping[str, float]) -> float:
    """A history value, 0 if it is a component of a vector that is round-off beside another one."""
    vector = COMPONENT.fullmatch(name)
    beside = [abs(values.get(f"{vector[1]}_{axis}", 0.0)) for axis in "xyz"] if vector else [0.0]
    return 0.0 if abs(values[name]) < ROUND_OFF * max(beside) else values[name]


def _duration(timing: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {seconds:.1f} s" for name, seconds in timing.items())


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
