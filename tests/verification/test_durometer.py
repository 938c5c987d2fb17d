"""The durometer at small depth against Hertz, on the half-space that he means."""

from __future__ import annotations

import pytest

from tactsim.analytic.durometer import DurometerScale, hertz_force
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.rod import Rod
from tactsim.experiments.durometer.durometer import Durometer
from tactsim.experiments.indentation.displaced import StepSettings
from tactsim.experiments.indentation.setup import MeshSettings
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.mechanics.specimen import Specimen

RADIUS = 1.19e-3
DEPTH = 1e-3 * RADIUS
MODULUS = 135e3
HALF_SPACE = 3000 * RADIUS
"""A bonded cylinder of this radius and height is stiffer than the half-space by far less than the tolerance."""
FORCE_TOLERANCE = 0.003
"""Asked of the force; the contact is 8 elements wide, and Hertz is right to the order of DEPTH / RADIUS."""


@pytest.fixture(scope="module")
def pressed():
    """A spring that by Hertz balances at half its travel."""
    force = float(hertz_force(DEPTH, RADIUS, MODULUS))
    scale = DurometerScale(travel=2 * DEPTH, force_at_zero=force / 2, force_per_unit=force / 100)
    material = LinearElastic(youngs_modulus=MODULUS, poisson_ratio=0.5)
    result = Durometer(
        specimen=Specimen(material=material, thickness=HALF_SPACE, radius=HALF_SPACE),
        indentor=Rod(radius=RADIUS),
        contact=Coulomb(friction=0.0),
        scale=scale,
        penetration_tolerance=1e-2 * DEPTH,
        mesh=MeshSettings(finest=4e-3 * RADIUS, growth=0.5, adaptive=False),
        steps=StepSettings(first=DEPTH / 2, largest=DEPTH / 2),
    ).run()
    assert result.status == "converged", result.reason
    return {name: quantity.value for name, quantity in result.quantities.items()}


def test_force_follows_hertz(pressed):
    force = float(hertz_force(pressed["depth"], RADIUS, MODULUS))
    assert pressed["spring_force"] == pytest.approx(force, rel=FORCE_TOLERANCE)
    assert pressed["spring_force"] != pytest.approx(force * (1 + 3 * FORCE_TOLERANCE), rel=FORCE_TOLERANCE)


def test_modulus_by_hertz_is_that_of_the_material(pressed):
    """The same error as that of the force."""
    assert pressed["hertz_modulus"] == pytest.approx(MODULUS, rel=FORCE_TOLERANCE)
    assert pressed["hertz_modulus"] != pytest.approx(MODULUS * (1 + 3 * FORCE_TOLERANCE), rel=FORCE_TOLERANCE)
    assert pressed["reading"] == pytest.approx(pressed["hertz_reading"], abs=100 * FORCE_TOLERANCE)
