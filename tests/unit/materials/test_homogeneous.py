"""Homogeneous states: the closed forms of two-parameter Mooney-Rivlin, and any energy against its stress in space."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
import pytest
from principal_ogden import PrincipalOgden

from tactsim.interfaces import Material
from tactsim.materials.homogeneous import PATHS, diagonal, nominal_stress, principal_invariants
from tactsim.materials.library import LIBRARY
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.materials.stability_range import SCANNED, stability_range

STRETCH = np.array([0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.5, 2.0])


@pytest.mark.parametrize("path", sorted(PATHS))
def test_paths_keep_the_volume_and_start_at_rest(path):
    np.testing.assert_allclose(PATHS[path](STRETCH).prod(axis=0), 1.0, rtol=1e-15)
    np.testing.assert_array_equal(PATHS[path](np.array(1.0)), np.ones(3))


def test_the_second_invariant_of_uniaxial_loading_is_the_corrected_one():
    """E18: I2 = 2 l + l^-2; the printed 2 l + 2 l^-2 is 4 at rest."""
    I1, I2 = principal_invariants(PATHS["uniaxial"](STRETCH))
    np.testing.assert_allclose(I1, STRETCH**2 + 2 / STRETCH, rtol=1e-14)
    np.testing.assert_allclose(I2, 2 * STRETCH + STRETCH**-2, rtol=1e-14)
    assert I2[STRETCH == 1] == 3


def closed_form(path: str, stretch: np.ndarray, c10: float, c01: float) -> np.ndarray:
    """Nominal stress, verification.md 1."""
    cauchy = {
        "uniaxial": 2 * (stretch**2 - 1 / stretch) * (c10 + c01 / stretch),
        "equibiaxial": 2 * (stretch**2 - stretch**-4) * (c10 + c01 * stretch**2),
        "planar": 2 * (stretch**2 - stretch**-2) * (c10 + c01),
    }
    return cauchy[path] / stretch


@pytest.mark.parametrize("path", sorted(PATHS))
def test_two_parameter_closed_forms(path):
    computed = nominal_stress(MooneyRivlin2(c10=1.0, c01=0.25), path, STRETCH)
    np.testing.assert_allclose(computed, closed_form(path, STRETCH, 1.0, 0.25), rtol=1e-13, atol=1e-15)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(computed, closed_form(path, STRETCH, 1.0, 0.25 * (1 + 1e-11)), rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("path", sorted(PATHS))
@pytest.mark.parametrize("name", sorted(LIBRARY))
def test_the_path_is_the_general_stress_with_a_free_third_direction(name, path):
    material = LIBRARY[name].material
    F = np.einsum("i...,ij->ij...", PATHS[path](STRETCH), np.eye(3))
    cofactor = material.volume_change_gradient(F)
    isochoric = material.first_piola_kirchhoff(F, np.zeros_like(STRETCH))
    pressure = -isochoric[2, 2] / cofactor[2, 2]
    expected = (isochoric + pressure * cofactor)[0, 0]
    np.testing.assert_allclose(nominal_stress(material, path, STRETCH), expected, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize(("path", "held"), [("uniaxial", {}), ("equibiaxial", {1: 1.0}), ("planar", {1: 0.0})])
def test_linear_elastic_paths(path, held):
    """The other strains from the stress that vanishes; ``held`` is the strain of direction 2 over that of direction 1."""
    material = LinearElastic(youngs_modulus=1e4, poisson_ratio=0.3)
    stiffness = material.tangent(np.eye(3), np.array(0.0)) + material.bulk_modulus * np.einsum(
        "ij,kl->ijkl", np.eye(3), np.eye(3)
    )
    normal = np.array([[stiffness[i, i, k, k] for k in range(3)] for i in range(3)])
    loaded = np.array([1.0, held.get(1, 0.0), 0.0])
    free = [axis for axis in (1, 2) if axis not in held]
    loaded[free] = np.linalg.solve(normal[np.ix_(free, free)], -(normal @ loaded)[free])
    expected = (normal @ loaded)[0] * 1e-3
    assert nominal_stress(material, path, np.array(1.001)) == pytest.approx(expected, rel=1e-10)  # 1.001 - 1 loses three digits


@pytest.mark.parametrize("path", PATHS)
def test_a_law_of_principal_stretches_has_the_states_of_neo_hooke_at_an_exponent_of_two(path):
    expected = nominal_stress(NeoHookean(c10=500.0), path, STRETCH)
    np.testing.assert_allclose(nominal_stress(PrincipalOgden(modulus=1e3), path, STRETCH), expected, rtol=1e-10)
    other = nominal_stress(PrincipalOgden(modulus=1e3, alpha=3.0), path, STRETCH)
    assert np.abs(other - expected).max() > 0.1 * np.abs(expected).max()


class UserLinear(Material):
    """Linear elasticity as a user would write it, with moduli of its own."""

    kind: Literal["user_linear"] = "user_linear"
    small_strain: ClassVar[bool] = True
    bulk_modulus: float | None
    modulus: float

    @classmethod
    def example(cls) -> Self:
        return cls(modulus=1e3, bulk_modulus=2e3)

    @property
    def shear_modulus(self) -> float:
        return self.modulus

    def first_piola_kirchhoff(self, F, pressure):
        strain = (F + np.swapaxes(F, 0, 1)) / 2 - diagonal(np.ones(F.shape[1:]))
        mean = np.einsum("ii...->...", strain) / 3
        unit = diagonal(np.ones(F.shape[1:]))
        return 2 * self.modulus * (strain - mean * unit) + pressure * unit

    def tangent(self, F, pressure):
        unit, more = np.eye(3), (1,) * (F.ndim - 2)
        one = np.einsum("ik,JL->iJkL", unit, unit) + np.einsum("iL,Jk->iJkL", unit, unit)
        moduli = self.modulus * (one - 2 / 3 * np.einsum("iJ,kL->iJkL", unit, unit))
        return np.broadcast_to(moduli.reshape(*moduli.shape, *more), (3, 3, 3, 3, *F.shape[2:]))

    def volume_change(self, F):
        return np.einsum("ii...->...", F) - 3

    def volume_change_gradient(self, F):
        return diagonal(np.ones(F.shape[1:]))


@pytest.mark.parametrize("bulk_modulus", [2e3, None])
def test_a_users_law_of_small_strain_keeps_its_poissons_ratio_and_is_stable(bulk_modulus):
    own = UserLinear(modulus=1e3, bulk_modulus=bulk_modulus)
    nu = 0.5 if bulk_modulus is None else (3 * 2e3 - 2 * 1e3) / (6 * 2e3 + 2 * 1e3)
    young, strain = 2e3 * (1 + nu), np.array([-0.2, 0.0, 0.1, 0.5])
    for path, stiffening in (("uniaxial", 1.0), ("equibiaxial", 1 / (1 - nu)), ("planar", 1 / (1 - nu**2))):
        np.testing.assert_allclose(nominal_stress(own, path, 1 + strain), young * stiffening * strain, rtol=1e-12, atol=1e-9)
    report = stability_range(own)
    assert all((path.elliptic, path.drucker) == (SCANNED, SCANNED) for path in report.paths.values())
    assert report.strongly_elliptic
