"""Every registered rigid body and contact law, in the section and in space: distances, derivatives, the friction cone."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from tactsim.contact.traction import ContactPair, ContactState
from tactsim.errors import InputError
from tactsim.interfaces import ContactLaw, Experiment, RigidBody
from tactsim.registry import kinds

BODIES = kinds(RigidBody)
PLACED = [(kind, dim) for kind, body in sorted(BODIES.items()) for dim in body.dimensions]
LAWS = kinds(ContactLaw)


def near(body, dim, count=400):
    """Random points (dim, n) of the scale of the body, away from where the distance has kinks, with their distance."""
    generator = np.random.default_rng(7)
    scale = float(getattr(body, "outer_radius", getattr(body, "radius", getattr(body, "width", 1e-3))))
    points = generator.uniform(-1.5, 1.5, (dim, 20 * count)) * scale
    if dim == 2:
        points[0] = np.abs(points[0])
    distance = body.signed_distance(points)[0]
    fillet = float(getattr(body, "fillet", 0.0))
    keep = np.abs(distance) < max(0.3 * fillet, 0.02 * scale)
    return points[:, keep][:, :count], scale


@pytest.mark.parametrize(("kind", "dim"), PLACED)
def test_normal_and_hessian_are_the_derivatives_of_the_distance(kind, dim):
    body = BODIES[kind].example()
    points, scale = near(body, dim)
    _, normal, hessian = body.signed_distance(points)
    step = 1e-7 * scale
    smooth = np.ones(points.shape[1], bool)
    for axis in range(dim):
        shift = np.zeros((dim, 1))
        shift[axis] = step
        above, below = body.signed_distance(points + shift), body.signed_distance(points - shift)
        smooth &= np.linalg.norm(above[1] - below[1], axis=0) < 1e-4
        np.testing.assert_allclose(((above[0] - below[0]) / (2 * step))[smooth], normal[axis][smooth], atol=1e-6)
        slope = (above[1] - below[1]) / (2 * step) * scale
        np.testing.assert_allclose(slope[:, smooth], hessian[:, axis][:, smooth] * scale, atol=2e-4)
    assert smooth.mean() > 0.8
    np.testing.assert_allclose(np.linalg.norm(normal, axis=0), 1.0, rtol=1e-12)


@pytest.mark.parametrize("kind", sorted(kind for kind, body in BODIES.items() if 2 in body.dimensions))
def test_section_and_space_agree(kind):
    body = BODIES[kind].example()
    flat, _ = near(body, 2)
    turned = np.stack([flat[0] * np.cos(0.7), flat[0] * np.sin(0.7), flat[1]])
    np.testing.assert_allclose(body.signed_distance(turned)[0], body.signed_distance(flat)[0], atol=1e-15)


def pressed(body, law, dim):
    """A pair, a state with friction, and points that have moved on from it."""
    generator = np.random.default_rng(3)
    points, scale = near(body, dim)
    gap, normal, _ = body.signed_distance(points)
    points = points - (gap + generator.uniform(-1e-6, 2e-6, gap.shape)) * normal
    normal = body.signed_distance(points)[1]
    pair = ContactPair(body, law, penalty=1e9, tangential_penalty=2e8, switch_stiffness=1e9)
    moved = points + generator.normal(size=points.shape) * 1e-7 * scale / 1e-3
    old = generator.normal(size=points.shape) * 200
    old = old - np.einsum("in,in->n", old, normal) * normal
    return pair, ContactState(np.zeros(points.shape[1]), old, points, normal), moved


@pytest.mark.parametrize(("kind", "dim"), PLACED)
@pytest.mark.parametrize("law", sorted(LAWS))
def test_tractions_stay_in_the_cone_and_never_pull(kind, law, dim):
    law = LAWS[law].example()
    pair, state, moved = pressed(BODIES[kind].example(), law, dim)
    converged = pair.converged(moved, state)
    assert (converged.pressure >= 0).all()
    assert (converged.pressure > 0).any()
    size = np.linalg.norm(converged.tangential, axis=0)
    assert (size <= law.traction_limit(converged.pressure) * (1 + 1e-8)).all()
    np.testing.assert_allclose(np.einsum("in,in->n", converged.tangential, converged.normal), 0, atol=1e-9 * max(size.max(), 1))
    if np.isfinite(law.traction_limit(converged.pressure)).all():
        assert (size >= law.traction_limit(converged.pressure) * (1 - 1e-8)).any(), "some points slip"


@pytest.mark.parametrize(("kind", "dim"), PLACED)
@pytest.mark.parametrize("law", sorted(LAWS))
@pytest.mark.parametrize("held", [False, True])
def test_newton_sees_the_derivative_of_the_traction(kind, law, dim, held):
    pair, state, moved = pressed(BODIES[kind].example(), LAWS[law].example(), dim)
    if held:
        pair = pair.with_held_limit(pair.converged(moved, state).pressure)
    carried = pair.converged(moved, state).iterate()
    now = pair.linearised(moved, state, carried)
    np.testing.assert_allclose(now.traction, pair.converged(moved, state).traction, atol=1e-6 * np.abs(now.traction).max())
    step = 1e-12
    for axis in range(dim):
        shift = np.zeros((dim, 1))
        shift[axis] = step
        above = pair.linearised(moved + shift, state, carried).traction
        below = pair.linearised(moved - shift, state, carried).traction
        slope = (above - below) / (2 * step)
        kink = np.abs(slope - now.derivative[:, axis]).max(axis=0) > 1e-3 * pair.penalty
        assert kink.mean() < 0.05


@pytest.mark.parametrize("friction_mask", [0.0, 1.0])
def test_a_held_limit_does_not_follow_the_pressure(friction_mask):
    pressures = np.array([0.0, 1e3, 2e3])
    pair = ContactPair(BODIES["plane"].example(), LAWS["coulomb"](friction=0.5), friction_mask=np.full(3, friction_mask))
    held = pair.with_held_limit(pressures)
    np.testing.assert_allclose(held.traction_limit(10 * pressures), friction_mask * 0.5 * pressures)
    np.testing.assert_array_equal(held.limit_slope(pressures), 0)
    np.testing.assert_allclose(pair.limit_slope(pressures), friction_mask * 0.5)


def test_a_pair_has_friction_where_its_law_and_its_mask_allow_it():
    plane = BODIES["plane"].example()
    rough, smooth = LAWS["coulomb"](friction=0.5), LAWS["coulomb"](friction=0.0)
    assert ContactPair(plane, rough).has_friction
    assert ContactPair(plane, LAWS["stick"].example()).has_friction
    assert ContactPair(plane, rough, friction_mask=np.array([0.0, 1.0])).has_friction
    assert not ContactPair(plane, rough, friction_mask=np.zeros(2)).has_friction
    assert not ContactPair(plane, smooth).has_friction


def test_a_law_with_the_kind_of_another_one_is_refused_in_a_case():
    class Slippery(LAWS["coulomb"]):
        def traction_limit(self, pressure):
            return super().traction_limit(pressure) / 2

    press = kinds(Experiment)["indentation"].example()
    with pytest.raises(InputError, match="contact: Slippery has the kind 'coulomb' of Coulomb, as which a case would name it"):
        type(press)(**(dict(press) | {"contact": Slippery(friction=0.5)}))


def test_friction_that_begins_at_a_pressure_is_friction():
    class Squeezed(LAWS["coulomb"]):
        kind: Literal["squeezed"] = "squeezed"

        def traction_limit(self, pressure):
            return super().traction_limit(np.maximum(pressure - 5e3, 0.0))

    plane = BODIES["plane"].example()
    assert ContactPair(plane, Squeezed(friction=0.5)).has_friction
    assert not ContactPair(plane, Squeezed(friction=0.0)).has_friction
