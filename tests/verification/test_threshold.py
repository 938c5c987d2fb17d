"""The main job: located threshold, balance, penetration and friction cone; independence of mesh and steps; its range."""

from __future__ import annotations

import time

import numpy as np
import pytest

from tactsim.case import load_case
from tactsim.experiments.indentation.path import indentation_path
from tactsim.experiments.indentation.record import IndentationRecord

MESH_TOLERANCE = 0.01
STEP_TOLERANCE = 0.005
RECESS = 0.8e-3
RADIUS = 3e-3


def pressed(case, *overrides):
    return load_case(f"cases/{case}.yaml", overrides).experiment.run(lambda step: None)


def threshold_pressure(case, *overrides):
    result = pressed(case, *overrides)
    assert result.status == "converged", result.reason
    return result.quantities["threshold_pressure"].value


@pytest.fixture(scope="module", autouse=True)
def in_root(request):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(request.config.rootpath)
        yield


@pytest.fixture(scope="module")
def icf():
    experiment = load_case("cases/annulus_icf.yaml").experiment
    model = experiment.model()
    record = IndentationRecord(experiment, model, time.perf_counter())
    states = []
    for state, touched in indentation_path(experiment, model, record):
        record.accept(state, threshold=touched)
        states.append(state)
    return record, states


def test_threshold_is_located(icf):
    record, states = icf
    assert record.has_threshold
    rise = record.rise(states[-1])[0]
    assert abs(rise - RECESS) < 1e-4 * RECESS
    assert abs(record.rise(states[-2])[0] - RECESS) > 3e-4 * RECESS, "the step before is no threshold"


def test_penetration_and_balance_hold_at_every_step(icf):
    record, _ = icf
    for step in record.steps:
        assert step.values["max_penetration"] < 1e-4 * RADIUS
        assert step.values["base_force"] == pytest.approx(step.values["reaction_force"], rel=1e-8)


def test_friction_stays_inside_its_cone(icf):
    _, states = icf
    for state in states:
        contact = state.contacts[0]
        size = np.linalg.norm(contact.state.tangential, axis=0)
        limit = contact.pair.law.traction_limit(contact.state.pressure)
        assert (size <= limit * (1 + 1e-8)).all()
    assert (size > limit * (1 - 3e-8))[limit > 0].any(), "some of the surface slips"


def test_force_and_rise_grow_with_the_indentation(icf):
    record, _ = icf
    for name in ("displacement", "reaction_force", "tissue_rise"):
        assert (np.diff([step.values[name] for step in record.steps]) > 0).all(), name


def check_halved_steps(case, whole):
    halved = threshold_pressure(case, "experiment.steps.largest=0.075 mm", "experiment.steps.first=1.5 um")
    assert halved == pytest.approx(whole, rel=STEP_TOLERANCE)
    assert halved != whole, "the steps were other ones"


def test_halved_steps_change_little(icf):
    record, _ = icf
    check_halved_steps("annulus_icf", record.threshold["reaction_force"] / record.experiment.body.area)


@pytest.mark.slow
def test_halved_steps_change_little_on_stiffer_tissue():
    check_halved_steps("annulus_b1a", threshold_pressure("annulus_b1a"))


@pytest.mark.slow
@pytest.mark.parametrize("case", ["annulus_icf", "annulus_b1a"])
def test_halved_mesh_changes_little(case):
    whole = threshold_pressure(case)
    halved = threshold_pressure(case, "experiment.mesh.refinement=2")
    assert halved == pytest.approx(whole, rel=MESH_TOLERANCE)
    assert halved != whole, "the mesh was another one"


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("thickness", [3, 10, 30])
@pytest.mark.parametrize("case", ["annulus_icf", "annulus_b1a"])
def test_threshold_is_reached_over_thickness_and_friction(case, thickness, friction):
    most = f"experiment.displacement={min(0.9 * thickness, 12)} mm"
    thick = f"experiment.specimen.thickness={thickness} mm"
    assert threshold_pressure(case, thick, most, f"experiment.contact.friction={friction}") > 0


@pytest.mark.slow
def test_a_rise_that_falls_again_is_told():
    """Without friction, tissue that stiffens in tension slips out of the hole before it is full."""
    stiffening = "{kind: mooney_rivlin_5, c10: -5787.3 Pa, c01: 7537.6 Pa, c20: 8682.4 Pa, c11: 0 Pa, c02: 0 Pa}"
    result = pressed("annulus_icf", "experiment.contact.friction=0", f"experiment.specimen.material={stiffening}")
    assert result.status == "failed"
    assert "peaked at" in result.reason
    highest = max(step.values["tissue_rise"] for step in result.steps)
    assert highest == pytest.approx(0.574e-3, rel=0.01), (
        "the steps sample the peak; a mesh 1.5 times finer gave the same 0.574 mm"
    )
    assert highest != pytest.approx(0.574e-3 * 1.03, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["annulus_icf_printed", "annulus_b1a_printed"])
def test_printed_constants_end_with_the_right_status(case):
    result = pressed(case)
    if result.status == "converged":
        assert result.quantities["unstable_volume_fraction"].value > 0
        assert any("strong ellipticity" in warning for warning in result.warnings)
    else:
        assert result.status == "failed"
        assert "gave up at" in result.reason
