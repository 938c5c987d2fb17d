"""Elastomers as they were measured by durometer, hand and sensor, and the shapes of energy they are simulated with."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from tactsim.materials import AnyMaterial
from tactsim.materials.library import named_material
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.model import FrozenModel
from tactsim.units import Positive, Pressure

Reading = Annotated[float, Field(ge=0, lt=100)]


class Elastomer(FrozenModel):
    """One material and what three tests say of it."""

    name: Annotated[str, Field(min_length=1, max_length=20)]
    """Its name."""
    durometer: Reading
    """Shore reading."""
    hand: float
    """Rank by hand, larger for harder."""
    threshold_pressure: Positive[Pressure]
    """Threshold pressure of the annular sensor."""


class Shape(FrozenModel):
    """An energy of which only the shape counts: it is scaled to the modulus of each elastomer."""

    name: Annotated[str, Field(min_length=1, max_length=30)]
    """Name in the result."""
    material: AnyMaterial
    """The energy; incompressible and without relaxation."""
    constants_of: str | None = None
    """Elastomer whose measured constants these are, if any."""


def _table_3_3() -> tuple[Elastomer, ...]:
    names = ("H1-N", "B1", "EVA", "B1-A", "A2FR", "A2", "ICF")
    readings = (48, 45, 42, 36, 13, 4, 1)
    hands = (7, 6, 5, 4, 3, 2, 1)
    pressures = (89.8e3, 52.0e3, 39.3e3, 22.3e3, 2.8e3, 0.9e3, 0.4e3)
    return tuple(
        Elastomer(name=name, durometer=reading, hand=hand, threshold_pressure=pressure)
        for name, reading, hand, pressure in zip(names, readings, hands, pressures, strict=True)
    )


TABLE_3_3 = _table_3_3()
"""The seven elastomers of thesis Table 3.3, the hardest first."""

STABLE_SHAPES = (
    Shape(name="B1-A stable", material=named_material("b1a_stable").material, constants_of="B1-A"),
    Shape(name="ICF stable", material=named_material("icf_stable").material, constants_of="ICF"),
    Shape(name="neo-Hookean", material=NeoHookean(c10=10e3 / 6)),
)
"""The stable sets of Table 3.1, and a neo-Hookean energy with E = 10 kPa, whose modulus cancels."""
