"""What Newton starts a grasp from: tissue that is compressed evenly, around lumps that are not.

Mutant: a lump that is compressed with the tissue, as it was.
"""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models import first_guess
from tactsim.mechanics.models.first_guess import compressed
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_block
from tactsim.mesh.inclusions.ellipsoid import Ellipsoid
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.quadratic import QuadraticMesh

pytestmark = pytest.mark.usefixtures("one_thread")
SIZE, CLOSING = (40e-3, 40e-3, 20e-3), 0.6e-3
SETTINGS = BlockMeshSettings(size=10e-3, inclusion_size=4e-3, edge_size=3.2e-3, growth=1)
TISSUE = NeoHookean(c10=1.78e3)
BALL = Sphere(center=(12e-3, 26e-3, 8e-3), radius=3.5e-3)


def block_with(inclusion: Sphere | Ellipsoid | Tube | None, contrast: float) -> tuple[QuadraticMesh, Body]:
    mesh = graded_block(SIZE, () if inclusion is None else (inclusion,), SETTINGS).mesh
    lump = NeoHookean(c10=contrast * TISSUE.c10)
    materials = [TISSUE, *[lump] * int(mesh.regions.max())]
    return mesh, Body(TaylorHood(mesh.nodes, mesh.elements, "solid", mesh.regions), materials, mesh.regions)


def volume_ratios(body: Body, displacement: np.ndarray) -> np.ndarray:
    unknowns = np.zeros(body.space.size)
    body.space.split(unknowns)[0][:] = displacement
    return body.kinematics(unknowns).J


def test_plain_tissue_keeps_its_volume_and_closes_as_told() -> None:
    mesh, body = block_with(None, 1.0)
    displacement = compressed(mesh, body.shear_moduli, CLOSING)
    assert volume_ratios(body, displacement) == pytest.approx(1.0, rel=1e-12)
    for face, moved in ((0.0, CLOSING), (SIZE[2], -CLOSING)):
        assert displacement[mesh.nodes[:, 2] == face, 2] == pytest.approx(moved, rel=1e-12)


@pytest.mark.parametrize("contrast", [0.1, 1.0, 60.0])
@pytest.mark.parametrize(
    "inclusion", [BALL, Ellipsoid(center=(20e-3, 20e-3, 10e-3), semi_axes=(5e-3, 4e-3, 4e-3))], ids=["ball", "ellipsoid"]
)
def test_a_lump_is_strained_as_a_ball_of_its_stiffness_is(inclusion: Sphere | Ellipsoid, contrast: float) -> None:
    mesh, body = block_with(inclusion, contrast)
    displacement = compressed(mesh, body.shear_moduli, CLOSING)
    plain = compressed(mesh, np.ones(len(mesh.elements)), CLOSING)
    nodes = np.unique(mesh.elements[mesh.regions == 1])

    def strain(values: np.ndarray) -> float:
        slope, *_ = np.linalg.lstsq(np.column_stack([mesh.nodes[nodes], np.ones(len(nodes))]), values[nodes], rcond=None)
        return float(slope[2, 2])

    assert strain(displacement) == pytest.approx(5 / (2 * contrast + 3) * strain(plain), abs=0.02 * abs(strain(plain))), (
        "a finite compression at constant volume has a little even growth, which the lump keeps"
    )
    ratios = volume_ratios(body, displacement)
    assert (ratios.min(), ratios.max()) == pytest.approx((1.0, 1.0), abs=0.15), "cells at its surface are straight between nodes"


def test_a_tube_is_no_ball() -> None:
    mesh, body = block_with(Tube(centre_line=[(0.0, 20e-3, 10e-3), (40e-3, 20e-3, 10e-3)], inner_radius=2e-3, wall=1e-3), 60.0)
    plain = compressed(mesh, np.ones(len(mesh.elements)), CLOSING)
    assert np.array_equal(compressed(mesh, body.shear_moduli, CLOSING), plain)


@pytest.mark.parametrize("mutant", [False, True], ids=["ball", "compressed with the tissue"])
def test_a_stiff_lump_does_not_turn_over_by_itself(mutant: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Turning it in the tissue costs work. The mutant's turns over like a column beyond Euler's load."""
    if mutant:
        monkeypatch.setattr(first_guess, "displacement_by_ball", lambda places, *_: np.zeros_like(places))
    mesh, body = block_with(BALL, 150.0)
    unknowns = np.zeros(body.space.size)
    body.space.split(unknowns)[0][:] = compressed(mesh, body.shear_moduli, CLOSING)
    tangent = body.pattern.matrix(body.tangent(unknowns, body.kinematics(unknowns)))
    away = mesh.nodes - BALL.center
    near = np.minimum(1.0, BALL.radius / np.maximum(np.linalg.norm(away, axis=1), BALL.radius))
    turned = np.zeros(body.space.size)
    body.space.split(turned)[0][:] = np.cross([1.0, 0.0, 0.0], away) * near[:, None] ** 3  # of a ball in creeping flow
    work = float(turned @ (tangent @ turned))
    rest = 8 * np.pi * body.shear_moduli[0] * BALL.radius**3
    assert (work < 0) if mutant else (work == pytest.approx(rest, rel=0.1))
