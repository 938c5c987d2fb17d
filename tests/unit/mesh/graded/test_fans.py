"""Lumps filled by a fan of tetrahedra about their middle."""

from __future__ import annotations

import numpy as np
import pytest
from lumps import assert_sound, same_mirrored

from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_block
from tactsim.mesh.inclusions.ellipsoid import Ellipsoid
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.tetrahedra import mesh_key

SIZE = (40e-3, 40e-3, 20e-3)
CELLS = BlockMeshSettings(size=10e-3, inclusion_size=4e-3, edge_size=3.2e-3, growth=1.0)
FAN = CELLS.model_copy(update={"filling": "fan"})
FAR = Sphere(center=(18e-3, 22e-3, 10e-3), radius=5e-3)
CLOSE = Sphere(center=(18e-3, 22e-3, 13e-3), radius=5e-3)
LUMPS = {
    "one": [FAR],
    "close to a jaw": [CLOSE],
    "turned": [Ellipsoid(center=(18e-3, 21e-3, 9e-3), semi_axes=(6e-3, 4e-3, 3e-3), rotation=(0.3, 0.2, 0.7))],
    "two": [Sphere(center=(11e-3, 18e-3, 9e-3), radius=4e-3), Sphere(center=(28e-3, 24e-3, 11e-3), radius=3e-3)],
    "beside a tube": [
        Sphere(center=(12e-3, 20e-3, 10e-3), radius=4e-3),
        Tube(centre_line=((28e-3, 0.0, 10e-3), (28e-3, 40e-3, 10e-3)), inner_radius=2e-3, wall=1e-3),
    ],
}


@pytest.mark.parametrize("lumps", LUMPS.values(), ids=LUMPS)
def test_a_fan_has_one_corner_of_its_own_in_the_middle_of_the_lump(lumps):
    cells, fan = (graded_block(SIZE, lumps, settings) for settings in (CELLS, FAN))
    assert_sound(fan)
    assert fan.unknowns < 0.93 * cells.unknowns
    inside = fan.mesh.elements[fan.mesh.regions == 1, :4]
    others = np.setdiff1d(inside, fan.mesh.elements[fan.mesh.regions != 1, :4])
    np.testing.assert_allclose(fan.mesh.nodes[others], [lumps[0].center], atol=1e-12)
    assert (inside == others).any(axis=1).all()


def test_a_fan_mirrors_as_its_block_does():
    middle = Sphere(center=(20e-3, 20e-3, 10e-3), radius=5e-3)
    even = FAN.model_copy(update={"inclusion_size": 2e-3})
    assert all(same_mirrored(graded_block(SIZE, [middle], even).mesh, axis) for axis in range(3))


def test_only_a_fan_changes_the_key_of_a_mesh():
    assert mesh_key(SIZE, [FAR], CELLS) != mesh_key(SIZE, [FAR], FAN)
    assert mesh_key(SIZE, [FAR], CELLS) == mesh_key(SIZE, [FAR], Before(CELLS.model_dump(exclude={"filling"})))


class Before:
    """Settings of before there was a choice of filling."""

    def __init__(self, usual):
        self._usual = usual

    def model_dump(self, exclude):
        return {name: value for name, value in self._usual.items() if name not in exclude}
