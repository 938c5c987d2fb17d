"""The annulus on tetrahedra against the axisymmetric model, its symmetric parts against each other, and balance when it leans."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from tactsim.case import load_case
from tactsim.contact.annulus import Annulus
from tactsim.experiments.indentation.contact_setup import MeshSettings
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.indentation_3d import SpaceIndentation, space_indentation_path
from tactsim.experiments.indentation.record_3d import SpaceIndentationRecord
from tactsim.experiments.indentation.setup_3d import SpaceMeshSettings
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.solid_model import SweepSymmetry
from tactsim.mechanics.specimen import Specimen

CASES = Path(__file__).parents[2] / "cases"
THIN = {
    "specimen": Specimen(material=NeoHookean(c10=1000.0), thickness=3e-3, radius=7e-3),
    "body": Annulus(fillet=0.5e-3),
    "recess": 0.2e-3,
    "stop": "displacement",
    "displacement": 0.1e-3,
    "steps": {"first": 0.05e-3},
    "penetration_tolerance": 2e-7,
}
SIZES = {"finest": 0.5e-3, "growth": 1.5, "adaptive": False}
TILT = 0.02
"""In rad: the outer edge stands 0.06 mm lower than the middle."""
DEMANDED = 0.02
"""Part of the axisymmetric force and rise by which the shipped case may differ."""


class Half(SpaceIndentation):
    """As upright as a quarter, on twice its elements."""

    @property
    def symmetry(self):
        return SweepSymmetry.HALF


def posed(kind=SpaceIndentation, **changes):
    return kind(**(THIN | {"mesh": SpaceMeshSettings(sectors=2, **SIZES)} | changes))


def histories(result):
    """Displacement, force and rise (steps, 3) in m, N and m."""
    names = ("displacement", "reaction_force", "tissue_rise")
    return np.array([[step.values[name] for name in names] for step in result.steps])


def differences(result, reference):
    """Relative differences (steps, 2) of force and rise from the reference at the same displacements."""
    found, known = histories(result), np.vstack([np.zeros(3), histories(reference)])
    found = found[found[:, 0] <= known[-1, 0]]
    expected = np.stack([PchipInterpolator(known[:, 0], known[:, k])(found[:, 0]) for k in (1, 2)], axis=1)
    return found[:, 1:] / expected - 1


@pytest.fixture(scope="module")
def quarter():
    return posed().run(lambda step: None)


def test_a_quarter_presses_like_the_axisymmetric_model(quarter):
    section = Indentation(**(THIN | {"mesh": MeshSettings(**SIZES)})).run(lambda step: None)
    assert quarter.status == section.status == "converged"
    assert quarter.details["symmetry"] == "quarter"
    apart = np.abs(differences(quarter, section)[-1])
    assert apart.max() < DEMANDED, apart  # on elements as long as the fillet is wide, touched at other points than the section's
    force = section.quantities["reaction_force"].value
    assert abs(force / 4 / quarter.quantities["reaction_force"].value - 1) > DEMANDED, "the force of a quarter is told from it"


def test_forces_balance_and_the_upright_annulus_feels_no_moment(quarter):
    values = {name: quantity.value for name, quantity in quarter.quantities.items()}
    assert values["reaction_force"] == pytest.approx(values["base_force"], rel=1e-8)
    np.testing.assert_array_equal(values["force_vector"][:2], 0.0)
    np.testing.assert_array_equal(values["moment_vector"], 0.0)
    around, area = np.array(values["pressure_around"]), THIN["body"].area
    assert around.mean() * area == pytest.approx(values["reaction_force"], rel=1e-10)
    assert around[1:].mean() * area != pytest.approx(values["reaction_force"], rel=1e-10) or np.ptp(around) < 1e-8 * around[0]


@pytest.mark.slow
def test_half_a_body_is_two_quarters(quarter):
    half = posed(Half).run(lambda step: None)
    assert half.details["unknowns"] > 1.7 * quarter.details["unknowns"]
    assert len(half.steps) == len(quarter.steps)
    np.testing.assert_allclose(histories(half), histories(quarter), rtol=1e-6)  # Newton's tolerance, and steps that add it up
    np.testing.assert_allclose(half.quantities["moment_vector"].value, 0.0, atol=1e-9 * half.quantities["reaction_force"].value)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(histories(half)[:, 1] / 2, histories(quarter)[:, 1], rtol=3e-6)


def test_a_leaning_annulus_is_held_in_balance_by_the_base():
    coarse = SpaceMeshSettings(sectors=2, **(SIZES | {"finest": 0.6e-3}))  # balance holds on any mesh
    experiment = posed(tilt_y=TILT, displacement=0.04e-3, mesh=coarse)
    model = experiment.space_model()
    record = SpaceIndentationRecord(experiment, model, time.perf_counter())
    *_, (state, _) = space_indentation_path(experiment, model, record)
    force, moment = model.load_on(state.contacts[0], state.unknowns)
    u, _ = model.space.split(state.unknowns)
    internal = model.body.residual(state.unknowns)[: u.size].reshape(-1, 3)[model.base_nodes]
    arms = (model.mesh.nodes + u)[model.base_nodes] - state.contacts[0].place
    expected = 2 * np.cross(arms, internal).sum(axis=0) * [0, 1, 0]
    assert abs(expected[1]) > 0.1e-3 * force[2], "the force acts away from the axis"
    np.testing.assert_allclose(moment, expected, atol=1e-8 * abs(expected[1]))  # Newton's tolerance is 1e-10
    assert not np.allclose(moment / 2, expected, atol=3e-8 * abs(expected[1]))
    np.testing.assert_allclose(model.base_force(state.unknowns), force, atol=1e-8 * force[2])


@pytest.mark.slow
def test_leaning_about_x_is_leaning_about_y_turned_by_a_right_angle():
    half, whole = (posed(displacement=0.04e-3, **{axis: TILT}).run(lambda step: None) for axis in ("tilt_y", "tilt_x"))
    assert (half.details["symmetry"], whole.details["symmetry"]) == ("half", "whole")
    for name in ("force_vector", "moment_vector"):
        x, y, z = half.quantities[name].value
        size = np.abs(half.quantities[name].value).max()
        np.testing.assert_allclose(whole.quantities[name].value, [y, -x, z], atol=1e-6 * size)  # as for the half and quarter
        assert not np.allclose(whole.quantities[name].value, [x, y, z], atol=3e-6 * size)
    np.testing.assert_allclose(histories(whole), histories(half), rtol=1e-6)


@pytest.mark.slow
def test_the_shipped_case_follows_the_axisymmetric_one_up_to_the_threshold():
    space, section = (
        load_case(CASES / name).experiment.run(lambda step: None) for name in ("annulus_icf_3d.yaml", "annulus_icf.yaml")
    )
    assert space.status == section.status == "converged"
    apart = np.abs(differences(space, section))
    assert apart.max() < DEMANDED, apart.max(axis=0)
    for name in ("threshold_force", "threshold_displacement"):
        exact = section.quantities[name].value
        assert abs(space.quantities[name].value / exact - 1) < DEMANDED, name
