"""The durometer at small depth against Hertz, on the half-space that he means."""

from __future__ import annotations

import pytest
from mutants import assert_kills

from tactsim.analytic.durometer import DurometerScale, hertz_force
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.rod import Rod
from tactsim.experiments.durometer.durometer import Durometer
from tactsim.experiments.indentation.displaced import StepSettings
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.mechanics.models.specimen import Specimen

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


def test_force_follows_hertz(pressed, verification_record):
    """Mutants: the diameter for the radius, Young's modulus for E / (1 - nu^2), a Poisson's ratio of 0.49."""

    def check(radius, modulus):
        force = float(hertz_force(pressed["depth"], radius, modulus))
        assert pressed["spring_force"] == pytest.approx(force, rel=FORCE_TOLERANCE)

    check(RADIUS, MODULUS)
    expected = float(hertz_force(pressed["depth"], RADIUS, MODULUS))
    known = {"reference": "Hertz 1881", "kind": "exact", "mesh": "axisymmetric, finest element 1/250 of the radius"}
    verification_record("durometer, force of the spring", pressed["spring_force"], expected, tolerance=FORCE_TOLERANCE, **known)
    compressible = MODULUS * (1 - 0.5**2) / (1 - 0.49**2)
    assert_kills(
        check, diameter=(2 * RADIUS, MODULUS), youngs_modulus=(RADIUS, 0.75 * MODULUS), poisson_ratio=(RADIUS, compressible)
    )


def test_modulus_by_hertz_is_that_of_the_material(pressed, verification_record):
    """The same error as that of the force; mutants: the modulus E / (1 - nu^2), and the diameter for the radius."""

    def check(modulus):
        assert pressed["hertz_modulus"] == pytest.approx(modulus, rel=FORCE_TOLERANCE)

    check(MODULUS)
    known = {"reference": "Hertz 1881", "kind": "exact", "mesh": "axisymmetric, finest element 1/250 of the radius"}
    verification_record(
        "durometer, modulus of the material", pressed["hertz_modulus"], MODULUS, tolerance=FORCE_TOLERANCE, **known
    )
    assert_kills(check, plane_strain=(MODULUS / (1 - 0.5**2),), diameter=(MODULUS / 2**0.5,))
    assert pressed["reading"] == pytest.approx(pressed["hertz_reading"], abs=100 * FORCE_TOLERANCE)
