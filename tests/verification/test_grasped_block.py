"""A block between two jaws: taxels read the exact Cauchy pressure, forces add up, halves mirror each other.

Mutants: nominal stress, taxels without the gaps between them, half the force, wide jaws, a lump of the tissue's own material.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from mutants import assert_kills
from solids import box, facets_where, on_plane

import tactsim as ts
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.jaw import Jaw
from tactsim.contact.penalty import Augmentation
from tactsim.fem.paths.loading import PathFollower, StepControl
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_block
from tactsim.mesh.quadratic import QuadraticMesh

SIZE = np.array([0.04, 0.03, 0.02])
RUBBER = MooneyRivlin2(c10=1000.0, c01=250.0)
HARD = MooneyRivlin2(c10=8000.0, c01=2000.0)
LAYOUT = TaxelLayout(rows=2, columns=3, pitch=10e-3, size=8e-3)
SCALE = Augmentation(1e-6, RUBBER.shear_modulus, switch_length=1e-3, softness=5e-5)
WIDE = {"width": 0.08, "depth": 0.08, "fillet": 1e-3}
MORE = 1.15
"""Friction of a wedge that is held over the least."""


def grasped(*, friction, closing=1e-3, steps=4, lump=None, cells=(6, 4, 3), jaw=WIDE):
    """The model and its state with both jaws closed; ``lump`` is the centre and radius of a hard region."""
    mesh = box(SIZE, cells)
    if lump is not None:
        centres = mesh.nodes[mesh.elements[:, :4]].mean(axis=1)
        mesh = QuadraticMesh(mesh.nodes, mesh.elements, (np.linalg.norm(centres - lump[0], axis=1) < lump[1]).astype(int))
    facets = {"upper": facets_where(mesh, on_plane(2, SIZE[2])), "lower": facets_where(mesh, on_plane(2, 0.0))}
    jaws = [Jaw(side=side, **jaw) for side in JAWS]
    materials = [RUBBER] if lump is None else [RUBBER, HARD]
    model = GraspModel(mesh, materials, facets, jaws=jaws, offsets=np.tile(SIZE[:2] / 2, (2, 1)))
    scale = SCALE
    state = model.start(Coulomb(friction=friction), scale)
    control = StepControl(first=closing / steps, largest=closing, smallest=1e-3 * closing)
    *_, (state, _) = PathFollower(model.equilibrium, control).follow(state, closing)
    return model, state


@pytest.fixture(scope="module")
def stuck():
    """Model and state of the block between jaws with friction."""
    return grasped(friction=0.6)


def test_frictionless_taxels_read_the_cauchy_pressure(verification_record):
    model, state = grasped(friction=0.0)
    u = model.space.split(state.unknowns)[0]
    top, bottom = (model.mesh.nodes[:, 2] == height for height in (SIZE[2], 0.0))
    stretch = 1 + (u[top, 2].mean() - u[bottom, 2].mean()) / SIZE[2]
    cauchy = 2 * (stretch**-1 - stretch**2) * (1000.0 + 250.0 / stretch)
    for side in JAWS:
        forces = model.taxels(state, side, LAYOUT)

        def check_pressure(expected, forces=forces):
            np.testing.assert_allclose(forces.taxels[2] / LAYOUT.area, expected, rtol=1e-8)

        def check_total(total, side=side):
            np.testing.assert_allclose(total[2], abs(model.jaw_force(state, side)[2]), rtol=1e-10)

        check_pressure(cauchy)
        check_total(forces.total)
        mesh = "solid, 6 x 4 x 3 cells"
        known = {"reference": "uniaxial compression in closed form", "kind": "exact", "mesh": mesh, "tolerance": 1e-8}
        verification_record("pressure on taxels", forces.taxels[2] / LAYOUT.area, cauchy, **known)
        known = {"reference": "the reaction of the jaw", "kind": "invariance", "mesh": mesh, "tolerance": 1e-10}
        verification_record("sum of taxels, gaps and outside", forces.total[2], abs(model.jaw_force(state, side)[2]), **known)
        swapped = 2 * (stretch**-1 - stretch**2) * (250.0 + 1000.0 / stretch)
        assert_kills(check_pressure, nominal=(cauchy / stretch,), swapped=(swapped,))
        assert_kills(check_total, without_gaps=(forces.total - forces.gaps,))


def test_friction_forces_add_up_and_balance(stuck, verification_record):
    model, state = stuck
    upper, lower = (model.taxels(state, side, LAYOUT) for side in JAWS)
    force = model.jaw_force(state, "upper")

    def check(total, opposite):
        np.testing.assert_allclose(total, force, rtol=1e-8, atol=1e-8 * abs(force[2]))
        np.testing.assert_allclose(opposite, -force, rtol=1e-6, atol=1e-6 * abs(force[2]))

    opposite = model.jaw_force(state, "lower")
    check(upper.total, opposite)
    known = {"reference": "the reaction of the jaw", "kind": "invariance", "mesh": "solid, 6 x 4 x 3 cells", "tolerance": 1e-8}
    verification_record("sum of taxels, gaps and outside, friction 0.6", upper.total, force, **known)
    verification_record("forces of both jaws, friction 0.6", opposite, -force, **(known | {"tolerance": 1e-6}))
    assert_kills(
        check,
        without_gaps=(upper.total - upper.gaps, opposite),
        without_outside=(upper.total - upper.outside, opposite),
        sign=(upper.total, -opposite),
    )
    np.testing.assert_allclose(upper.taxels[2], lower.taxels[2], rtol=0.05, err_msg="the tetrahedra are not mirrored")
    assert np.abs(upper.gaps[2]) > 0
    assert np.abs(upper.outside[2]) > 0


@pytest.mark.slow
def test_a_hard_lump_is_seen_by_the_jaw_that_is_nearer():
    lump = (np.array([0.02, 0.015, 0.014]), 5e-3)
    model, state = grasped(friction=0.6, lump=lump, cells=(8, 6, 5))
    felt = [model.taxels(state, side, LAYOUT).taxels[2] for side in JAWS]
    plain_model, plain = grasped(friction=0.6, cells=(8, 6, 5))
    before = [plain_model.taxels(plain, side, LAYOUT).taxels[2] for side in JAWS]

    def check(upper, lower):
        assert upper[:, 1].mean() > 1.05 * lower[:, 1].mean()
        assert upper[:, 1].mean() > 1.1 * before[0][:, 1].mean()

    check(*felt)
    assert_kills(check, own_material=tuple(before), jaws_swapped=tuple(felt[::-1]))


def test_tissue_that_bulges_beside_narrow_jaws_is_seen():
    model, state = grasped(
        friction=0.0, cells=(8, 6, 3), jaw={"width": 0.02, "depth": 0.02, "fillet": 2e-3}, closing=3e-4, steps=1
    )

    def check(model, state):
        heights = (model.mesh.nodes + model.space.split(state.unknowns)[0])[np.unique(model.facets["upper"]), 2]
        assert heights.max() > SIZE[2] + 1e-5

    check(model, state)
    assert_kills(check, wide=grasped(friction=0.0, cells=(2, 2, 1), closing=3e-4))
    assert state.regularisation.tolerance >= -min(c.at(_moved(model, state, c)).gap.min() for c in state.contacts)


def test_a_force_closes_both_jaws_alike(stuck, verification_record):
    model, closed = stuck
    force = abs(model.jaw_force(closed, "upper")[2])
    begun = model.start(Coulomb(friction=0.6), SCALE)
    half = model.equilibrium(begun, 5e-4, begun.unknowns)

    def check(given):
        pressed = model.equilibrium(half, 5e-4, half.unknowns, force=given)
        assert pressed.load == pytest.approx(1e-3, rel=1e-3)
        assert abs(model.jaw_force(pressed, "lower")[2]) == pytest.approx(force, rel=1e-6)
        return pressed.load

    known = {
        "reference": "the closing whose force it is",
        "kind": "invariance",
        "mesh": "solid, 6 x 4 x 3 cells",
        "tolerance": 1e-3,
    }
    verification_record("closing under a force", check(force), 1e-3, **known)
    assert_kills(check, shared_by_the_jaws=(force / 2,))


def _moved(model, state, contact):
    return contact.surface.points.interpolate(model.space.split(state.unknowns)[0])


PASSING = 5e-6
"""Allowed penetration in m of a jaw by a block 10 mm high."""


def beyond_the_jaw(faces, *, size=(20e-3, 20e-3, 10e-3), closing=0.85e-3, tolerance=PASSING):
    """How far in m free faces of a stuck block reach beyond the upper jaw; ``faces`` may touch the jaws, by name."""
    block = graded_block(size, (), BlockMeshSettings(size=6e-3, edge_size=0.8e-3, growth=1.0))
    jaws = [Jaw(side=side, width=0.05, depth=0.05, fillet=1e-3) for side in JAWS]
    touching = {name: block.facets[name] for name in faces}
    model = GraspModel(block.mesh, [RUBBER], touching, jaws=jaws, offsets=np.tile(np.array(size[:2]) / 2, (2, 1)))
    state = model.start(
        Coulomb(friction=0.6), Augmentation(tolerance, RUBBER.shear_modulus, switch_length=1e-3, softness=5 * tolerance)
    )
    control = StepControl(first=closing / 4, largest=closing, smallest=1e-3 * closing)
    *_, (state, _) = PathFollower(model.equilibrium, control).follow(state, closing)
    free = model.space.surface_points(np.concatenate([block.facets[name] for name in ("left", "right", "front", "back")]))
    height = free.interpolate(block.mesh.nodes + model.space.split(state.unknowns)[0])[2]
    return float(height.max()) - (size[2] - closing)


def test_free_faces_roll_onto_the_jaws_instead_of_passing_beside_them(verification_record):
    beyond = beyond_the_jaw(("upper", "lower", "left", "right", "front", "back"))
    assert beyond <= PASSING
    known = {"reference": "none: the penetration allowed", "kind": "invariance", "mesh": "graded, 0.8 mm at the edges"}
    known |= {"scale": 10e-3, "tolerance": PASSING / 10e-3}
    verification_record("free faces beyond a jaw, over the height of the block", max(beyond, 0.0), 0.0, **known)


@pytest.mark.slow
@pytest.mark.parametrize("closing", [0.8e-3, 0.85e-3])
def test_without_contact_on_the_free_faces_they_would_pass_the_jaw(closing):
    assert beyond_the_jaw(("upper", "lower"), closing=closing) > 3 * PASSING


@pytest.mark.slow  # half a minute
def test_a_wedge_is_held_by_friction_above_half_its_angle_only(verification_record, monkeypatch):
    """Two forces in balance lie on one line: each leans from its face by half the angle between the faces."""
    monkeypatch.setattr("tactsim.experiments.grasp.setup.sliding_out", lambda *_: None)
    half = math.radians(2.0)
    settings = {"kind": "grasp", "block": {"size": ["20 mm", "20 mm", "10 mm"], "tissue": "icf_stable"}}
    settings |= {"upper": {"width": "30 mm", "depth": "30 mm", "tilt_y": "4 deg"}, "lower": {"width": "30 mm", "depth": "30 mm"}}
    settings |= {"matrix": {"rows": 2, "columns": 2, "pitch": "6 mm", "size": "5 mm"}, "mesh": {"kind": "graded", "size": "5 mm"}}
    settings["loading"] = {"control": "displacement", "pieces": [{"kind": "ramp", "to": "1 mm", "duration": "1 s"}]}

    def result(friction):
        law = {"contact": {"kind": "coulomb", "friction": friction}}
        return ts.load_case({"schema": "tactsim/case/1", "title": "wedge", "experiment": settings | law}).run()

    slid, held = result(math.tan(half) / MORE), result(MORE * math.tan(half))
    assert slid.status == "failed"
    assert held.status == "converged"
    along, _, across = held["jaw_force_lower"].value
    lean = math.degrees(math.atan(abs(along / across)))
    known = {"reference": "two forces in balance", "kind": "exact", "mesh": "graded, cells of 5 mm", "tolerance": MORE - 1}
    verification_record(
        "angle of the force on the level jaw of a wedge of 4 degrees, friction 1.15 tan 2 degrees", lean, 2.0, **known
    )
    most = math.degrees(math.atan(MORE * math.tan(half)))
    assert 4.0 - most <= lean <= most  # neither jaw's force leaves the cone of friction
