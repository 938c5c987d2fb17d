"""What the history of an indentation holds: its values and their units, without the run that fills it."""

from __future__ import annotations

from tactsim.mechanics.outcome.contact_history import CONTACT_UNITS

CLOCK = ("time", "closed_form_displacement", "closed_form_force", "closed_form_difference")
"""Values of a timed indentation alone."""
SPACE = ("force_x", "force_y", "moment_x", "moment_y", "moment_z")
"""Values of an indentation in 3D alone."""
THRESHOLD = {
    "threshold_force": ("N", "force on the annulus when the tissue touches the inner sensor"),
    "threshold_pressure": ("Pa", "threshold force over the annular area"),
    "threshold_displacement": ("m", "displacement at the threshold"),
}
"""Unit and description of what holds at the threshold, in a result and in a data set."""
UNITS: dict[str, str] = {
    "time": "s",
    "displacement": "m",
    "reaction_force": "N",
    "force_x": "N",
    "force_y": "N",
    "moment_x": "N m",
    "moment_y": "N m",
    "moment_z": "N m",
    "tissue_rise": "m",
    "tissue_rise_axis": "m",
    "sensor_force": "N",
    "base_force": "N",
    **CONTACT_UNITS,
    "closed_form_displacement": "m",
    "closed_form_force": "N",
    "closed_form_difference": "1",
}


def history_units(*, clock: bool, space: bool) -> dict[str, str]:
    """Units of the history of an indentation with or without a clock, in a section or in 3D."""
    left = {*(() if clock else CLOCK), *(() if space else SPACE), *(("sensor_force",) if clock else ())}
    return {name: unit for name, unit in UNITS.items() if name not in left}
