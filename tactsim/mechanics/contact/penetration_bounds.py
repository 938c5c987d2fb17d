"""How large a penetration tolerance may be: small beside every length that the answer depends on."""

from __future__ import annotations

from collections.abc import Mapping

from tactsim.units import format_quantity

LARGEST_SHARE = 0.1
"""Tolerance over a length of the case: with a tenth of the displacement the body is at most a tenth less deep than asked for, and
the estimate of what that costs, linear in it, still holds; a tenth of an edge's radius or of a layer leaves their shape."""
DEFAULT_SHARE = 2e-3
"""Tolerance over the displacement that no default exceeds: creep and a force that grows faster than the displacement
included, runs with it miss less of their force than is allowed."""


def check_penetration(tolerance: float | None, lengths: Mapping[str, float | None]) -> None:
    """Check that a tolerance in m is small beside lengths in m, given by their names; those that are None or 0 do not count.

    Raises
    ------
    ValueError
        Naming the length that allows least.
    """
    given = {name: length for name, length in lengths.items() if length}
    if tolerance is None or not given:
        return
    shortest = min(given, key=lambda name: given[name])
    most = LARGEST_SHARE * given[shortest]
    if tolerance > most * (1 + 1e-12):
        asked, length, allowed = (format_quantity(value, "m") for value in (tolerance, given[shortest], most))
        raise ValueError(
            f"penetration_tolerance: {asked} is not small beside the {shortest} of {length}; allowed: at most {allowed}, a tenth"
        )


def small_part(displacement: float | None, small: float) -> float:
    """A prescribed displacement over one that counts as ``small``, both in m; 1 above it, or where none is prescribed."""
    return min(1.0, displacement / small) if displacement else 1.0


def default_penetration(usual: float, displacement: float | None, share: float = DEFAULT_SHARE) -> float:
    """The usual tolerance in m, or ``share`` of the displacement in m if that is prescribed and so small that it is less."""
    return min(usual, share * displacement) if displacement else usual
