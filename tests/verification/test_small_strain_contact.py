"""Indentation at small displacement against exact linear contact: annulus, punch and sphere, half-space and layers.

Mutants: a Poisson's ratio of 0.49 (the exact solutions have 1/2), the half-space below a layer, the rise over the undeformed
surface instead of the face, for the sphere its diameter and Young's modulus for E / (1 - nu^2), and tissue without its skin.
"""

from __future__ import annotations

from functools import cache

import pytest
from exact_punches import RINGS, half_space_rows, solid_factor
from mutants import assert_kills

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.analytic.force_factor import force_factor, rise_factor
from tactsim.contact.annulus import Annulus
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.punch import Punch
from tactsim.contact.sphere import Sphere
from tactsim.experiments.indentation.displaced import StepSettings
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.mechanics.models.specimen import Layer, Specimen

RADIUS = 3e-3
SHEAR_MODULUS = 1000.0
DISPLACEMENT = 1e-5 * RADIUS
"""The contact is evaluated at the displaced surface; at 1e-3 the rim of a punch on a layer has slid out by 0.9 % of the force."""
HALF_SPACE = 3000 * RADIUS
"""A bonded cylinder of this radius and height is stiffer than the half-space by about RADIUS / HALF_SPACE = 0.03 %."""
FORCE_TOLERANCE = 0.003
"""Asked of the force; the sharp edge is singular, so the error is of the order of finest / RADIUS."""
RISE_TOLERANCE = 0.005
GRADED = "axisymmetric, finest element 1/1000 of the radius"

QUICK_LAYERS = [(0.5, "bonded", 0.75)]
PUNCH_LAYERS = [(0.2, "bonded", 0.5), (1.0, "bonded", 0.5), (2.0, "bonded", 0.5), (1.0, "slipping", 0.2)]
"""a/h, base and Poisson's ratio of the exact force, which on a slipping layer is that of every ratio."""
QUICK_PUNCH_LAYERS = PUNCH_LAYERS[3:]
BASES = {"bonded": "fixed", "slipping": "slipping"}
"""What a case calls the base of a layer."""


def elastic(shear_modulus, poisson_ratio):
    return LinearElastic(youngs_modulus=2 * (1 + poisson_ratio) * shear_modulus, poisson_ratio=poisson_ratio)


BALLS = [
    # a/h, Poisson's ratio, d R / a^2, force over Hertz's at the same depth: the dual integral equations of Hayes et al. 1972
    (0.5, 0.3, 0.75887, 1.59085),
    (1.0, 0.4, 0.61881, 2.69209),
    (1.0, 0.5, 0.55948, 3.37056),
]
SKINS = [
    # G of the skin over that below, Poisson's ratios of both, P / (8 G a d) with G below: a skin of 0.5 a on a layer of 3.5 a
    (5.0, 0.5, 0.5, 1.98283),
    (5.0, 0.3, 0.45, 1.63923),
    (0.1, 0.4, 0.2, 0.31370),
]
STIFF_SKIN = (100.0, 0.2, 1.5, 0.97572, 5.14876)
"""G of the skin over that below, thicknesses of the skin and of all over a, d R / a^2, and force over Hertz's with G below, of a
ball on incompressible layers: dual integral equations of two bonded layers, solved with 60 and 100 points."""


@cache
def press(
    body, thickness, *, displacement=DISPLACEMENT, base="fixed", friction=0.0, poisson_ratio=0.5, layers=(), across=None, **sizes
):
    """Force in N, and height of the axis in m; what is below the layers has ``SHEAR_MODULUS`` and ``poisson_ratio``.

    A layer reaches ``across`` times the larger of its thickness and the radius of contact, by default 8 times if it is bonded,
    for the load then fades exponentially, and 20 times if it slips.
    """
    across = across or (8 if base == "fixed" else 20)
    material = elastic(SHEAR_MODULUS, poisson_ratio)
    width = thickness if thickness >= HALF_SPACE else across * max(thickness, RADIUS)
    experiment = Indentation(
        specimen=Specimen(material=material, thickness=thickness, radius=width, base=base, layers=layers),
        body=body,
        contact=Coulomb(friction=friction),
        recess=thickness / 2 if body.kind == "annulus" else None,
        stop="displacement",
        displacement=displacement,
        penetration_tolerance=1e-2 * displacement,
        mesh=MeshSettings(**{"finest": 1e-3 * RADIUS, "growth": 0.5} | sizes),
        steps=StepSettings(first=displacement, largest=displacement),
    )
    result = experiment.run()
    assert result.status == "converged", result.reason
    values = {name: quantity.value for name, quantity in result.quantities.items()}
    assert values["max_penetration"] <= 1e-2 * displacement, "only at the singular edge; a hundredth of it elsewhere"
    balance = 1e-8 if thickness < HALF_SPACE else 1e-3
    assert values["base_force"] == pytest.approx(values["reaction_force"], rel=balance), "9 m wide base: round-off of F = 1"
    return values["reaction_force"], values.get("tissue_rise_axis", 0.0)


def normalised(force, displacement=DISPLACEMENT):
    return force / (8 * SHEAR_MODULUS * RADIUS * displacement)


def check_force(force, factor):
    """P / (8 G a d) is the exact one."""
    assert normalised(force) == pytest.approx(factor, rel=FORCE_TOLERANCE)


def check_rise(rise, factor, tolerance=RISE_TOLERANCE):
    """The axis rises by the exact part of the displacement."""
    assert rise == pytest.approx(factor * DISPLACEMENT, rel=tolerance)


def annulus(ratio):
    return Annulus(inner_radius=ratio * RADIUS, outer_radius=RADIUS, fillet=0)


REPRESENTATIVE = (0.5,)


@pytest.mark.parametrize(
    ("beta", "kappa", "axis"),
    [
        pytest.param(*row, marks=() if row[0] in REPRESENTATIVE else pytest.mark.slow, id=f"beta={row[0]}")
        for row in half_space_rows()
        if 0.1 <= row[0] <= 0.9
    ],
)
def test_annulus_on_half_space(beta, kappa, axis, verification_record):
    force, rise = press(annulus(beta), HALF_SPACE)
    check_force(force, kappa)
    check_rise(rise, 1 - axis)
    known = {"reference": "exact annulus, integral equation", "kind": "exact", "mesh": GRADED}
    verification_record("annulus on half-space, force", normalised(force), kappa, tolerance=FORCE_TOLERANCE, **known)
    verification_record("annulus on half-space, rise", rise / DISPLACEMENT, 1 - axis, tolerance=RISE_TOLERANCE, **known)
    assert_kills(check_force, poisson_ratio=(force, kappa / (2 * (1 - 0.49))))
    assert_kills(check_rise, undeformed_surface=(rise, axis))


@pytest.mark.parametrize(
    ("ratio", "base", "beta", "factor", "axis"),
    [pytest.param(*row, marks=() if row[:3] in QUICK_LAYERS else pytest.mark.slow) for row in RINGS],
)
def test_annulus_on_layer(ratio, base, beta, factor, axis, verification_record):
    force, rise = press(annulus(beta), RADIUS / ratio, base=BASES[base])
    check_force(force, factor)
    known = {"reference": "incompressible layer, integral equation", "kind": "exact", "mesh": GRADED}
    verification_record(f"annulus on {BASES[base]} layer, force", normalised(force), factor, tolerance=FORCE_TOLERANCE, **known)
    assert_kills(check_force, half_space=(force, float(force_factor(beta))))
    if axis is not None:
        printed = 0.5e-3 / (1 - axis)
        check_rise(rise, 1 - axis, RISE_TOLERANCE + printed)
        assert_kills(check_rise, half_space=(rise, float(rise_factor(beta)), RISE_TOLERANCE + printed))


@pytest.mark.parametrize(
    ("ratio", "base", "exact_ratio"),
    [pytest.param(*row, marks=() if row in QUICK_PUNCH_LAYERS else pytest.mark.slow) for row in PUNCH_LAYERS],
)
def test_punch_on_layer(ratio, base, exact_ratio, verification_record):
    factor = solid_factor(ratio, base, exact_ratio)
    force, _ = press(Punch(radius=RADIUS), RADIUS / ratio, base=BASES[base])
    check_force(force, factor)
    known = {"reference": "Lebedev & Ufliand 1958; Hayes et al. 1972", "kind": "exact", "mesh": GRADED}
    verification_record(f"punch on {BASES[base]} layer, force", normalised(force), factor, tolerance=FORCE_TOLERANCE, **known)
    assert_kills(check_force, half_space=(force, 1.0))


@pytest.mark.parametrize("poisson_ratio", [pytest.param(0.49, marks=pytest.mark.slow), 0.30])
def test_punch_on_compressible_layer(poisson_ratio, verification_record):
    factor = solid_factor(1.0, "bonded", poisson_ratio)
    force, _ = press(Punch(radius=RADIUS), RADIUS, poisson_ratio=poisson_ratio)
    expected = factor / (2 * (1 - poisson_ratio))
    check_force(force, expected)
    known = {"reference": "integral equation of the layer", "kind": "exact", "mesh": "axisymmetric, graded"}
    verification_record("punch on a compressible layer", normalised(force), expected, tolerance=FORCE_TOLERANCE, **known)
    assert_kills(check_force, incompressible=(force, solid_factor(1.0, "bonded", 0.5)), without_the_ratio=(force, factor))


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "poisson_ratio", "depth", "factor"), BALLS)
def test_ball_far_wider_than_a_bonded_layer(ratio, poisson_ratio, depth, factor, verification_record):
    radius = 1e3 * RADIUS  # a flat cap: at 50 times, the inward slip of a compressible surface costs 0.5 % of the force
    displacement = depth * RADIUS**2 / radius
    thickness, size = RADIUS / ratio, RADIUS / 25
    across = 8 if poisson_ratio == 0.5 else 5  # what keeps its volume carries the load further
    sizes = {"finest": size, "across": across}  # the ball lies along the whole layer, whose cells are as small everywhere
    force, _ = press(Sphere(radius=radius), thickness, displacement=displacement, poisson_ratio=poisson_ratio, **sizes)

    def found(poisson_ratio):
        return force / (8 / 3 * SHEAR_MODULUS / (1 - poisson_ratio) * radius**0.5 * displacement**1.5)

    def check(expected, poisson_ratio=poisson_ratio):
        assert found(poisson_ratio) == pytest.approx(expected, rel=FORCE_TOLERANCE)

    check(factor)
    known = {"reference": "Hayes et al. 1972, equations solved anew", "kind": "exact", "mesh": "axisymmetric, 25 elements"}
    verification_record("ball on bonded layer, force", found(poisson_ratio), factor, tolerance=FORCE_TOLERANCE, **known)
    assert_kills(check, half_space=(1.0,), poisson_ratio=(factor, poisson_ratio - 0.02))


@pytest.mark.parametrize(
    ("ratio", "above", "below", "factor"),
    [SKINS[0], *(pytest.param(*row, marks=pytest.mark.slow) for row in SKINS[1:])],
)
def test_punch_on_skin(ratio, above, below, factor, verification_record):
    skin = Layer(thickness=0.5 * RADIUS, material=elastic(ratio * SHEAR_MODULUS, above))
    force, _ = press(Punch(radius=RADIUS), 4 * RADIUS, poisson_ratio=below, layers=(skin,), growth=0.25)  # in the skin, too
    check_force(force, factor)
    known = {"reference": "dual integral equations of two bonded layers, solved anew", "kind": "exact", "mesh": GRADED}
    verification_record("punch on a skin, force", normalised(force), factor, tolerance=FORCE_TOLERANCE, **known)
    bare = solve_annular_punch(0.0, radius_over_thickness=0.25, base="bonded", poisson_ratio=below)
    assert_kills(check_force, without_skin=(force, bare.force_factor / (2 * (1 - below))))


@pytest.mark.slow
def test_ball_on_a_stiff_skin(verification_record):
    """The mean stress jumps where the skin ends: one that is continuous there takes 1 % of the force on this mesh, and half as
    much on cells of half the size. Mutants: such a force, and the layer without its skin."""
    contrast, skin, all_layers, depth, factor = STIFF_SKIN
    radius = 1e3 * RADIUS
    displacement = depth * RADIUS**2 / radius
    layers = (Layer(thickness=skin * RADIUS, material=elastic(contrast * SHEAR_MODULUS, 0.5)),)
    asked = {"displacement": displacement, "finest": RADIUS / 25, "across": 10}
    hertz = 16 / 3 * SHEAR_MODULUS * radius**0.5 * displacement**1.5
    force, _ = press(Sphere(radius=radius), all_layers * RADIUS, layers=layers, **asked)
    bare, _ = press(Sphere(radius=radius), all_layers * RADIUS, **(asked | {"finest": RADIUS / 10}))

    def check(expected, force=force):
        assert force / hertz == pytest.approx(expected, rel=FORCE_TOLERANCE)

    check(factor)
    known = {"reference": "dual integral equations of two bonded layers", "kind": "exact", "mesh": "axisymmetric, 25 elements"}
    verification_record("ball on a stiff skin, force", force / hertz, factor, tolerance=FORCE_TOLERANCE, **known)
    assert_kills(check, continuous_mean_stress=(factor, 0.99 * factor * hertz), without_skin=(factor, bare))


def test_punch_on_half_space(verification_record):
    force, _ = press(Punch(radius=RADIUS), HALF_SPACE)
    check_force(force, 1.0)
    known = {"reference": "P = 8 G a d (Boussinesq)", "kind": "exact", "mesh": GRADED}
    verification_record("punch on half-space, force", normalised(force), 1.0, tolerance=FORCE_TOLERANCE, **known)
    assert_kills(check_force, poisson_ratio=(force, 1 / (2 * (1 - 0.49))))


def test_sphere_follows_hertz(verification_record):
    displacement = 1e-3 * RADIUS
    force, _ = press(Sphere(radius=RADIUS), HALF_SPACE, displacement=displacement, finest=4e-3 * RADIUS)

    def check(modulus, radius):
        assert force == pytest.approx(4 / 3 * modulus * radius**0.5 * displacement**1.5, rel=FORCE_TOLERANCE)

    check(4 * SHEAR_MODULUS, RADIUS)
    expected = 16 / 3 * SHEAR_MODULUS * RADIUS**0.5 * displacement**1.5
    known = {"reference": "Hertz 1881", "kind": "exact", "mesh": GRADED.replace("1/1000", "1/250")}
    verification_record("sphere on half-space, force", force, expected, tolerance=FORCE_TOLERANCE, **known)
    assert_kills(check, youngs_modulus=(3 * SHEAR_MODULUS, RADIUS), diameter=(4 * SHEAR_MODULUS, 2 * RADIUS))


@pytest.mark.parametrize("beta", [0.5, pytest.param(0.9, marks=pytest.mark.slow)])
def test_friction_leaves_the_incompressible_half_space_alone(beta, verification_record):
    free, _ = press(annulus(beta), HALF_SPACE)
    rough, _ = press(annulus(beta), HALF_SPACE, friction=1.0)
    assert rough == pytest.approx(free, rel=1e-3), "a normal load moves an incompressible surface only along its normal"
    known = {"reference": "without friction", "kind": "exact", "mesh": "axisymmetric, graded", "tolerance": 1e-3}
    verification_record("annulus on an incompressible half-space, with friction", rough, free, **known)


def test_friction_on_a_compressible_half_space_is_seen():
    """P = 4 G a d / (1 - nu) without it."""
    rough, _ = press(Punch(radius=RADIUS), HALF_SPACE, poisson_ratio=0.3, friction=1.0)
    assert normalised(rough) > 1 / (2 * (1 - 0.3)) * 1.01
