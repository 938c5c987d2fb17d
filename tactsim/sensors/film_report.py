"""What a result tells of the film it used."""

from __future__ import annotations

from tactsim.results.result import Quantity
from tactsim.sensors.film import Film
from tactsim.sensors.tunnelling import particle_separation, tunnelling_decay
from tactsim.units import format_quantity


def film_quantities(film: Film) -> dict[str, Quantity]:
    """Derived numbers of the film."""
    composite = film.composite
    separation = particle_separation(composite.particle_diameter, composite.volume_fraction)
    return {
        "tunnelling_decay": Quantity(tunnelling_decay(composite.barrier), "1/m", "gamma of eq. 2.1.4"),
        "particle_separation": Quantity(separation, "m", "s0 of eq. 2.1.8"),
        "resistance_exponent": Quantity(composite.exponent, "1", "gamma s0: fall of the resistance with strain"),
        "initial_resistance": Quantity(
            composite.initial_resistance * film.magnification, "ohm", "R0 of the unstrained film of this area"
        ),
        "contact_resistance": Quantity(composite.contact_resistance, "ohm", "of both contacts at 1 N"),
    }


def film_assumptions(film: Film) -> tuple[str, ...]:
    """What is assumed of the film."""
    composite = film.composite
    assumptions = [
        f"film: {composite.source}",
        "creep with coefficients that follow the force (errata E29), which gives eq. 2.3.1 under a constant force",
        f"the coefficients of creep depend on the pressure; they were measured on {composite.reference_area * 1e6:.4g} mm²",
    ]
    if film.magnification != 1:
        assumptions.append(
            "the unstrained resistance is inverse to the active area, the contact resistance depends on the force alone"
        )
    return tuple(assumptions)


def film_warnings(film: Film, largest: float) -> tuple[str, ...]:
    """What goes beyond the measurements when forces reach ``largest`` newton."""
    if largest <= film.largest_force * (1 + 1e-9):
        return ()
    reached, measured = format_quantity(largest, "N"), format_quantity(film.largest_force, "N")
    return (f"the force reaches {reached} on the film; its creep was measured up to {measured}, beyond that lines are prolonged",)
