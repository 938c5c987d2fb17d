"""Units of what every run with contact records of its states; apart from the records, so that a case is read without them."""

QUALITY_UNITS = {"penetration_force_error": "1", "poor_volume_fraction": "1"}
"""How good a state is: `contact_quality`."""
CONTACT_UNITS = {
    "max_penetration": "m",
    "max_pressure": "Pa",
    "min_volume_ratio": "1",
    "unstable_volume_fraction": "1",
    **QUALITY_UNITS,
}
"""A run need not record all."""
WHOLE_RUN = {
    "max_penetration": ("m", "largest penetration at any surface point in any step"),
    "min_volume_ratio": ("1", "least local volume ratio in any step"),
    "unstable_volume_fraction": ("1", "part of the volume outside strong ellipticity at any accepted step"),
}
"""Unit and description of numbers of a whole run, in a result and in a data set."""
LAST = ", at the last accepted step"
"""Behind the words of a quantity that is a value of that step."""
