"""Numbers of a composite against the digits of the errata."""

import numpy as np
import pytest
from scipy import constants

from tactsim.errors import InvalidQuantity
from tactsim.sensors.films.tunnelling import (
    contact_coefficient,
    particle_separation,
    relative_resistance,
    tunnelling_decay,
    volume_fraction,
)

ELECTRON_VOLT = 1.602176634e-19
MILLIGRAM = 1e-6
PARTS = {
    "filler_mass": 4.2083 * MILLIGRAM,
    "filler_density": 560.0,
    "matrix_mass": 16.9496 * MILLIGRAM,
    "matrix_density": 910.0,
}


def test_volume_fraction_from_the_residue():
    assert volume_fraction(**PARTS) == pytest.approx(0.28747, abs=1e-5)  # five digits are given
    assert volume_fraction(**PARTS | {"filler_density": 1800.0}) == pytest.approx(0.112, abs=5e-4)
    rounded = {"filler_mass": 4.2 * MILLIGRAM, "matrix_mass": 16.926 * MILLIGRAM}  # 0.0075 and 0.0186 cm^3, as in the thesis
    assert volume_fraction(**PARTS | rounded) == pytest.approx(0.2873, abs=6e-5)


def test_separation_decay_and_their_product():
    separation, decay = particle_separation(500e-9, 0.2873), tunnelling_decay(0.05 * ELECTRON_VOLT)
    assert separation == pytest.approx(110.74e-9, abs=0.005e-9)
    assert decay == pytest.approx(2.29115e9, abs=5e3)
    assert separation * decay == pytest.approx(253.73, abs=5e-3)
    assert particle_separation(500e-9, 0.2874753) * decay == pytest.approx(253.44, abs=5e-3)
    assert particle_separation(500e-9, 0.28) * decay != pytest.approx(253.73, abs=1.0)


def test_particles_touch_in_a_simple_cubic_packing():
    assert particle_separation(1.0, np.pi / 6 - 1e-12) == pytest.approx(0, abs=1e-11)


def junction_resistance(separation, area, decay):
    """Tunnelling resistance in ohm between two particles: eq. 2.1.3 with the Planck constant that is missing in its numerator."""
    scale = 8 * np.pi * constants.h * separation / (3 * area * decay * constants.e**2)
    return scale * np.exp(decay * separation)


def test_relative_resistance_is_the_ratio_of_junction_resistances():
    separation, decay, area, strain = 110e-9, 2.3e9, 1e-14, 0.013
    ratio = junction_resistance(separation * (1 - strain), area, decay) / junction_resistance(separation, area, decay)
    assert relative_resistance(strain, decay * separation) == pytest.approx(ratio, rel=1e-12)


def test_contact_of_table_2_1():
    assert contact_coefficient((5.0, 0.0), 52e6) == pytest.approx(32e3, rel=2e-3)
    assert contact_coefficient((5.0, 0.0), 52e6) / 5 == pytest.approx(6.4e3, rel=2e-3)


@pytest.mark.parametrize(
    "call",
    [
        lambda: tunnelling_decay(0.0),
        lambda: particle_separation(1e-9, 0.6),
        lambda: particle_separation(0.0, 0.3),
        lambda: volume_fraction(**PARTS | {"filler_mass": 0.0}),
        lambda: contact_coefficient((0.0, 0.0), 1.0),
    ],
)
def test_values_without_sense_are_refused(call):
    with pytest.raises(InvalidQuantity, match="allowed"):
        call()
