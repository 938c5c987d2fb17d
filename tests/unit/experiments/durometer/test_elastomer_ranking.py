"""The ranking of elastomers: inverse simulation by hand, scaling, rank correlations, the atrium, and bad input."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import pytest
from nested_runs import every_end, pretend_to_end

from tactsim.analytic.durometer import DurometerScale, hertz_force
from tactsim.case import load_case
from tactsim.errors import CaseError, ConvergenceError
from tactsim.experiments.durometer.durometer import Durometer
from tactsim.experiments.durometer.elastomer_ranking import AtriumTest, ElastomerRanking, SensorTest
from tactsim.experiments.durometer.elastomer_report import RankingReport, ShapeFinding
from tactsim.experiments.durometer.elastomers import STABLE_SHAPES, TABLE_3_3, Elastomer, Shape
from tactsim.experiments.durometer.force_depth_curve import ForceDepthCurve
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.interfaces.run import Course
from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.results.document import document_text

SCALE, RADIUS = DurometerScale(), 1.19e-3
QUICK = {"mesh": {"finest": 0.2e-3, "growth": 1.0, "adaptive": False}, "specimen": {"thickness": 4e-3, "radius": 7e-3}}
COARSE = {"finest": 0.5e-3, "growth": 1.5, "adaptive": False}
SENSOR = SensorTest(**QUICK, recess=0.2e-3, displacement=2e-3)


def finding(ratio=2.0, end=SCALE.travel):
    """A made-up shape: threshold pressure ``ratio`` times the modulus, durometer by Hertz."""
    depth = np.linspace(0, end, 201)
    curve = ForceDepthCurve(depth, hertz_force(depth, RADIUS, 1.0))
    return ShapeFinding(STABLE_SHAPES[2], 10e3, ratio * 10e3, 2e-3, curve, "" if end == SCALE.travel else "it gave up")


def report(*findings, elastomers=TABLE_3_3):
    made = RankingReport(elastomers, SCALE, RADIUS)
    for one in findings:
        list(made.add(one))
    return made


def quantities(made):
    return {name: quantity.value for name, quantity in made.findings(()).quantities.items()}


def test_modulus_and_reading_by_hand():
    """Pressure over the ratio; by Hertz a reading of 36 means 135 kPa."""
    numbers = quantities(report(finding()))
    expected = [one.threshold_pressure / 2 for one in TABLE_3_3]
    np.testing.assert_allclose(numbers["modulus_of_threshold"][0], expected, rtol=1e-14)  # round-off
    assert numbers["modulus_of_reading"][0][3] == pytest.approx(135e3, abs=500)
    assert numbers["modulus_ratio"][0][3] == pytest.approx(135e3 / 11.15e3, rel=0.004)


def test_a_prediction_that_is_right_leaves_no_difference():
    """Elastomers whose threshold is twice the modulus that their reading means."""
    moduli = [finding().curve.modulus(one.durometer, SCALE) for one in TABLE_3_3]
    pairs = zip(TABLE_3_3, moduli, strict=True)
    agreeing = tuple(one.model_copy(update={"threshold_pressure": 2 * modulus}) for one, modulus in pairs)
    numbers = quantities(report(finding(), elastomers=agreeing))
    np.testing.assert_allclose(numbers["reading_difference"], 0, atol=1e-9)
    assert numbers["spearman_predicted_durometer"] == [pytest.approx(1, abs=1e-12)]
    wrong = quantities(report(finding(2.02), elastomers=agreeing))
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(wrong["reading_difference"], 0, atol=1e-9)


def test_a_swapped_pair_lowers_the_rank_correlation():
    """1 - 6 * 2 / (7 * 48) for two neighbours."""
    first, second, *rest = TABLE_3_3
    swapped = (first.model_copy(update={"hand": 6}), second.model_copy(update={"hand": 7}), *rest)
    assert quantities(report(finding(), elastomers=swapped))["spearman_durometer_hand"] == pytest.approx(27 / 28, abs=1e-12)


def test_readings_off_the_scale_share_a_rank():
    findings = report(finding(200.0)).findings(())
    assert findings.quantities["predicted_reading"].value == [[0.0] * 7]
    assert findings.quantities["spearman_predicted_durometer"].value == [None]
    assert "smallest_spearman_predicted_durometer" not in findings.quantities
    assert "bottoms out on H1-N, B1" in findings.warnings[0]
    with patch.object(ElastomerRanking, "begin", lambda experiment: Course.computed(findings)):
        assert "is not finite" not in document_text(ElastomerRanking.example().run(), "0" * 16)


def test_a_curve_that_was_cut_short_is_reported():
    findings = report(finding(end=1e-3)).findings(())
    assert "predicted_reading" not in findings.steps[-1].values
    assert "modulus_of_reading" not in findings.steps[-1].values
    assert "ended early, it gave up" in findings.warnings[0]


def test_an_interruption_leaves_no_half_of_a_shape():
    begun = RankingReport(TABLE_3_3, SCALE, RADIUS)
    next(begun.add(finding()))
    assert len(begun.findings(()).steps) == len(TABLE_3_3)


def test_the_atrium():
    made = report(finding())
    made.add_atrium(25.0, (0.01, 1.0), 0)
    numbers = quantities(made)
    assert numbers["atrium_modulus_by_hertz"] == pytest.approx(86.4e3, abs=100)  # 0.43 N at 1.875 mm by hand
    assert numbers["atrium_table_modulus"][-1] == pytest.approx(1e6 / 1708.08, rel=1e-5)  # errata E7, 1/MPa to two decimals
    assert numbers["atrium_table_modulus"][0] == pytest.approx(56.45258219e6, rel=1e-9)
    assert numbers["atrium_reading_relaxed"] == 0
    assert numbers["atrium_reading_instantaneous"] > 98
    assert 1e-3 < numbers["atrium_time"] < 1e-2


@pytest.fixture(scope="module")
def ranked():
    steps = []
    made = ElastomerRanking(shapes=STABLE_SHAPES[2:], sensor=SENSOR, durometer={"mesh": COARSE})
    return made.run(steps.append), steps


def test_the_whole_run(ranked):
    result, steps = ranked
    assert result.status == "converged"
    assert list(result.steps) == steps[-7:]
    assert len(result.steps) == 7 < len(steps), "those of the simulations come before"
    assert {name for step in result.steps for name in step.values} == set(result.units)
    assert {name for step in steps for name in step.values} <= set(ElastomerRanking.history_units)
    moduli = result.quantities["modulus_of_threshold"].value[0]
    pressure = result.quantities["own_threshold_pressure"].value[0]
    assert moduli[0] / 10e3 == pytest.approx(89.8e3 / pressure, rel=1e-12)
    assert any("thesis prints none" in text for text in result.assumptions)


def test_the_threshold_scales_with_the_modulus():
    """To 1e-6, up to the residual of Newton and the location of the event."""
    pressures = []
    for factor in (1.0, 2.0):
        result = SENSOR.of(Shape(name="a", material=NeoHookean(c10=factor * 10e3 / 6))).run()
        pressures.append(result.quantities["threshold_pressure"].value)
    assert pressures[1] == pytest.approx(2 * pressures[0], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("shape", STABLE_SHAPES[:2], ids=lambda shape: shape.name)
def test_the_threshold_scales_for_every_shape(shape):
    """As above, for the sensor as shipped."""
    terms = {name: 2 * value for name, value in shape.material.model_dump(include={"c10", "c01", "c11"}).items()}
    computed = [
        SensorTest().of(Shape(name="a", material=material)).run().quantities["threshold_pressure"].value
        for material in (shape.material, MooneyRivlin3(**terms))
    ]
    assert computed[1] == pytest.approx(2 * computed[0], rel=1e-6)


def test_a_threshold_that_is_not_reached_is_a_failure():
    short = SENSOR.model_copy(update={"displacement": 0.05e-3})
    result = ElastomerRanking(
        shapes=STABLE_SHAPES[2:], sensor=short, durometer={"mesh": COARSE, "scale": {"travel": 0.1e-3}}
    ).run(lambda step: None)
    assert result.status == "failed"
    assert "neo-Hookean: sensor the threshold was not reached" in result.reason
    assert result.steps == ()


@every_end
def test_what_ends_a_simulation_ends_the_ranking(monkeypatch, error, status, reason):
    for kind in (Indentation, Durometer):
        pretend_to_end(monkeypatch, kind, error)
    result = ElastomerRanking.example().run()
    own = "neo-Hookean: sensor " if isinstance(error, ConvergenceError) else ""
    assert (result.status, result.steps, result.quantities) == (status, (), {})
    assert result.reason.startswith(own + reason)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"elastomers": TABLE_3_3[:2]}, "at least 3 entries"),
        ({"elastomers": (*TABLE_3_3, TABLE_3_3[0])}, "two elastomers have the same name"),
        ({"shapes": STABLE_SHAPES[:1] * 2}, "two shapes have the same name"),
        ({"shapes": ({"name": "a", "material": "atrial"},)}, "without relaxation, or it does not scale"),
        ({"shapes": ({"name": "a", "material": {"set": "icf_stable", "bulk_modulus": 1e6}},)}, "must be incompressible"),
        ({"shapes": ({"name": "a", "material": "icf_stable", "constants_of": "IFC"},)}, "is none of the elastomers"),
        ({"atrium": AtriumTest(shape="rubber")}, "is none of the shapes"),
        ({"durometer": {"specimen": {"thickness": 5e-3}}}, "at least 6 mm"),
        ({"sensor": {"recess": 11e-3}}, "recess: 11 mm must be smaller"),
        ({"atrium": {"reading": 100}}, "less than 100"),
        ({"atrium": {"times": [0.0]}}, "greater than 0"),
    ],
)
def test_what_cannot_be_ranked_is_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        ElastomerRanking(**changes)


@pytest.mark.parametrize("changes", [{"durometer": -1}, {"durometer": 100}, {"threshold_pressure": 0.0}, {"name": ""}])
def test_an_impossible_elastomer_is_refused(changes):
    with pytest.raises(CaseError, match=next(iter(changes))):
        Elastomer(**({"name": "a", "durometer": 1, "hand": 1, "threshold_pressure": 1.0} | changes))


@pytest.mark.slow
def test_the_shipped_case(request):
    result = load_case(request.config.rootpath / "cases" / "elastomers.yaml").experiment.run()
    assert result.status == "converged"
    assert np.array(result.quantities["modulus_ratio"].value).min() > 1, (
        "the durometer finds every elastomer harder than the sensor"
    )
