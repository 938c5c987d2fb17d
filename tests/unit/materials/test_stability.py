"""Strong ellipticity against the acoustic form minimised by brute force, the windows of the printed constants, Drucker."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from principal_ogden import PrincipalOgden
from scipy.spatial.transform import Rotation

from tactsim.interfaces import Material
from tactsim.materials import stability_range as stability_range_module
from tactsim.materials.homogeneous import PATHS, diagonal, principal_invariants
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.library import named_material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.materials.polynomial import Polynomial
from tactsim.materials.sampled_stability import sampled_drucker_margin, sampled_ellipticity_margin
from tactsim.materials.stability import (
    EnergyDerivatives,
    convex_in_invariants,
    drucker_margin,
    ellipticity_margin,
    principal_stretches,
    shear_conditions,
    strongly_elliptic,
)
from tactsim.materials.stability_range import around_rest, lost_intervals, stability_range
from tactsim.registry import kinds

PRINTED = ("b1a_printed", "icf_printed")
STABLE = ("b1a_stable", "icf_stable")
DIRECTIONS = 4000


def isochoric(first: float, second: float, seed: int) -> np.ndarray:
    """A deformation gradient (3, 3) of volume one with two given logarithmic stretches, between random rotations."""
    left, right = Rotation.random(2, random_state=seed).as_matrix()
    return left @ np.diag(np.exp([first, second, -first - second])) @ right


def smallest_acoustic_form(material, F: np.ndarray, seed: int) -> float:
    """Smallest m_i n_J A_iJkL m_k n_L in Pa over m normal to F^-T n, both of unit length in the deformed state.

    A is the tangent of the full energy at the pressure zero; the pressure adds nothing for such m and n. Random directions, then
    descent from the best by shrinking random steps.
    """
    tangent = material.tangent(F, np.zeros(()))
    spatial = np.einsum("iJkL,jJ,lL->ijkl", tangent, F, F).reshape(9, 9)  # per deformed directions, J = 1
    generator = np.random.default_rng(seed)

    def form(n, m):
        n = n / np.linalg.norm(n, axis=0)
        m = m - n * np.einsum("in,in->n", n, m)
        m = m / np.linalg.norm(m, axis=0)
        pairs = np.einsum("in,jn->ijn", m, n).reshape(9, -1)
        return (pairs * (spatial @ pairs)).sum(axis=0), n, m

    values, n, m = form(*generator.normal(size=(2, 3, DIRECTIONS)))
    for width in np.geomspace(0.3, 1e-4, 12):
        best = np.argsort(values)[:1]
        steps = width * generator.normal(size=(2, 3, 400))
        steps[:, :, 0] = 0
        values, n, m = form(n[:, best] + steps[0], m[:, best] + steps[1])
    return float(values.min())


def random_polynomial(seed: int) -> Polynomial:
    """Second-order energy with signs that may lose strong ellipticity, G = 2 Pa."""
    c10, c20, c11, c02 = np.random.default_rng(seed).uniform(-1, 1, 4)
    return Polynomial(coefficients={"c10": 0.5 + c10, "c01": 0.5 - c10, "c20": c20, "c11": c11, "c02": c02})


logarithms = st.floats(-0.5, 0.5)


@pytest.mark.slow
@settings(derandomize=True, max_examples=150, deadline=None)
@given(logarithms, logarithms, st.integers(0, 10**6))
def test_the_conditions_are_those_of_the_acoustic_form(first, second, seed):
    """As quickly below, of other states. The smallest value found decides; where it is nearer to zero than the search
    resolves, nothing is asserted."""
    material, F = random_polynomial(seed), isochoric(first, second, seed)
    smallest = smallest_acoustic_form(material, F, seed)
    size = np.abs(material.tangent(F, np.zeros(()))).max()
    if abs(smallest) > 1e-5 * size:
        assert bool(strongly_elliptic(material, F)) == (smallest > 0)


def test_both_verdicts_occur_and_another_condition_is_seen():
    """Twin: Drucker's condition is another one, and is distinguished by the same states."""
    generator = np.random.default_rng(21)
    truth, elliptic, drucker = [], [], []
    for seed in range(120):
        F, material = isochoric(*generator.uniform(-0.5, 0.5, 2), seed), random_polynomial(seed)
        truth.append(smallest_acoustic_form(material, F, seed) > 0)
        elliptic.append(bool(ellipticity_margin(material, principal_stretches(F)) > 0))
        drucker.append(bool(drucker_margin(material, principal_stretches(F)) > 0))
    assert 30 < sum(truth) < 90
    assert elliptic == truth
    assert drucker != truth


@pytest.mark.parametrize(
    ("coefficients", "stretches"),
    [
        ((-0.295, 0.764, -0.312, 0.851, -0.139), (1.1098, 0.3571)),
        ((0.429, 0.03, -0.222, 0.658, 0.036), (1.0863, 0.2974)),
        ((1.31, -0.161, -0.539, 1.179, -0.263), (0.9454, 2.175)),
    ],
)
def test_a_state_may_be_lost_by_the_third_set_of_conditions_alone(coefficients, stretches):
    """One in six thousand random states is: those of the tests above need no third set."""
    material = Polynomial(coefficients=dict(zip(("c10", "c01", "c20", "c11", "c02"), coefficients, strict=True)))
    state = np.array([*stretches, 1 / np.prod(stretches)])
    invariants = principal_invariants(state)
    shear, opposite, _ = shear_conditions(EnergyDerivatives.of(material, *invariants), state)
    assert min(shear.min(), opposite.min()) > 0
    assert smallest_acoustic_form(material, np.diag(state), 0) < 0
    assert ellipticity_margin(material, state) < 0


@pytest.mark.parametrize(
    ("name", "path", "window"),
    [
        ("b1a_printed", "uniaxial", (0.606, 0.830)),
        ("icf_printed", "uniaxial", (0.666, 0.896)),
        ("b1a_printed", "planar", (0.695, 0.800)),
        ("icf_printed", "planar", (0.741, 0.884)),
    ],
)
def test_the_windows_of_the_printed_constants(name, path, window):
    """errata.md, Material stability; its planar windows are rounded ("about")."""
    lost = [interval for interval in stability_range(named_material(name).material).paths[path].elliptic_lost if interval[1] < 1]
    assert lost == [pytest.approx(window, abs=5e-4)]  # three printed digits
    material = named_material(name).material
    for stretch, elliptic in (
        (window[0] - 2e-3, True),
        (window[0] + 2e-3, False),
        (window[1] - 2e-3, False),
        (window[1] + 2e-3, True),
    ):
        F = np.diag(PATHS[path](np.array(stretch)))
        assert bool(strongly_elliptic(material, F)) == elliptic
        assert (smallest_acoustic_form(material, F, 5) > 0) == elliptic


@pytest.mark.parametrize("name", PRINTED)
def test_the_uniaxial_window_is_the_sign_of_the_in_plane_shear_modulus(name):
    """W1 + W2 l^2 with I1 = l^2 + 2/l and I2 = 2 l + l^-2 (E18)."""
    terms = named_material(name).material.terms
    low, high = next(i for i in stability_range(named_material(name).material).paths["uniaxial"].elliptic_lost)
    for stretch in (low, high):
        I1, I2 = stretch**2 + 2 / stretch, 2 * stretch + stretch**-2
        modulus = terms[1, 0] + terms[1, 1] * (I2 - 3) + stretch**2 * (terms[0, 1] + terms[1, 1] * (I1 - 3))
        assert abs(modulus) <= 1e-8 * terms[0, 1]  # the root is located to 1e-10 of the stretch


@pytest.mark.parametrize("name", [*PRINTED, *STABLE])
def test_shipped_stable_sets_are_elliptic_over_half_to_double_and_printed_ones_are_not(name):
    generator = np.random.default_rng(4)
    logarithm = generator.uniform(-np.log(2), np.log(2), (2, 20000))
    third = -logarithm.sum(axis=0)
    stretches = np.exp(np.stack([*logarithm, third])[:, np.abs(third) <= np.log(2)])
    margin = ellipticity_margin(named_material(name).material, stretches)
    assert (margin > 0).all() == (name in STABLE)
    assert stability_range(named_material(name).material).strongly_elliptic == (name in STABLE)


def test_twenty_thousand_points_are_judged_in_one_evaluation_of_the_energy(monkeypatch):
    F = np.eye(3)[:, :, None] + 0.2 * np.random.default_rng(6).normal(size=(3, 3, 20000))
    material, asked = named_material("icf_printed").material, []
    hessian = type(material).energy_hessian
    monkeypatch.setattr(type(material), "energy_hessian", lambda self, *invariants: asked.append(1) or hessian(self, *invariants))
    strongly_elliptic(material, F)
    assert 1 <= len(asked) <= 3, asked


def test_an_energy_that_rises_with_the_invariants_and_is_convex_in_them_is_elliptic():
    """Each of the conditions is needed: points that lack it alone lose ellipticity."""
    logarithms = np.random.default_rng(7).uniform(-1, 1, (2, 2000))
    stretches = np.exp([*logarithms, -logarithms.sum(axis=0)])
    invariants = (stretches**2).sum(axis=0), (stretches**-2).sum(axis=0)
    alone = dict.fromkeys(("W1", "W2", "W11", "W22", "W12"), 0)
    for seed in range(200):
        material = random_polynomial(seed)
        elliptic = ellipticity_margin(material, stretches) > 0
        convex = convex_in_invariants(material, *invariants)
        assert elliptic[convex].all()
        (W1, W2), (W11, W12, W22) = material.energy_gradient(*invariants), material.energy_hessian(*invariants)
        kept = {"W1": W1 >= 0, "W2": W2 >= 0, "W11": W11 >= 0, "W22": W22 >= 0, "W12": W11 * W22 >= W12**2}
        np.testing.assert_array_equal(convex, np.all(list(kept.values()), axis=0))
        for name, holds in kept.items():
            others = np.all([value for other, value in kept.items() if other != name], axis=0)
            alone[name] += int((others & ~holds & ~elliptic).sum())
    assert min(alone[name] for name in ("W1", "W2", "W12")) > 0, alone  # of W11 and W22 alone, W12 says so too


def test_volume_and_rotation_do_not_matter_and_an_inverted_point_is_not_elliptic():
    material = named_material("icf_printed").material
    F = np.stack([isochoric(a, -a / 2, 3) for a in np.linspace(-0.5, 0.5, 41)], axis=-1)
    verdict = strongly_elliptic(material, F)
    assert verdict.any()
    assert not verdict.all()
    np.testing.assert_array_equal(strongly_elliptic(material, 1.3 * F), verdict)
    np.testing.assert_array_equal(strongly_elliptic(material, np.einsum("ij,jKn->iKn", isochoric(0, 0, 8), F)), verdict)
    assert not strongly_elliptic(NeoHookean(c10=1.0), -F).any()
    broken = np.where(np.arange(41) == 7, np.nan, F)
    assert not strongly_elliptic(NeoHookean(c10=1.0), broken)[7]
    assert strongly_elliptic(NeoHookean(c10=1.0), broken).sum() == 40


@settings(derandomize=True, max_examples=100, deadline=None)
@given(arrays.arrays(float, (3, 3), elements=st.floats(-3, 3)))
def test_principal_stretches_are_the_singular_values(F):
    computed, expected = principal_stretches(F[:, :, None])[:, 0], np.linalg.svd(F, compute_uv=False)
    assert np.abs(computed**2 - expected**2).max() <= 1e-7 * expected[0] ** 2 + 1e-15  # arc cosine at its end: root of round-off


def test_separate_principal_stretches_are_found_to_round_off():
    F = isochoric(0.4, 0.1, 2)
    np.testing.assert_allclose(principal_stretches(F), np.linalg.svd(F, compute_uv=False), rtol=1e-14)


@pytest.mark.parametrize("tiny", [0.0, 1e-17, 1e-60, 1e-120, 1e-170, 1e-300])
def test_a_vanishing_strain_is_rest(tiny):
    """A cube of the deviator would underflow to 0 / 0, and the point would count as lost."""
    F = np.eye(3)
    F[0, 1] = tiny
    np.testing.assert_allclose(principal_stretches(F), np.ones(3), rtol=1e-14)
    assert strongly_elliptic(NeoHookean(c10=1.0), F)


def test_drucker_is_the_curvature_by_the_logarithmic_strains():
    material = named_material("icf_printed").material
    generator, step = np.random.default_rng(9), 1e-4
    plane = np.linalg.qr(np.array([[1.0, 0, 1], [-1, 1, 1], [0, -1, 1]]))[0][:, :2]  # strains of sum zero

    def energy(strain):
        stretches = np.exp(plane @ strain)
        return float(material.energy((stretches**2).sum(), (stretches**-2).sum()))

    for strain in generator.uniform(-0.4, 0.4, (20, 2)):
        hessian = np.empty((2, 2))
        for i, j in np.ndindex(2, 2):
            a, b = step * np.eye(2)[i], step * np.eye(2)[j]
            corners = energy(strain + a + b) - energy(strain + a - b) - energy(strain - a + b) + energy(strain - a - b)
            hessian[i, j] = corners / (4 * step**2)
        smallest = np.linalg.eigvalsh(hessian)[0]
        computed = float(drucker_margin(material, np.exp(plane @ strain)))
        assert computed == pytest.approx(smallest, abs=1e-5 * np.abs(hessian).max())  # truncation 1e-8, round-off 1e-16 / 1e-8


def test_drucker_of_a_neo_hookean_material_at_rest_is_twice_the_shear_modulus():
    assert float(drucker_margin(NeoHookean(c10=1.0), np.ones(3))) == pytest.approx(4.0, rel=1e-14)


def test_intervals_are_joined_around_rest():
    lost = lost_intervals(lambda x: (x - 0.3) * (x - 0.5) * (x - 2))
    assert lost == (pytest.approx((0.2, 0.3)), pytest.approx((0.5, 2.0)))
    assert around_rest(((0.2, 0.3), (0.4, 0.8), (1.5, 2.0))) == (0.8, 1.5)
    assert around_rest(()) == (0.2, 5.0)


def test_linear_elasticity_is_always_elliptic():
    material = LinearElastic.example()
    assert strongly_elliptic(material, np.eye(3)[:, :, None]).all()
    assert stability_range(material).strongly_elliptic
    stretches = np.array([[0.2, 1.0, 5.0], [1.0, 1.0, 1.0], [5.0, 1.0, 0.2]])
    margin = sampled_ellipticity_margin(material, diagonal(stretches))
    assert (margin >= 0.99 * material.shear_modulus).all()
    assert (sampled_drucker_margin(material, stretches) > 0).all()


@pytest.mark.parametrize("kind", sorted(kind for kind, cls in kinds(Material).items() if issubclass(cls, Hyperelastic)))
def test_sampled_directions_judge_like_the_exact_conditions(kind):
    """Q of sampled directions is never below the least one over every direction, and of its sign but close to the border."""
    material = kinds(Material)[kind].example()
    logarithm = np.random.default_rng(5).normal(scale=0.5, size=(3, 300))
    stretches = np.exp(logarithm - logarithm.mean(axis=0))
    exact, computed = ellipticity_margin(material, stretches), sampled_ellipticity_margin(material, diagonal(stretches))
    assert not (computed[exact > 0] <= 0).any()
    assert ((computed > 0) != (exact > 0)).mean() < 0.03
    np.testing.assert_allclose(
        sampled_drucker_margin(material, stretches),
        drucker_margin(material, stretches),
        rtol=1e-9,  # a difference of two eigenvalues
        atol=1e-9 * material.shear_modulus,
    )


def test_sampled_directions_find_a_lost_ellipticity():
    """Twin: the literal set of the liver loses it, a softened law too."""
    lost = PrincipalOgden(modulus=1e3, alpha=-0.5)
    stretched = diagonal(np.array([9.0, 1 / 3, 1 / 3]))
    assert not strongly_elliptic(lost, stretched)
    assert strongly_elliptic(PrincipalOgden(modulus=1e3), stretched)
    assert strongly_elliptic(lost, np.eye(3))
    assert not strongly_elliptic(PrincipalOgden(modulus=1e3), np.diag([1.0, 1.0, -1.0]))


@pytest.fixture
def few_samples(monkeypatch):
    """A law whose directions are sampled is scanned at a tenth of the stretches."""
    monkeypatch.setattr(stability_range_module, "SAMPLES", 101)
    monkeypatch.setattr(stability_range_module, "DIRECTIONS", 31)


def test_the_range_of_a_law_of_principal_stretches_is_that_of_neo_hooke_at_an_exponent_of_two(few_samples):
    assert stability_range(PrincipalOgden(modulus=1e3)) == stability_range(NeoHookean(c10=500.0))


def test_a_path_beyond_the_scanned_stretches_does_not_condemn_a_material():
    """W1 + W2 l^2 of this one turns negative at a stretch of 10, which an equibiaxial path to 0.2 passes on its way to 25."""
    report = stability_range(MooneyRivlin2(c10=1.0, c01=-0.01))
    assert report.strongly_elliptic
    assert report.paths["equibiaxial"].elliptic_lost == (pytest.approx((0.2, 10**-0.5)),)
    assert not stability_range(MooneyRivlin2(c10=1.0, c01=-1 / 24)).strongly_elliptic  # negative from 4.9 on
    assert stability_range(MooneyRivlin2(c10=1.0, c01=-1 / 24)).elliptic_everywhere_within == pytest.approx(24**0.5, rel=1e-6)


def test_a_law_that_is_not_elliptic_at_rest_is_stable_nowhere(few_samples, monkeypatch):
    """Its report ended in an error of a root finder, and its paths were called stable everywhere."""
    law, tangent = PrincipalOgden.example(), PrincipalOgden.tangent
    monkeypatch.setattr(PrincipalOgden, "tangent", lambda self, F, pressure: -tangent(self, F, pressure))
    report = stability_range(law)
    assert report.elliptic_everywhere_within == 1.0
    assert not report.strongly_elliptic
    assert all(path.elliptic == (1.0, 1.0) for path in report.paths.values())
