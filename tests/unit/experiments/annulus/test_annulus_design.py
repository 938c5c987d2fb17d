"""The design map of the annular sensor: its arrays by hand, the design point of the thesis, limits, and its figure."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import cut_words, unmarked_figures

from tactsim.analytic.atrial import table_4_1
from tactsim.analytic.force_factor import force_factor, rise_factor
from tactsim.case import load_case
from tactsim.errors import CaseError
from tactsim.experiments.annulus.annulus_design import AnnulusDesign, AtrialTissue
from tactsim.plotting import figures_for
from tactsim.results import Status
from tactsim.results.document import document_text, parse_document, result_of
from tactsim.shipped import CASES

SHIPPED = CASES / "design_annulus.yaml"
THESIS = AtrialTissue(times="viscosities", compliance="half_shear")
GIVEN = {"ratios": (0.1, 0.5), "recesses": (0.1e-3, 0.7e-3, 5e-3), "forces": (1.0, 3.0), "times": (0.5, 5.0)}


def design(**changes):
    return AnnulusDesign(**(GIVEN | changes))


def run(**changes):
    return design(**changes).run()


def values(result):
    return {name: np.array(quantity.value, dtype=float) for name, quantity in result.quantities.items()}


@pytest.fixture(scope="module")
def thesis():
    return run(tissue=THESIS)


def test_the_map_is_that_of_the_formula(thesis):
    """eps0 = p D / (4 ro kappa) as in eq. 4.6.4, with the exact kappa and rise."""
    quantities = values(thesis)
    compliance = table_4_1("viscosities").creep([0.5, 5.0])
    ratio = np.array([0.1, 0.5])
    displacement = np.array([1.0, 3.0])[:, None] * compliance / (4 * 3e-3 * force_factor(ratio))[:, None, None]
    rise = rise_factor(ratio)[:, None, None] * displacement
    np.testing.assert_allclose(quantities["displacement"], displacement, rtol=1e-12)  # round-off
    np.testing.assert_allclose(quantities["rise"], rise, rtol=1e-12)
    np.testing.assert_allclose(quantities["force_to_touch"][1, 1], 0.7e-3 / rise[1, 0], rtol=1e-12)
    assert quantities["touches"].shape == (2, 3, 2, 2)
    assert (quantities["touches"] == (rise[:, None] >= np.array(GIVEN["recesses"])[:, None, None])).all()
    printed = 1.0 * compliance / (4 * 3e-3 * force_factor(ratio, "thesis_4_2_21"))[:, None]
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(quantities["displacement"][:, 0], printed, rtol=1e-12)


def test_the_design_point_of_the_thesis_does_not_touch(thesis):
    """Errata E10: eps0 = 1.925 mm is beyond 0.7 mm, but the tissue rises by 0.08 mm only."""
    quantities = values(thesis)
    assert quantities["point_displacement_printed"] == pytest.approx(1.925e-3, abs=5e-7)
    assert quantities["point_touches_printed"] == 1
    assert quantities["point_rise"] == pytest.approx(0.078e-3, abs=5e-7)
    assert quantities["point_touches"] == 0
    assert quantities["point_force_to_touch"] > 3
    assert "does not touch" in thesis.reason
    with pytest.raises(AssertionError):
        assert quantities["point_rise"] == pytest.approx(0.08e-3, abs=5e-7)


def test_a_sensor_touches_from_its_force_and_time_on(thesis):
    quantities = values(thesis)
    force, moment, touches = quantities["force_to_touch"], quantities["time_to_touch"], quantities["touches"]
    by_force = np.array(GIVEN["forces"])[:, None] >= force[:, :, None]
    by_time = np.array(GIVEN["times"]) >= np.nan_to_num(moment, nan=np.inf)[..., None]
    assert (by_force == touches).all()
    assert (by_time == touches).all()
    assert touches.any()
    assert not touches.all()


def test_a_sensor_that_is_never_touched_has_no_time():
    result = run(recesses=(0.7e-3, 50e-3))
    assert result.quantities["time_to_touch"].value[0][1][0] is None
    touched, never = (step.values for step in result.steps[:2])
    assert "time_to_touch_recommended" in touched
    assert "time_to_touch_recommended" not in never
    document = document_text(result, "0" * 16)
    assert "is not finite" not in document
    assert result_of(parse_document(document, "result.json")).quantities["time_to_touch"].value[0][1][0] is None


def test_small_displacements_are_distinguished(thesis):
    quantities = values(thesis)
    assert (quantities["outside_small_displacement"] == (quantities["displacement"] / 3e-3 > 0.1)).all()
    assert len(thesis.warnings) == 2
    stiff = run(recesses=(1e-6, 2e-6), forces=(0.001, 0.002))
    assert stiff.warnings == ()


def test_the_deepest_recess_is_touched_just_so(thesis):
    depth = values(thesis)["deepest_recess_largest"]
    again = run(tissue=THESIS, recesses=(float(depth[0, 0]), float(depth[1, 0])))
    assert values(again)["force_to_touch"][[0, 1], [0, 1], 0] == pytest.approx(3.0, rel=1e-12)  # round-off


def test_a_thin_layer_rises_more_for_its_displacement():
    half_space, layer = (values(run(thickness=t, forces=(0.5, 1.0))) for t in (None, 4e-3))
    assert (layer["rise"] / layer["displacement"] > half_space["rise"] / half_space["displacement"]).all()
    assert (layer["displacement"] < half_space["displacement"]).all()


def test_what_would_go_through_a_layer_has_no_value_and_is_drawn():
    """3 N press an annulus of 3 mm into 1 mm of tissue by more than that within 5 s, by linear theory; it stands on the base."""
    result = run(ratios=(0.3, 0.9), thickness=1e-3)
    quantities = values(result)
    displacement, depth = quantities["displacement"], quantities["touch_displacement_over_radius"]
    assert np.nanmax(displacement) < 1e-3
    assert np.isnan(displacement).tolist() == np.isnan(quantities["rise"]).tolist()
    assert np.isnan(displacement[1, 1, 1])
    assert np.isnan(depth[:, 2]).all()  # a recess of 5 mm: neither is touched
    assert np.isfinite(depth[:, 0]).all()
    assert not quantities["touches"][:, 2].any()
    assert quantities["touches"][1, 0, 1, 1]  # touched on the way
    for name in ("force_to_touch", "time_to_touch"):
        assert np.isnan(quantities[name][:, 2]).all()
    assert any("base of the layer" in warning for warning in result.warnings)
    assert figures_for(result)["annulus_design.png"]().startswith(b"\x89PNG")


def test_a_design_point_that_goes_through_a_layer_is_said_to():
    result = run(thickness=1e-3, design_point={"ratio": 0.9, "recess": 0.1e-3, "force": 3.0, "time": 5.0})
    assert (result.quantities["point_rise"].value, result.quantities["point_touches"].value) == (None, 1)
    assert "pressed to the base of the layer; the tissue touches before" in result.reason
    assert "presses to the base" in result.plot("annulus_design").axes[-2].texts[-1].get_text()


def test_history_and_progress():
    steps = []
    result = design().run(steps.append)
    assert result.status is Status.CONVERGED
    assert [step.values["recess"] for step in steps] == [*GIVEN["recesses"]] * 2
    assert {name for step in steps for name in step.values} == set(AnnulusDesign.history_units)


def test_an_interrupted_run_keeps_its_rows():
    def stop(step):
        if step.step == 4:
            raise KeyboardInterrupt

    result = design().run(stop)
    assert (result.status, len(result.steps), result.quantities) == (Status.INTERRUPTED, 4, {})
    assert figures_for(result) == {}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ratios": (0.5, 0.1)}, "ratios must increase: entry 2 is not above entry 1"),
        ({"forces": (1.0, 3.5)}, "forces: 3.5 N is beyond the largest one of 3 N"),
        ({"design_point": {"force": 1000.0}}, "design_point.force: 1 kN is beyond the largest one of 3 N"),
        ({"recommended_force": 4.0}, "beyond the largest one"),
        ({"thickness": 4e-3, "formula": "thesis_4_2_21"}, "for a half-space"),
        ({"ratios": (0.0, 0.5)}, "greater than 0"),
        ({"tissue": {"times": "seconds"}}, "viscosities"),
    ],
)
def test_what_makes_no_design_is_refused(changes, message):
    with pytest.raises(CaseError, match=message):
        design(**changes)


def test_the_shipped_case_runs_and_is_drawn():
    result = load_case(SHIPPED).experiment.run()
    assert result.status is Status.CONVERGED
    (name, draw), *rest = figures_for(result).items()
    assert (name, rest) == ("annulus_design.png", [])
    assert draw().startswith(b"\x89PNG")
    assert unmarked_figures(result) == []


@pytest.mark.parametrize("times", [(0.5,), (0.5, 5.0), (0.5, 1.0, 5.0)])
def test_no_words_are_cut_or_lie_on_each_other_and_the_recess_has_numbers(times):
    result = AnnulusDesign.example().model_copy(update={"times": times}).run()
    figures = result.plot()
    assert cut_words(figures) == []  # which lays them out
    figure = figures["annulus_design"]
    axis = figure.axes[0]
    note, point = (next(one for one in axis.texts if begin in one.get_text()) for begin in ("all outside", "design point"))
    assert not note.get_window_extent().overlaps(point.get_window_extent())
    low, high = axis.get_ylim()
    assert sum(low <= place <= high for place in axis.get_yticks()) >= 3


@pytest.mark.parametrize(("design", "crossed"), [(AnnulusDesign.example(), False), (load_case(SHIPPED).experiment, True)])
def test_the_legend_names_the_dashed_line_only_where_there_is_one(design, crossed):
    words = " ".join(text.get_text() for text in design.run().plot("annulus_design").legends[0].get_texts())
    assert ("above the dashed line" in words) == crossed
    assert "largest force" in words


def test_a_map_without_contours_is_drawn():
    result = run(recesses=(1e-6, 2e-6), forces=(0.001,), times=(0.1, 1.0, 2.0, 9.0))
    assert figures_for(result)["annulus_design.png"]().startswith(b"\x89PNG")
