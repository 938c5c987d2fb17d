"""Every registered material, from its example: energy, stress and tangent agree, objectivity, rest, symmetry, round trip."""

from __future__ import annotations

import json
from typing import Literal, Self

import numpy as np
import pytest
from pydantic import TypeAdapter
from scipy.spatial.transform import Rotation

from tactsim.errors import AmbiguousKind, InputError
from tactsim.interfaces import Material
from tactsim.materials.any_material import AnyMaterial
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.specimen import Specimen
from tactsim.registry import forget, kinds

KINDS = kinds(Material)
HYPERELASTIC = sorted(kind for kind, cls in KINDS.items() if issubclass(cls, Hyperelastic))
ROUND_OFF = 1e-12
"""Of stress and tangent over their size: complex steps have no truncation, a few dozen operations lose a few digits."""
STEP = 1e-30
POINTS = 40

every_kind = pytest.mark.parametrize("kind", sorted(KINDS))


def deformations() -> np.ndarray:
    """Random deformation gradients (3, 3, POINTS) with positive volume, strains up to about a half."""
    generator = np.random.default_rng(11)
    F = np.eye(3)[:, :, None] + 0.2 * generator.normal(size=(3, 3, 4 * POINTS))
    return F[:, :, np.linalg.det(np.moveaxis(F, 2, 0)) > 0.2][:, :, :POINTS]


def pressures(material: Material) -> np.ndarray:
    """Random pressures in Pa of the size of the shear modulus."""
    return material.shear_modulus * np.random.default_rng(12).normal(size=POINTS)


def rotations() -> np.ndarray:
    """Random rotations (3, 3, POINTS)."""
    return np.moveaxis(Rotation.random(POINTS, random_state=13).as_matrix(), 0, 2)


def product(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    return np.einsum("ij...,jk...->ik...", A, B)


def gradient(function, F: np.ndarray) -> np.ndarray:
    """Derivative of a function by F, by complex steps: components of F last but the points."""
    columns = []
    for i in range(3):
        for J in range(3):
            stepped = F.astype(complex)
            stepped[i, J] += 1j * STEP
            columns.append(np.imag(function(stepped)) / STEP)
    derivative = np.stack(columns, axis=-2)
    return derivative.reshape(*derivative.shape[:-2], 3, 3, POINTS)


def mixed_energy(material: Material, F: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """W + p (volume change) in J/m^3: the stored energy without its volume part."""
    volume_change = material.volume_change(F)
    bulk_part = 0.0 if material.bulk_modulus is None else material.bulk_modulus / 2 * volume_change**2
    return material.stored_energy(F) - bulk_part + pressure * volume_change


def assert_equal_to(computed: np.ndarray, expected: np.ndarray, scale: float, tolerance: float = ROUND_OFF) -> None:
    assert computed.shape == expected.shape
    assert np.abs(computed - expected).max() <= tolerance * max(scale, np.abs(expected).max())


@every_kind
def test_stress_is_the_derivative_of_the_energy(kind):
    material, F = KINDS[kind].example(), deformations()
    pressure = pressures(material)
    # The volume part is taken off again, so its size counts in the round-off.
    scale = material.shear_modulus + (material.bulk_modulus or 0.0)
    expected = gradient(lambda F: mixed_energy(material, F, pressure), F)
    stress = material.first_piola_kirchhoff(F, pressure)
    assert_equal_to(stress, expected, scale)
    with pytest.raises(AssertionError):
        assert_equal_to(material.first_piola_kirchhoff(F, pressure * 1.001), expected, scale)


@every_kind
def test_tangent_is_the_derivative_of_the_stress(kind):
    material, F = KINDS[kind].example(), deformations()
    pressure = pressures(material)
    expected = gradient(lambda F: material.first_piola_kirchhoff(F, pressure), F)
    tangent = material.tangent(F, pressure)
    assert_equal_to(tangent, expected, material.shear_modulus)
    with pytest.raises(AssertionError):
        assert_equal_to(_altered(material).tangent(F, pressure), expected, material.shear_modulus)


@every_kind
def test_tangent_has_the_symmetry_of_a_second_derivative(kind):
    material, F = KINDS[kind].example(), deformations()
    pressure = pressures(material)
    tangent = material.tangent(F, pressure)
    assert_equal_to(tangent, tangent.transpose(2, 3, 0, 1, 4), material.shear_modulus)
    without_potential = tangent + np.einsum("iJn,kLn->iJkLn", material.first_piola_kirchhoff(F, pressure), F)
    with pytest.raises(AssertionError):
        assert_equal_to(without_potential, without_potential.transpose(2, 3, 0, 1, 4), material.shear_modulus)


@every_kind
def test_volume_change_and_its_gradient_agree(kind):
    material, F = KINDS[kind].example(), deformations()
    expected = gradient(material.volume_change, F)
    assert_equal_to(material.volume_change_gradient(F), expected, 1.0)


@every_kind
def test_rest_state_is_free_of_stress_and_has_the_shear_modulus(kind):
    material = KINDS[kind].example()
    G, rest, none = material.shear_modulus, np.eye(3)[:, :, None], np.zeros(1)
    assert_equal_to(material.first_piola_kirchhoff(rest, none), np.zeros((3, 3, 1)), G)
    assert_equal_to(material.stored_energy(rest), none, G)
    assert_equal_to(material.volume_change(rest), none, 1.0)
    assert_equal_to(material.tangent(rest, none)[0, 1, 0, 1], np.array([G]), G)
    with pytest.raises(AssertionError):
        assert_equal_to(material.first_piola_kirchhoff(rest * [[[1], [1 + 1e-9], [1]]], none), np.zeros((3, 3, 1)), G)


@every_kind
def test_a_small_rotation_costs_nothing_to_first_order(kind):
    material = KINDS[kind].example()
    turned = np.eye(3)[:, :, None] + 1e-7 * np.cross(np.eye(3), [1.0, -2.0, 3.0])[:, :, None]
    stress = material.first_piola_kirchhoff(turned, np.zeros(1))
    assert np.abs(stress).max() <= 1e-11 * material.shear_modulus  # second order: 1e-14 times a few dozens
    stretched = material.first_piola_kirchhoff((turned + np.swapaxes(turned, 0, 1)) / 2 + 1e-7 * np.ones((3, 3, 1)), np.zeros(1))
    assert np.abs(stretched).max() > 1e-11 * material.shear_modulus


def rotated_and_turned_stress(material: Material) -> tuple[np.ndarray, np.ndarray]:
    """P(Q F R) and Q P(F) R: equal for an objective and isotropic material."""
    F, Q, R = deformations(), rotations(), rotations()[:, :, ::-1]
    pressure = pressures(material)
    P = material.first_piola_kirchhoff(F, pressure)
    return material.first_piola_kirchhoff(product(product(Q, F), R), pressure), product(product(Q, P), R)


@pytest.mark.parametrize("kind", HYPERELASTIC)
def test_the_observer_and_the_orientation_do_not_matter(kind):
    material = KINDS[kind].example()
    assert_equal_to(*rotated_and_turned_stress(material), material.shear_modulus)
    turned = product(rotations(), deformations())
    assert_equal_to(material.stored_energy(turned), material.stored_energy(deformations()), material.shear_modulus)


def test_linear_elasticity_is_seen_not_to_be_objective():
    """Mutant of the test above."""
    material = KINDS["linear_elastic"].example()
    with pytest.raises(AssertionError):
        assert_equal_to(*rotated_and_turned_stress(material), material.shear_modulus)


@pytest.mark.parametrize("bulk", [None, 2e6])
@pytest.mark.parametrize("kind", HYPERELASTIC)
def test_pressure_is_the_bulk_modulus_times_the_volume_change(kind, bulk):
    example = KINDS[kind].example()
    material = type(example).model_validate(example.model_dump() | {"bulk_modulus": bulk})
    F = deformations()
    pressure = np.zeros(POINTS) if bulk is None else bulk * material.volume_change(F)
    stress = material.first_piola_kirchhoff(F, pressure)
    assert_equal_to(stress, gradient(material.stored_energy, F), material.shear_modulus)


@every_kind
def test_isochoric_stress_has_no_mean_part(kind):
    material, F = KINDS[kind].example(), deformations()
    pressure = pressures(material)
    cauchy = product(material.first_piola_kirchhoff(F, pressure), F.swapaxes(0, 1)) / (1 + material.volume_change(F))
    if isinstance(material, Hyperelastic):
        assert_equal_to(np.einsum("ii...->...", cauchy) / 3, pressure, np.abs(cauchy).max())
    else:
        mean = np.einsum("ii...->...", material.first_piola_kirchhoff(F, pressure)) / 3
        assert_equal_to(mean, pressure, material.shear_modulus)


@every_kind
def test_trailing_shape_is_kept(kind):
    material, F = KINDS[kind].example(), deformations()
    pressure = pressures(material)
    folded, folded_pressure = F.reshape(3, 3, 4, POINTS // 4), pressure.reshape(4, -1)
    for method in (material.first_piola_kirchhoff, material.tangent):
        np.testing.assert_array_equal(
            method(folded, folded_pressure), method(F, pressure).reshape(method(folded, folded_pressure).shape)
        )
        one = method(F[:, :, 0], pressure[0])
        np.testing.assert_allclose(one, method(F, pressure)[..., 0], rtol=1e-12, atol=1e-12 * material.shear_modulus)
    assert material.volume_change(folded).shape == (4, POINTS // 4)
    assert material.volume_change_gradient(folded).shape == folded.shape


@every_kind
def test_json_round_trip(kind):
    material, adapter = KINDS[kind].example(), TypeAdapter(AnyMaterial)
    text = adapter.dump_json(material)
    assert adapter.validate_json(text) == material
    assert json.loads(text)["kind"] == kind
    assert adapter.validate_python(material.model_dump()) == material
    assert _altered(material) != material


def _altered(material: Material) -> Material:
    """With its first constant a thousandth larger, every one of them if they come in a mapping."""
    constants = material.model_dump()
    name = next(name for name, value in constants.items() if name != "kind" and value is not None)
    value = constants[name]
    changed = {key: x * 1.001 for key, x in value.items()} if isinstance(value, dict) else value * 1.001
    return type(material).model_validate(constants | {name: changed})


@every_kind
def test_constants_are_closed_finite_and_immutable(kind):
    material = KINDS[kind].example()
    constants = material.model_dump()
    for wrong in ({"colour": 1.0}, {"kind": "another"}):
        with pytest.raises(ValueError, match=r"colour|another"):
            type(material).model_validate(constants | wrong)
    with pytest.raises(InputError, match="cannot be changed"):
        material.kind = "another"


def test_a_new_kind_needs_no_list():
    """A class that is defined anywhere is a kind of case files and of these tests, as long as it is registered."""

    class Gum(NeoHookean):
        kind: Literal["gum"] = "gum"

    gum = TypeAdapter(AnyMaterial).validate_python({"kind": "gum", "c10": "3 kPa"}, context={"units": "required"})
    assert gum.shear_modulus == pytest.approx(6e3, rel=1e-12)
    assert set(kinds(Material)) == {*KINDS, "gum"}
    forget(Gum)
    assert set(kinds(Material)) == {*KINDS}


def test_two_classes_of_one_kind_are_refused_with_both_modules():
    with pytest.raises(AmbiguousKind, match=r"tactsim\.materials\.neo_hookean\.NeoHookean and .*test_materials.*Second"):

        class Second(NeoHookean):
            kind: Literal["neo_hookean"] = "neo_hookean"

    assert kinds(Material)["neo_hookean"] is NeoHookean


def test_a_law_with_the_kind_of_another_one_is_refused_in_a_case():
    """It was computed, and written as the law whose kind it has."""

    class Doubled(NeoHookean):
        def energy(self, I1, I2):
            return 2 * super().energy(I1, I2)

        def energy_gradient(self, I1, I2):
            return tuple(2 * one for one in super().energy_gradient(I1, I2))

        def energy_hessian(self, I1, I2):
            return tuple(2 * one for one in super().energy_hessian(I1, I2))

    words = "Doubled has the kind 'neo_hookean' of NeoHookean, .*; needed: kind: Literal.'doubled'. = 'doubled'"
    with pytest.raises(InputError, match=words):
        Specimen(material=Doubled(c10=2e3), thickness=10e-3, radius=15e-3)
    assert Specimen(material=NeoHookean(c10=2e3), thickness=10e-3, radius=15e-3).material.shear_modulus == 4e3


def test_a_wrong_energy_is_seen():
    """Mutant: an energy that its gradient does not belong to."""

    class Wrong(NeoHookean):
        def energy(self, I1, I2):
            return super().energy(I1, I2) * 1.001

        @classmethod
        def example(cls) -> Self:
            return cls(c10=1e3)

    material, F = Wrong.example(), deformations()
    zero = np.zeros(POINTS)
    with pytest.raises(AssertionError):
        assert_equal_to(material.first_piola_kirchhoff(F, zero), gradient(material.stored_energy, F), material.shear_modulus)
