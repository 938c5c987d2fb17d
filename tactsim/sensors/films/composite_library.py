"""Shipped composites, each with the source of its numbers."""

from __future__ import annotations

from typing import Annotated, Any

from tactsim.registry import Named, shipped
from tactsim.sensors.films.composite import Composite
from tactsim.sensors.films.tunnelling import contact_coefficient

_CREEP: dict[str, Any] = {
    "instantaneous": {"slope": 60_900.0, "intercept": 651_200.0},
    "delayed": {"slope": 449_900.0, "intercept": 397_700.0},
    "viscosity": {"slope": 1_208_200.0, "intercept": 2_892_800.0},
    "reference_area": 15e-3 * 15e-3,
    "largest_force": 8.0,
}
"""Eq. 2.3.1 with errata E3; creep tests at 2, 4, 6 and 8 N."""
_FILLER: dict[str, Any] = {"volume_fraction": 0.2873, "particle_diameter": 500e-9, "barrier": 8.01088317e-21}
"""Table 2.1 and section 2.1.1; the barrier of 0.05 eV in J."""
_RESISTIVITY, _THICKNESS, _HARDNESS = 5.0, 0.2e-3, 52e6
"""Table 2.1: 500 ohm cm, 0.2 mm, Meyer hardness 52, its unit taken as MPa."""

_LITERAL = Composite(
    **_FILLER,
    **_CREEP,
    initial_resistance=_RESISTIVITY * _THICKNESS / _CREEP["reference_area"],
    contact_resistance=contact_coefficient((_RESISTIVITY, 0.0), _HARDNESS),
    source="thesis, Table 2.1 and eq. 2.3.1, taken literally; hardness 52 read as MPa (errata E28)",
)
LIBRARY: dict[str, Composite] = {
    "lingstat_literal": _LITERAL,
    "lingstat_identified": _LITERAL.model_copy(
        update={
            "initial_resistance": 56_940.0,
            "contact_resistance": 9_948.0,
            "source": "identified to F = 20.94 C - 0.132 (thesis, 3.1.2; C in mS) 0.5 to 5 N at 1 s; rest lingstat_literal",
        }
    ),
    "lingstat_joint": _LITERAL.model_copy(
        update={
            "barrier": 3.594_48e-21,
            "initial_resistance": 36_213.8,
            "contact_resistance": 8_364.52,
            "source": "fitted with the barrier to F = 20.94 C - 0.132 (thesis, 3.1.2; C in mS) 0.5 to 5 N at 1 s, "
            "creep of eq. 2.3.1 kept; barrier 0.0224 eV for 0.05 eV, the only constant that the thesis takes from the literature",
        }
    ),
}
"""Name -> composite.

The barrier of ``lingstat_joint`` is below the thermal energy of 0.025 eV: it makes the film follow its line and creep less,
and is no measurement of a barrier.
"""

AnyComposite = Annotated[Composite, Named("composite", lambda: LIBRARY)]
"""A composite in a model: the name of a shipped one, or its numbers."""


def named_composite(name: str) -> Composite:
    """A shipped composite.

    Raises
    ------
    UnknownName
        With the nearest name.
    """
    composite: Composite = shipped("composite", name, LIBRARY)
    return composite
