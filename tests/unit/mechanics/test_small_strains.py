"""A law of small strains is warned of where gradients are large, whoever wrote it: by what the interface of a material has."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from tactsim.interfaces import Material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.mechanics.outcome.small_strains import SmallStrains

LAW = LinearElastic(youngs_modulus=1e3, poisson_ratio=0.3)
ASKED = ("bulk_modulus", "small_strain", *sorted(Material.__abstractmethods__ - {"example"}))


def observed(material: object, scale: float) -> tuple[SmallStrains, np.ndarray, np.ndarray]:
    """Random gradients (3, 3, 4, 2) of this size and weights of their points, observed."""
    generator = np.random.default_rng(2)
    F = np.eye(3)[:, :, None, None] + scale * generator.normal(size=(3, 3, 4, 2))
    points = SimpleNamespace(weights=generator.uniform(1.0, 2.0, (4, 2)))
    strains = SmallStrains()
    strains.observe(SimpleNamespace(materials=(material,), regions=np.zeros(4, int), points=points), SimpleNamespace(F=F))
    return strains, F, points.weights


@pytest.mark.parametrize(("scale", "warned"), [(0.3, True), (1e-3, False)])
def test_a_users_law_that_states_no_energy_is_warned_of(scale: float, warned: bool) -> None:
    own = SimpleNamespace(kind="my_law", **{name: getattr(LAW, name) for name in ASKED})
    strains, _, _ = observed(own, scale)
    assert [warning.startswith("my_law is a law of small strains") for warning in strains.warnings()] == [True] * warned


def test_gradients_weigh_with_the_energy() -> None:
    strains, F, weights = observed(LAW, 0.3)
    energy = weights * LAW.stored_energy(F)
    size = np.linalg.norm(F - np.eye(3)[:, :, None, None], axis=(0, 1))
    assert strains.largest == pytest.approx((energy * size).sum() / energy.sum(), rel=1e-12)
