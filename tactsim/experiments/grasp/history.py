"""What the history of a grasp holds: its values and their units, without the run that fills it."""

from __future__ import annotations

from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.outcome.contact_history import QUALITY_UNITS
from tactsim.results.result import Result

MOST_COLUMNS = 8
"""Rows and columns of a matrix up to which the history has a column for every taxel."""
MOST_LUMENS = 32
"""Lumens whose pressures the history can name: as many as a grasp may have inclusions."""
AXES = "xyz"


def taxel_columns(side: str) -> dict[tuple[int, int], str]:
    """Names in the history of the forces on a jaw's taxels, by row and column counted from 1; of the largest matrix in it."""
    numbers = range(1, MOST_COLUMNS + 1)
    return {(row, column): f"{TAXEL_FORCE}_{side}_{row}_{column}" for row in numbers for column in numbers}


def lumen_columns(result: Result) -> list[str]:
    """Names in the history of the pressures in lumens that a result has."""
    return sorted({name for step in result.steps for name in step.values if name.startswith("lumen_pressure")})


UNITS: dict[str, str] = {
    "time": "s",
    "displacement": "m",
    "reaction_force": "N",
    **{f"jaw_force_{side}_{axis}": "N" for side in JAWS for axis in AXES},
    **{f"{part}_force_{side}": "N" for part in ("gap", "outside") for side in JAWS},
    "max_penetration": "m",
    "min_volume_ratio": "1",
    "unstable_volume_fraction": "1",
    **QUALITY_UNITS,
    **{f"lumen_pressure_{number}": "Pa" for number in range(1, MOST_LUMENS + 1)},
    **{name: "N" for side in JAWS for name in taxel_columns(side).values()},
}
