"""The switch probe: what it reports, the ranking of its tissues, E26, the fast model beside finite elements, what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import text_of

from tactsim.case import load_case
from tactsim.contact.trapezoid import Trapezoid
from tactsim.errors import CaseError, ConvergenceError
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.switch_probe import run
from tactsim.experiments.switch_probe.figures import switch_panel_figure
from tactsim.experiments.switch_probe.run import force_noise, touched
from tactsim.experiments.switch_probe.setup import ProbeTissue
from tactsim.experiments.switch_probe.switch_probe import SwitchProbe
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.paths.step_policy import TimeSettings
from tactsim.plotting import figures_for
from tactsim.relaxation import Relaxation
from tactsim.results import Status
from tactsim.results.document import document_text
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.switch_array import SwitchArray
from tactsim.shipped import CASES

COARSE = {"mesh": MeshSettings(finest=0.4e-3, growth=0.8), "time": TimeSettings(tolerance=0.05, per_decade=0)}
pytestmark = pytest.mark.usefixtures("one_thread")


def tissue(*, c10=5e3, fractions=(0.9,), times=(6.0,), name="tissue"):
    return ProbeTissue(name=name, material=NeoHookean(c10=c10, relaxation=Relaxation(fractions=fractions, times=times)))


ELASTIC = ProbeTissue(name="elastic", material=NeoHookean(c10=5e3))


def probe(**changes):
    return SwitchProbe(**({"tissues": (tissue(),), "sides": "followed"} | changes))


@pytest.fixture(scope="module")
def three():
    return load_case(CASES / "switch_tissues.yaml").experiment.run()


def forces(result):
    """Force (tissue, rate, depth) in N at each mm."""
    shape = (len(result.scene.tissues), len(result.scene.rates), 5)
    return np.array([result.quantities[f"forces_{k + 1}"].value for k in range(shape[0] * shape[1])]).reshape(shape)


def test_the_rankings_of_figure_5_8(three):
    assert three.status is Status.CONVERGED
    assert three.scene.rates == (1e-3, 0.5e-3, 3e-3)
    first, second, third = forces(three)
    assert (second > first).all()
    assert (second > third).all()
    assert first[0, 4] > 1.05 * third[0, 4]
    assert first[1, 4] < 0.95 * third[1, 4], "the ranking changes with the rate"
    assert first[2, 4] > third[2, 4]
    spread = np.ptp(forces(three)[:, 0], axis=0)
    assert spread[0] < 0.025 * second[0, 4], "similar in the first mm, beside the largest force"
    assert spread[4] > 0.2 * second[0, 4]


def test_every_touch_is_read(three):
    for number, touch in enumerate(three.scene.touches, 1):
        assert touch.count == 1
        assert [closing.switch for closing in touch.closings] == [1, 2, 3, 4, 5]
        assert three.quantities[f"mean_rate_{number}"].value == pytest.approx(touch.rate, rel=0.03)
        intervals = three.quantities[f"switching_intervals_{number}"].value
        assert intervals[1:] == pytest.approx(
            1e-3 / touch.rate, rel=0.05
        )  # the pressure on each switch is higher, so its threshold is met sooner
        read, true = three.quantities[f"switching_forces_{number}"].value, three.quantities[f"forces_{number}"].value
        assert ((read < true * 1.05) & (read > true * 0.85)).all(), "half a strip early, late by the threshold"


def test_history_and_document(three):
    for step in three.steps:
        assert set(step.values) == set(SwitchProbe.history_units)
        assert np.isfinite(list(step.values.values())).all()
    assert "null" not in document_text(three, "case").replace('"mean_rate": null', "")


def test_the_same_seed_gives_the_same_touch():
    noisy = {"chain": SignalChain(noise=Noise(white=1e-3))}
    runs = [probe(seed=seed, **noisy).run() for seed in (1, 1, 2)]
    assert runs[0].steps == runs[1].steps
    assert runs[0].steps != runs[2].steps


def test_the_noise_is_that_of_the_readings():
    setup = probe(chain=SignalChain(noise=Noise(white=1e-3), low_pass=None))
    touch = touched(setup, setup.tissues[0], 1e-3, np.random.default_rng(4))
    resting = touch.force[touch.time < 0]
    assert resting.std() == pytest.approx(force_noise(setup), rel=0.2)  # four standard deviations of 200 samples
    pick_up = probe(chain=SignalChain(noise=Noise(line=1e-3), low_pass=None))
    assert resting.std() != pytest.approx(force_noise(pick_up), rel=0.2), "noise is not pick-up of that amplitude"


def test_computed_sides_are_touched_by_the_first_switch_only():
    result = probe(sides="computed").run()
    assert result.quantities["closed_switches_1"].value == 1
    assert "mean_rate_1" not in result.quantities
    assert any("no mean rate" in warning for warning in result.warnings)
    assert any("sinks in" in warning for warning in result.warnings)


def test_a_printed_mean_rate_is_a_third():
    printed = probe(array=SwitchArray(formula="as_printed")).run().quantities["mean_rate_1"].value
    corrected = probe().run().quantities["mean_rate_1"].value
    assert printed / corrected == pytest.approx(1 / 3, rel=0.02)


def test_curves_are_told_apart_without_colour(three):
    for axis in three.plot("force_over_depth").axes:
        curves = axis.get_legend().get_lines()
        assert len({curve.get_linestyle() for curve in curves}) == len(curves) == 3


def test_figures(three):
    drawings = figures_for(three)
    assert list(drawings) == ["force_over_depth.png", "switch_panel.png", "tissues_by_rate.png"]
    assert all(draw().startswith(b"\x89PNG") for draw in drawings.values())
    written = text_of(switch_panel_figure(three))
    for words in ("mean rate 1.02", "force sensor", "touch 1 of 9, tissue 1 at 1 mm/s; mean rate"):
        assert words in written
    single = probe(sides="computed").run()
    assert list(figures_for(single)) == ["force_over_depth.png", "switch_panel.png"]
    written = text_of(switch_panel_figure(single))
    assert "not every switch closed" in written


@pytest.mark.parametrize(("error", "status"), [(KeyboardInterrupt(), "interrupted"), (ConvergenceError("no luck"), "failed")])
def test_touches_made_before_a_stop_are_kept(monkeypatch, error, status):
    def stopped(setup, chosen, rate, generator):
        if rate == 3e-3:
            raise error
        return touched(setup, chosen, rate, generator)

    monkeypatch.setattr(run, "touched", stopped)
    result = probe(rates=(1e-3, 3e-3)).run()
    assert result.status == status
    assert "forces_1" in result.quantities
    assert "forces_2" not in result.quantities
    assert figures_for(result)["force_over_depth.png"]().startswith(b"\x89PNG")
    nothing = probe(rates=(3e-3,)).run()
    assert (nothing.status, nothing.steps, figures_for(nothing)) == (status, (), {})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rates": (0.0,)}, "greater than 0"),
        ({"rates": (1e-3, 1e-3)}, "two rates are 1 mm/s"),
        ({"tissues": (tissue(), tissue())}, "two tissues are named tissue"),
        ({"rates": (1e-6,)}, "sample more slowly"),
        ({"rates": (10.0,)}, "sample faster"),
        ({"depth": 6e-3}, "beyond the curve"),
        ({"depth": 25e-3}, "smaller than the height of the block"),
        ({"probe": Trapezoid(face=3e-3)}, "set model: fem"),
        ({"tissues": (ProbeTissue(name="b", material={"set": "b1a_stable"}),)}, "such a material or set model: fem"),
        ({"array": SwitchArray(count=4)}, "has 5 switches"),
        ({"sides": "guessed"}, "computed"),
    ],
)
def test_impossible_experiments_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        probe(**changes)


def test_finite_elements_on_a_coarse_mesh_agree_with_the_fast_model():
    given = {"depth": 2e-3, "sides": "computed"}
    fast = probe(**given).run()
    result = probe(model="fem", **COARSE, **given).run()
    assert result.status is Status.CONVERGED, result.reason
    expected = fast.quantities["forces_1"].value
    np.testing.assert_allclose(result.quantities["forces_1"].value, expected, rtol=0.02)  # the coarse mesh; see the slow test
    elastic = probe(tissues=(ELASTIC,), **given).run()
    assert not np.allclose(result.quantities["forces_1"].value, elastic.quantities["forces_1"].value, rtol=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(("rate", "fractions"), [(0.5e-3, (0.9,)), (1e-3, (0.9,)), (3e-3, (0.4,))])
def test_the_fast_model_is_the_finite_elements_within_two_percent(rate, fractions):
    given = {"tissues": (tissue(fractions=fractions),), "rates": (rate,), "sides": "computed"}
    fast, elements = (probe(model=model, **given).run() for model in ("fast", "fem"))
    expected = fast.quantities["forces_1"].value
    np.testing.assert_allclose(elements.quantities["forces_1"].value, expected, rtol=0.02)  # superposition at finite strain
    elastic = probe(**given | {"tissues": (ELASTIC,)}).run()
    assert not np.allclose(elements.quantities["forces_1"].value, elastic.quantities["forces_1"].value, rtol=0.02)
    heights = [run.quantities["contact_height_1"].value for run in (fast, elements)]
    assert heights[1] == pytest.approx(heights[0], rel=0.03)
    pressed = [max(step.values["switch_force_1"] for step in run.steps) for run in (fast, elements)]
    assert pressed[0] == pytest.approx(pressed[1], rel=0.35), (
        "a strip under the last edge of the contact; superposition is rough there"
    )


@pytest.mark.slow
def test_the_curve_is_that_of_the_finite_elements():
    fast, elements = (probe(model=model, tissues=(ELASTIC,), sides="computed").run() for model in ("fast", "fem"))
    np.testing.assert_allclose(elements.quantities["forces_1"].value, fast.quantities["forces_1"].value, rtol=2e-3)
    assert elements.quantities["contact_height_1"].value == pytest.approx(fast.quantities["contact_height_1"].value, rel=0.01)
    relaxing = probe(sides="computed").run()
    assert not np.allclose(elements.quantities["forces_1"].value, relaxing.quantities["forces_1"].value, rtol=2e-3)


def test_a_mark_stands_where_the_probe_was_as_the_switch_closed():
    """Beside tissue that does not follow the sides a switch at 1 mm closes at four times that depth, far from the curve."""
    result = probe(sides="computed").run()
    (axis,) = result.plot("force_over_depth").axes
    curve, marks = axis.lines[:2]
    assert len(marks.get_xdata()) == 1
    assert marks.get_xdata()[0] > 2.0
    assert np.interp(marks.get_xdata(), *curve.get_data()) == pytest.approx(marks.get_ydata(), rel=0.1)  # read through a low pass
