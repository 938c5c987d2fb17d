"""The durometer: balance of tissue and spring, its interval, the ends of the scale, scaling with the modulus, bad input."""

from __future__ import annotations

import pytest

from tactsim.analytic.durometer import DurometerScale
from tactsim.contact.rod import Rod
from tactsim.errors import CaseError
from tactsim.experiments.durometer.durometer import Durometer
from tactsim.experiments.durometer.force_depth_curve import ForceDepthCurve
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.materials.library import named_material
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.specimen import Specimen
from tactsim.plotting import figures_for

COARSE = MeshSettings(finest=0.5e-3, growth=1.5, adaptive=False)
HARD = NeoHookean(c10=135e3 / 6)


def measured(material=HARD, progress=None, **changes):
    specimen = Specimen(material=material, **changes.pop("specimen", {}))
    return Durometer(specimen=specimen, **({"mesh": COARSE} | changes)).run(progress)


def values(result):
    return {name: quantity.value for name, quantity in result.quantities.items()}


@pytest.fixture(scope="module")
def hard():
    return measured(stop="travel")


def test_tissue_and_spring_balance_at_the_reading(hard):
    quantities = values(hard)
    assert hard.status == "converged"
    spring = 0.203 + 0.00908 * quantities["reading"]
    assert quantities["spring_force"] == pytest.approx(spring, rel=1e-4)  # depth located to 1e-5 of the travel
    assert quantities["depth"] == pytest.approx(2.5e-3 * (1 - quantities["reading"] / 100), rel=1e-12)
    assert quantities["bottoms_out"] == 0
    assert hard.steps[-1].values["displacement"] == pytest.approx(2.5e-3)
    assert {name for step in hard.steps for name in step.values} <= set(hard.units)


def test_what_is_left_out_of_a_real_durometer_is_said(hard):
    assert any("recalled and not looked up; its presser foot" in text for text in hard.assumptions)


def test_the_interval_is_that_of_another_spring(hard):
    quantities = values(hard)
    stronger = values(measured(scale={"force_at_zero": 0.203 + 0.00908}))
    assert stronger["reading"] == pytest.approx(quantities["reading_low"], abs=0.05)  # a tenth of the interval: its curvature
    assert stronger["reading"] != pytest.approx(quantities["reading"], abs=0.05)
    assert quantities["reading_low"] < quantities["reading"] < quantities["reading_high"]


def test_the_default_penetration_is_small_beside_the_depth_in_a_hard_material():
    """It was that of soft tissue, and took more of the force away than is allowed: the run failed."""
    result = measured(NeoHookean(c10=10e6 / 6), mesh=MeshSettings(growth=0.8, adaptive=False))
    assert result.status == "converged"
    assert values(result)["penetration_force_error"] < 0.005
    assert values(result)["reading"] == pytest.approx(values(result)["hertz_reading"], abs=0.1)


def test_soft_tissue_bottoms_out():
    result = measured(NeoHookean(c10=1e3), scale={"travel": 0.5e-3})
    assert result.status == "converged"
    assert (values(result)["reading"], values(result)["bottoms_out"]) == (0, 1)
    assert "bottoms out" in result.reason
    assert "depth" not in result.quantities
    assert any("off the scale" in warning for warning in result.warnings)
    assert figures_for(result)["durometer.png"]().startswith(b"\x89PNG")


@pytest.fixture(scope="module")
def double():
    """Tissue and spring twice as stiff, to the reading instead of the whole travel."""
    return measured(NeoHookean(c10=135e3 / 3), scale={"force_at_zero": 2 * 0.203, "force_per_unit": 2 * 0.00908})


def test_the_run_ends_at_the_reading(hard, double):
    assert values(double)["reading"] == pytest.approx(values(hard)["reading"], abs=1e-6)
    assert double.steps[-1].values["displacement"] == values(double)["depth"]


def test_force_scales_with_the_modulus(hard, double):
    """To 1e-6 over the same steps: the same deformation whatever the modulus, up to the residual of Newton."""
    assert len(double.steps) > 5
    for mine, its in zip(double.steps[:-1], hard.steps, strict=False):  # the last one ends at the reading
        assert mine.values["displacement"] == pytest.approx(its.values["displacement"], rel=1e-6)
        assert mine.values["reaction_force"] == pytest.approx(2 * its.values["reaction_force"], rel=1e-6)


def test_a_scaled_curve_reads_what_a_direct_run_reads(hard):
    """To 0.05 units: friction remembers the steps, which end elsewhere, and the curve is interpolated between them."""
    direct = values(measured(NeoHookean(c10=200e3 / 6)))["reading"]
    scaled = ForceDepthCurve.of(hard, 135e3).reading(200e3, DurometerScale())
    assert scaled == pytest.approx(direct, abs=0.05)
    unscaled = ForceDepthCurve.of(hard, 200e3).reading(200e3, DurometerScale())
    assert unscaled != pytest.approx(direct, abs=0.05)


def test_an_interrupted_run_keeps_its_steps():
    def stop(step):
        if step.step == 3:
            raise KeyboardInterrupt

    result = measured(progress=stop)
    assert (result.status, len(result.steps)) == ("interrupted", 3)
    assert "reading" not in result.quantities


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"specimen": {"thickness": 5e-3}}, "at least 6 mm"),
        ({"material": named_material("atrial").material}, "no relaxation"),
        ({"scale": {"travel": 20e-3}}, r"scale\.travel 20 mm must be smaller than the specimen's thickness"),
        ({"indentor": Rod(radius=16e-3)}, "is too small for a body of radius 16 mm"),
        ({"spring_tolerance": -1.0}, "spring_tolerance"),
        ({"penetration_tolerance": 0.0}, "penetration_tolerance"),
        ({"stop": "threshold"}, "travel"),
    ],
)
def test_impossible_durometers_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        measured(**changes)


def test_a_narrow_specimen_is_warned_of():
    def interrupt(step):
        raise KeyboardInterrupt

    assert any(
        "edge of the specimen is 8 mm away" in warning
        for warning in measured(specimen={"radius": 8e-3}, progress=interrupt).warnings
    )


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("material", [HARD, "b1a_stable", "icf_stable"])
def test_the_whole_travel_is_reached(material, friction):
    """2.5 mm are 2.1 radii of the indentor."""
    result = measured(
        material, contact={"kind": "coulomb", "friction": friction}, stop="travel", mesh=MeshSettings(growth=0.8, adaptive=False)
    )
    assert result.status == "converged", result.reason
    assert result.quantities["unstable_volume_fraction"].value == 0
