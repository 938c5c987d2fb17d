"""The main job: located threshold, balance, penetration and friction cone; independence of mesh and steps; its range."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.case import load_case
from tactsim.experiments.indentation.course import DisplacementPath
from tactsim.experiments.indentation.record import IndentationRecord

MESH_TOLERANCE = 1e-3
STEP_TOLERANCE = 0.005
RECESS = 0.8e-3
RADIUS = 3e-3


def pressed(case, *overrides):
    return load_case(f"cases/{case}.yaml", overrides).experiment.run()


def threshold_pressures(case, *overrides):
    """Pressure in Pa at the touch, and the mutant: that of the accepted step before it."""
    result = pressed(case, *overrides)
    assert result.status == "converged", result.reason
    located, force = (result.quantities[name].value for name in ("threshold_pressure", "threshold_force"))
    return located, located * result.steps[-2].values["reaction_force"] / force


@pytest.fixture(scope="module", autouse=True)
def in_root(request):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(request.config.rootpath)
        yield


@pytest.fixture(scope="module", params=[0.25, pytest.param(1.0, marks=pytest.mark.slow)], ids=["coarse", "whole"])
def icf(request):
    """The record of the shipped case and its accepted states, on a coarse mesh and on its own."""
    experiment = load_case("cases/annulus_icf.yaml", [f"experiment.mesh.refinement={request.param}"]).experiment
    model = experiment.model()
    path = DisplacementPath(experiment, experiment.drive(), model)
    record = IndentationRecord(experiment, model, path)
    states = []
    for state, touched in path.states(record.adapted):
        record.accept(state, event=touched)
        states.append(state.contact)
    return record, states


def test_threshold_is_located(icf, verification_record):
    record, states = icf
    assert record.event is record.steps[-1]
    before, rise = (record.model.rise(state, record.setup.body.inner_radius)[0] for state in states[-2:])
    assert abs(rise - RECESS) < 1e-4 * RECESS
    known = {"reference": "the recess", "kind": "exact", "mesh": "main job", "tolerance": 1e-4}
    verification_record("rise of the tissue at the threshold", rise, RECESS, **known)
    assert abs(before - RECESS) > 3e-4 * RECESS, "the step before is no threshold"


def test_penetration_and_balance_hold_at_every_step(icf, verification_record):
    """Mutants: the force per radian, and the reaction of the step before."""
    record, _ = icf
    penetration, base, reaction = (
        np.array([step.values[name] for step in record.steps]) for name in ("max_penetration", "base_force", "reaction_force")
    )
    assert (penetration < 1e-4 * RADIUS).all()

    def check(base, reaction):
        np.testing.assert_allclose(base, reaction, rtol=1e-8)

    check(base, reaction)
    known = {"reference": "balance of contact and base", "kind": "invariance", "mesh": "main job", "tolerance": 1e-8}
    verification_record("forces at every accepted step", base / reaction, np.ones_like(base), **known)
    known = {"reference": "none: the tolerance of the case", "kind": "invariance", "mesh": "main job", "tolerance": 1e-4}
    verification_record("largest penetration over the radius", penetration.max(), 0.0, scale=RADIUS, **known)
    assert_kills(check, per_radian=(base / (2 * np.pi), reaction), step_before=(base[1:], reaction[:-1]))


def test_friction_stays_inside_its_cone(icf, verification_record):
    """Mutant: a friction coefficient lower by a hundredth, as some of the surface slips."""
    _, states = icf

    def check(share):
        beyond, largest = 0.0, 0.0
        for state in states:
            contact = state.contacts[0]
            size = np.linalg.norm(contact.state.tangential, axis=0)
            limit = share * contact.pair.law.traction_limit(contact.state.pressure)
            assert (size <= limit * (1 + 1e-8)).all()
            beyond, largest = max(beyond, (size - limit).max()), max(largest, limit.max())
        return beyond, largest

    beyond, largest = check(1.0)
    known = {"reference": "Coulomb's cone", "kind": "invariance", "mesh": "main job", "tolerance": 1e-8}
    verification_record("traction beyond its limit, over the largest limit", beyond, 0.0, scale=largest, **known)
    assert_kills(check, friction=(0.99,))


def test_force_and_rise_do_not_fall_with_the_indentation(icf):
    """Mutants: what is left of the recess for the rise, and the force on the tissue for that on the annulus."""
    record, _ = icf
    displacement, force, rise = (
        np.array([step.values[name] for step in record.steps]) for name in ("displacement", "reaction_force", "tissue_rise")
    )

    def check(displacement, force, rise):
        for values in (displacement, force, rise):
            assert (np.diff(values) > 0).all()

    check(displacement, force, rise)
    assert_kills(check, left=(displacement, force, RECESS - rise), on_the_tissue=(displacement, -force, rise))


def check_halved_steps(case, whole, verification_record, refinement=1.0):
    def check(halved):
        assert halved == pytest.approx(whole, rel=STEP_TOLERANCE)

    steps = "experiment.steps.largest=0.075 mm", "experiment.steps.first=1.5 um"
    halved, before = threshold_pressures(case, *steps, f"experiment.mesh.refinement={refinement}")
    check(halved)
    known = {"reference": "half the steps", "kind": "invariance", "mesh": f"{case}, refinement {refinement:g}"}
    verification_record("threshold pressure", whole, halved, tolerance=STEP_TOLERANCE, **known)
    assert_kills(check, not_located=(before,))


def test_halved_steps_change_little(icf, verification_record):
    record, _ = icf
    whole = record.event.values["reaction_force"] / record.setup.body.area
    check_halved_steps("annulus_icf", whole, verification_record, record.setup.mesh.refinement)


@pytest.mark.slow
def test_halved_steps_change_little_on_stiffer_tissue(verification_record):
    whole, _ = threshold_pressures("annulus_b1a")
    check_halved_steps("annulus_b1a", whole, verification_record)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["annulus_icf", "annulus_b1a"])
def test_halved_mesh_changes_little(case, verification_record):
    whole, _ = threshold_pressures(case)

    def check(halved):
        assert halved == pytest.approx(whole, rel=MESH_TOLERANCE)

    halved, before = threshold_pressures(case, "experiment.mesh.refinement=2")
    check(halved)
    known = {"reference": "elements of half the size", "kind": "invariance", "mesh": f"{case}, refinement 1"}
    verification_record("threshold pressure", whole, halved, tolerance=MESH_TOLERANCE, **known)
    assert_kills(check, not_located=(before,))


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("thickness", [3, 10, 30])
@pytest.mark.parametrize("case", ["annulus_icf", "annulus_b1a"])
def test_no_threshold_is_missed_over_thickness_and_friction(case, thickness, friction):
    """Mutant: the accepted step before the touch."""
    most = f"experiment.displacement={min(0.9 * thickness, 12)} mm"
    thick = f"experiment.specimen.thickness={thickness} mm"
    result = pressed(case, thick, most, f"experiment.contact.friction={friction}")
    assert result.status == "converged", result.reason
    before, rise = (step.values["tissue_rise"] for step in result.steps[-2:])

    def check(rise):
        assert rise == pytest.approx(RECESS, rel=1e-4)

    check(rise)
    assert_kills(check, not_located=(before,))


@pytest.mark.slow
@pytest.mark.parametrize("case", ["annulus_icf_printed", "annulus_b1a_printed"])
def test_printed_constants_are_not_taken_for_stable_ones(case):
    result = pressed(case)
    if result.status == "converged":
        assert result.quantities["unstable_volume_fraction"].value > 0
        assert any("strong ellipticity" in warning for warning in result.warnings)
    else:
        assert result.status == "failed"
        assert "gave up at" in result.reason
