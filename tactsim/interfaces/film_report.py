"""What a film says of itself under constant forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tactsim.results.quantity import Quantity


@dataclass(frozen=True)
class FilmReport:
    """Numbers of a film beside its signal.

    Attributes
    ----------
    constants : derived numbers of the film
    readings : what the signals that were read show of it, by force
    coefficients : coefficients of its creep at each force by name; None if its kind has none
    """

    constants: Mapping[str, Quantity]
    readings: Mapping[str, Quantity] = field(default_factory=dict)
    coefficients: Mapping[str, Sequence[float]] | None = None
