"""The annulus on tetrahedra against the axisymmetric model, its symmetric parts against each other, and balance when it leans."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.interpolate import PchipInterpolator

from tactsim.case import load_case
from tactsim.contact.annulus import Annulus
from tactsim.experiments.indentation.course import DisplacementPath
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.indentation_3d import Indentation3D, MeshSettings3D
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mesh.revolved import SweepSymmetry
from tactsim.shipped import CASES

THIN = {
    "specimen": Specimen(material=NeoHookean(c10=1000.0), thickness=3e-3, radius=6e-3),
    "body": Annulus(fillet=0.5e-3),
    "recess": 0.2e-3,
    "stop": "displacement",
    "displacement": 0.05e-3,
    "steps": {"first": 0.05e-3},
    "penetration_tolerance": 2e-7,
}
SIZES = {"finest": 0.5e-3, "growth": 1.5, "adaptive": False}
TILT = 0.02
"""In rad: the outer edge stands 0.06 mm lower than the middle."""
COARSE = "solid, elements of 0.5 mm at the fillet, two sectors"
DEMANDED = 0.02
"""Part of the axisymmetric force and rise by which the shipped case may differ."""


class Half(Indentation3D):
    """As upright as a quarter, on twice its elements."""

    @property
    def symmetry(self):
        return SweepSymmetry.HALF


def posed(kind=Indentation3D, **changes):
    return kind(**(THIN | {"mesh": MeshSettings3D(sectors=2, **SIZES)} | changes))


def histories(result):
    """Displacement, force and rise (steps, 3) in m, N and m."""
    names = ("displacement", "reaction_force", "tissue_rise")
    return np.array([[step.values[name] for name in names] for step in result.steps])


def differences(result, reference):
    """Relative differences (steps, 2) of force and rise from the reference at the same displacements."""
    computed, known = histories(result), np.vstack([np.zeros(3), histories(reference)])
    computed = computed[computed[:, 0] <= known[-1, 0]]
    expected = np.stack([PchipInterpolator(known[:, 0], known[:, k])(computed[:, 0]) for k in (1, 2)], axis=1)
    return computed[:, 1:] / expected - 1


def check_differences(apart):
    """Force and rise differ by less than is demanded."""
    assert np.abs(apart).max() < DEMANDED, apart


def with_force(apart, factor):
    """Mutant: differences (..., 2) if the force were that of a part of the body."""
    return (1 + apart) * [factor, 1.0] - 1


@pytest.fixture(scope="module")
def quarter():
    return posed().run()


def test_a_quarter_presses_like_the_axisymmetric_model(quarter, verification_record):
    section = Indentation(**(THIN | {"mesh": MeshSettings(**SIZES)})).run()
    assert quarter.status == section.status == "converged"
    assert quarter.scene.symmetry == "quarter"
    apart = differences(quarter, section)[-1]
    check_differences(apart)  # on elements as long as the fillet is wide, touched at other points than the section's
    known = {"reference": "axisymmetric model", "kind": "invariance", "mesh": COARSE, "tolerance": DEMANDED}
    for name, difference in zip(("force", "rise"), apart, strict=True):
        verification_record(f"annulus in space, {name}", 1 + difference, 1.0, **known)
    assert_kills(check_differences, one_quarter=(with_force(apart, 1 / 4),), half=(with_force(apart, 1 / 2),))


def test_forces_balance_and_the_upright_annulus_feels_no_moment(quarter, verification_record):
    values = {name: quantity.value for name, quantity in quarter.quantities.items()}
    assert values["reaction_force"] == pytest.approx(values["base_force"], rel=1e-8)
    known = {"reference": "balance of forces", "kind": "invariance", "mesh": COARSE, "tolerance": 1e-8}
    verification_record("annulus in space, force on the base", values["base_force"], values["reaction_force"], **known)
    np.testing.assert_array_equal(values["force_vector"][:2], 0.0)
    np.testing.assert_array_equal(values["moment_vector"], 0.0)
    body = THIN["body"]
    area = np.pi * (body.outer_radius**2 - body.inner_radius**2)

    def check(area):
        assert np.mean(values["pressure_around"]) * area == pytest.approx(values["reaction_force"], rel=1e-10)

    check(area)
    around = np.mean(values["pressure_around"]) * area
    known |= {"reference": "its own force", "tolerance": 1e-10}
    verification_record("annulus in space, pressure around it", around, values["reaction_force"], **known)
    assert_kills(check, without_a_hole=(np.pi * body.outer_radius**2,), one_quarter=(area / 4,))


@pytest.mark.slow
def test_half_a_body_is_two_quarters(quarter, verification_record):
    """Mutant: the axisymmetric model on elements of the same size, which differs by its discretisation alone."""
    half = posed(Half).run()
    assert half.scene.solver.unknowns > 1.7 * quarter.scene.solver.unknowns
    assert len(half.steps) == len(quarter.steps)
    np.testing.assert_allclose(histories(half), histories(quarter), rtol=1e-6)  # Newton's tolerance, and steps that add it up

    def check(other):
        np.testing.assert_allclose(histories(half)[-1], histories(other)[-1], rtol=1e-6)

    check(quarter)
    assert_kills(check, in_the_section=(Indentation(**(THIN | {"mesh": MeshSettings(**SIZES)})).run(),))
    known = {"reference": "a quarter of it", "kind": "invariance", "mesh": COARSE, "tolerance": 1e-6}
    ratios = histories(half) / histories(quarter)
    verification_record("half of an annulus in space, force and rise", ratios, np.ones_like(ratios), **known)
    np.testing.assert_allclose(half.quantities["moment_vector"].value, 0.0, atol=1e-9 * half.quantities["reaction_force"].value)


def test_a_leaning_annulus_is_held_in_balance_by_the_base(verification_record):
    coarse = MeshSettings3D(sectors=2, **(SIZES | {"finest": 0.6e-3}))  # balance holds on any mesh and at any penetration
    experiment = posed(tilt_y=TILT, displacement=0.04e-3, penetration_tolerance=2e-6, mesh=coarse)
    model = experiment.model()
    *_, (last, _) = DisplacementPath(experiment, experiment.drive(), model).states(lambda model, split: None)
    state, contact = last.contact, last.contact.contacts[0]
    force, moment = model.force(contact.state.traction), model.moment(contact, state.unknowns)
    u, _ = model.space.split(state.unknowns)
    internal = model.body.residual(state.unknowns)[: u.size].reshape(-1, 3)[model.base_nodes]
    arms = (model.mesh.nodes + u)[model.base_nodes] - state.contacts[0].place
    expected = 2 * np.cross(arms, internal).sum(axis=0) * [0, 1, 0]
    assert abs(expected[1]) > 0.1e-3 * force[2], "the force acts away from the axis"

    def check(moment):
        np.testing.assert_allclose(moment, expected, atol=1e-8 * abs(expected[1]))  # Newton's tolerance is 1e-10

    check(moment)
    mesh = "solid, half, elements of 0.6 mm"
    known = {"reference": "moment of the forces on the base", "kind": "invariance", "mesh": mesh, "tolerance": 1e-8}
    verification_record("leaning annulus, moment", moment, expected, **known)
    assert_kills(check, sign=(-moment,), one_half=(moment / 2,))
    np.testing.assert_allclose(model.base_force(state), force, atol=1e-8 * force[2])


@pytest.mark.slow
def test_leaning_about_x_is_leaning_about_y_turned_by_a_right_angle(verification_record):
    half, whole = (posed(displacement=0.04e-3, **{axis: TILT}).run() for axis in ("tilt_y", "tilt_x"))
    assert (half.scene.symmetry, whole.scene.symmetry) == ("half", "whole")
    for name in ("force_vector", "moment_vector"):
        x, y, z = half.quantities[name].value
        size = np.abs(half.quantities[name].value).max()

        def check(turned, name=name, size=size):
            np.testing.assert_allclose(whole.quantities[name].value, turned, atol=1e-6 * size)  # as for the half and quarter

        check([y, -x, z])
        known = {"reference": "the same about y, turned", "kind": "invariance", "mesh": COARSE, "tolerance": 1e-6, "scale": size}
        verification_record(f"annulus leaning about x, {name}", whole.quantities[name].value, [y, -x, z], **known)
        assert_kills(check, not_turned=([x, y, z],), other_way=([-y, x, z],))
    np.testing.assert_allclose(histories(whole), histories(half), rtol=1e-6)


@pytest.mark.slow
def test_the_shipped_case_follows_the_axisymmetric_one_up_to_the_threshold(verification_record):
    space, section = (load_case(CASES / name).experiment.run() for name in ("annulus_icf_3d.yaml", "annulus_icf.yaml"))
    assert space.status == section.status == "converged"
    apart = differences(space, section)
    check_differences(apart)
    names = ("threshold_force", "threshold_displacement")
    thresholds = np.array([space.quantities[name].value / section.quantities[name].value - 1 for name in names])
    check_differences(thresholds)
    known = {"reference": "annulus_icf", "kind": "invariance", "mesh": "annulus_icf_3d as shipped", "tolerance": DEMANDED}
    for name, difference in zip(names, thresholds, strict=True):
        verification_record(f"annulus_icf_3d, {name.replace('_', ' ')}", 1 + difference, 1.0, **known)
    assert_kills(check_differences, history=(with_force(apart, 1 / 4),), threshold=(with_force(thresholds, 1 / 4),))
