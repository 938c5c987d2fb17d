"""A stored grasp, made up or damaged, and what is found in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_grasps import BALL, BALL_AT, PLAIN, SIZE
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from scenes import Unrendered, grasp_scene, unmarked_figures

from tactsim.case.loading import load_case
from tactsim.errors import CaseError, InputError, StorageError
from tactsim.experiments.grasp.figures.viewed import outline
from tactsim.experiments.grasp.figures.views import VIEWS, views_figure
from tactsim.experiments.localization.figures import space
from tactsim.experiments.localization.figures.parts import localized
from tactsim.experiments.localization.localization import Localization
from tactsim.interfaces.readings import pulled_words
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.plotting import figures_for
from tactsim.plotting.canvas import with_minus
from tactsim.results import Quantity, Result, Status, StepRecord
from tactsim.results.writing import write_result

SPHERE = Sphere(center=BALL_AT, radius=5e-3)
ESTIMATOR = ThesisEstimator(background="reference")


def grasp(forces, *, closing=1e-3, inclusions=(SPHERE,), apart=0.0, layout=None, extra=None):
    layout = layout or TaxelLayout()
    quantities = {"displacement": Quantity(closing, "m", "")}
    for jaw, side in enumerate(JAWS):
        quantities[f"taxel_force_{side}"] = Quantity(forces[jaw].tolist(), "N", "")
        quantities[f"taxel_pressure_{side}"] = Quantity((forces[jaw] / layout.area).tolist(), "Pa", "")
    scene = grasp_scene(SIZE, layout, inclusions, width=40e-3, depth=40e-3)
    x, y, z = scene.jaw_places["upper"]
    scene = scene.model_copy(update={"jaw_places": scene.jaw_places | {"upper": (x + apart, y, z)}})
    step = StepRecord(1, 3, 0.0, {"displacement": closing})
    return Result(
        "grasp", Status.CONVERGED, "made up", quantities | (extra or {}), steps=(step,), units={"displacement": "m"}, scene=scene
    )


def stored(folder, result):
    write_result(result, folder, case_id="0" * 16, provenance={})
    return str(folder)


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    root = tmp_path_factory.mktemp("grasps")
    return stored(root / "ball", grasp(PLAIN + BALL)), stored(root / "plain", grasp(PLAIN))


def run(folders, **changes):
    given = {"grasp": folders[0], "reference": folders[1], "noise": 1e-3, "estimator": ESTIMATOR} | changes
    return Localization(**given).run()


def value(result, name):
    return np.asarray(result.quantities[name].value)


def test_a_stored_ball_is_found_and_the_errors_reported(folders):
    result = run(folders)
    assert value(result, "present") == 1
    assert np.abs(value(result, "estimated_center") - SPHERE.center).max() < 1e-3
    away = value(result, "estimated_center") - SPHERE.center
    assert value(result, "lateral_error") == float(np.hypot(*away[:2]))
    assert value(result, "depth_error") == float(away[2])
    np.testing.assert_allclose(value(result, "true_center"), SPHERE.center)
    np.testing.assert_allclose(value(result, "taxel_difference_upper"), BALL[0], atol=1e-12)
    printed = run(folders, estimator=ESTIMATOR.model_copy(update={"form": "as_printed"}))
    assert abs(value(printed, "depth_error")) > 5 * abs(value(result, "depth_error"))


def test_plain_tissue_has_nothing_in_it(folders):
    result = run(folders, grasp=folders[1])
    assert value(result, "present") == 0
    assert "estimated_center" not in result.quantities
    assert "no inclusion" in result.reason
    assert views_figure(result, localized(result)).axes


def test_the_views_show_the_true_and_the_estimated_place(folders, monkeypatch):
    result = run(folders)
    grasp_seen = localized(result)
    np.testing.assert_allclose(grasp_seen.signal, BALL, atol=1e-12)
    np.testing.assert_allclose(grasp_seen.estimates[0].center, value(result, "estimated_center"))
    first, second, distance = outline(grasp_seen.true[0], SIZE, away=1)
    row, column = np.unravel_index(distance.argmin(), distance.shape)
    np.testing.assert_allclose([first[column], second[row]], [28, 12], atol=0.2)
    within = 1e3 * np.array([SPHERE.center[0], SPHERE.center[2]])
    covered = np.hypot(first[None] - within[0], second[:, None] - within[1]) < 4.9
    assert (distance[covered] < 0).all()
    monkeypatch.setattr(space, "Rendering", Unrendered)
    assert unmarked_figures(result) == []
    figure = views_figure(result, localized(result))
    titles = [axis.get_title(loc="left") for axis in figure.axes]
    assert sum("view" in title for title in titles) == 3
    front = next(axis for axis in figure.axes if axis.get_title(loc="left").startswith("front"))
    image = front.images[0]
    assert image.get_extent() == pytest.approx([10 - 10 / 99, 30 + 10 / 99, 0, 20])
    row, column = np.unravel_index(np.argmax(image.get_array()), image.get_array().shape)
    assert column > 70
    assert row < 30


def test_many_words_about_an_estimate_end_above_the_numbers_of_the_taxels(folders):
    """The last of seven lines about two lumps lay on the heading below."""
    result = run(folders)
    grasp = replace(localized(result), findings=tuple(f"line {k} of what was estimated" for k in range(9)))
    figure = views_figure(result, grasp)
    figure.draw_without_rendering()
    texts = {text.get_text().split("\n")[0][:10]: text.get_window_extent() for axis in figure.axes for text in axis.texts}
    assert texts["line 0 of "].y0 > texts["what each "].y1


def test_the_views_write_what_each_taxel_reads_with_its_row_and_column(folders):
    result = run(folders)
    figure = views_figure(result, localized(result))
    for side, forces in zip(JAWS, BALL, strict=True):
        axis = next(axis for axis in figure.findobj(Axes) if axis.get_title(loc="left") == f"{side} jaw in mN")
        written = {text.get_position(): text.get_text() for text in axis.texts}
        assert written == {(column, row): f"{1e3 * force:.3g}" for (row, column), force in np.ndenumerate(forces)}
    named = [text.get_text() for axis in figure.axes for text in axis.texts]
    assert {"row 1", "row 3", "col. 1", "col. 3"} <= set(named)


def test_the_views_name_all_axes_and_lines_and_have_one_unit(folders):
    """One view was in N and the next in mN, the top view had no name of x, the outline of an estimate was in no legend, and
    nothing said that the views take negative readings for none."""
    result = run(folders)
    grasp = localized(result)
    signal = np.zeros((2, 3, 3))
    signal[:, 0] = 0.3  # more than 1 N in sums over columns only
    signal[:, 2, 2] = -0.02
    figure = views_figure(result, replace(grasp, signal=signal))
    bars = [axis for axis in figure.axes if axis.get_label() == "<colorbar>"]
    units = {(axis.get_xlabel() or axis.get_ylabel()).split(" in ", 1)[1] for axis in bars}
    assert len(units) == 1
    top = next(axis for axis in figure.axes if axis.get_title(loc="left").startswith("top"))
    assert top.get_xlabel() == "x in mm (undeformed)"
    assert units.pop().endswith("readings below 0 count as 0")
    (legend,) = (axis.get_legend() for axis in figure.axes if axis.get_legend())
    words = {
        text.get_text(): handle.get_linestyle() for text, handle in zip(legend.get_texts(), legend.legend_handles, strict=True)
    }
    sized = any(estimate.radius is not None for estimate in grasp.estimates)
    assert words["estimated centre and outline" if sized else "estimated centre"] == ("-" if sized else "None")
    numbers = [text.get_text() for axis in figure.findobj(Axes) for text in axis.texts]
    assert "−20" in numbers


@pytest.mark.parametrize(("contrast", "word"), [(-2.7, "Softer"), (0.8, "Stiffer")])
def test_the_views_say_whether_it_is_softer_or_stiffer_than_the_tissue(contrast, word, folders):
    result = run(folders)
    estimated = {"estimated_contrast": Quantity(contrast, "1", ""), "contrast_deviation": Quantity(0.5, "1", "")}
    line = with_minus(f"{word} than the tissue at this closing: contrast {contrast:+.2g} ± 0.5, 0 is tissue")
    assert line in localized(replace(result, quantities=result.quantities | estimated)).findings
    assert not [line for line in localized(result).findings if "contrast" in line]


def test_the_views_say_why_nothing_is_found(folders):
    result = run(folders)
    nothing = replace(
        result,
        quantities=result.quantities | {"present": Quantity(0.0, "1", "")},
        reason="no inclusion (probability 0.895)",
    )
    assert localized(nothing).findings == ("Nothing found: no inclusion (probability 0.895)",)


def test_several_places_are_all_named_in_the_result(folders, tmp_path):
    apart = PLAIN.copy()
    apart[:, 0, 0] += 0.4
    apart[:, 2, 2] += 0.3
    result = run(folders, grasp=stored(tmp_path / "two", grasp(apart)))
    assert result.reason.startswith("2 places explain the readings better than one")
    (warning,) = (words for words in result.warnings if "no one place explains the readings" in words)
    assert "unknown at (10 mm, 10 mm, 10 mm); unknown at (30 mm, 30 mm, 10 mm)" in warning
    shown = localized(result)
    assert len(shown.estimates) == 2
    assert "2 places explain" in " ".join(shown.findings)
    assert [line.endswith(" in height (the first)") for line in shown.findings if line.startswith("Off by")] == [True]
    assert not [words for words in run(folders).warnings if "no one place" in words]


def test_pictures_reach_over_the_outer_taxels(folders):
    result = run(folders)
    figure = views_figure(result, localized(result))
    front = next(axis for axis in figure.axes if axis.get_title(loc="left").startswith("front"))
    mesh = next(part for part in front.collections if isinstance(part, QuadMesh))
    corners = mesh.get_coordinates()
    assert (corners[..., 0].min(), corners[..., 0].max()) == pytest.approx((5.5, 34.5))
    assert (corners[..., 1].min(), corners[..., 1].max()) == pytest.approx((0.0, 20.0))
    values = mesh.get_array().reshape(len(corners) - 1, -1)
    np.testing.assert_array_equal(values[:, 0], values[:, 1])


WIDE = TaxelLayout(rows=2, columns=9, pitch=4e-3, size=4e-3)


@pytest.mark.parametrize("layout", [TaxelLayout(rows=1, columns=1), pytest.param(WIDE, marks=pytest.mark.slow)])
def test_every_matrix_has_views(layout):
    forces = np.ones((2, layout.rows, layout.columns))
    result = grasp(forces, layout=layout, inclusions=(Tube.example(),))
    assert figures_for(result)[VIEWS]()[:4] == b"\x89PNG"


def test_dead_taxels_are_interpolated_and_reported(folders):
    result = run(folders, dead=(("upper", 2, 2), ("lower", 3, 1)))
    assert value(result, "present") == 1
    assert any("neighbours: 2" in words for words in result.warnings)
    assert views_figure(result, localized(result)).axes
    with pytest.raises(InputError, match="dead: taxel upper, 4, 1 of a matrix of 3 rows"):
        run(folders, dead=(("upper", 4, 1),))


def test_forces_that_pull_on_the_whole_are_warned_of(folders, tmp_path):
    """Forces and reference of the wrong sign gave a softer lump, silently."""
    pulled = stored(tmp_path / "pulled", grasp(-PLAIN - BALL)), stored(tmp_path / "plain", grasp(-PLAIN))
    (warning,) = [one for one in run(pulled).warnings if "pull" in one]
    assert "the upper jaw's by" in warning
    assert "the lower jaw's by" in warning
    assert not any("pull" in one for one in run(folders).warnings)
    assert pulled_words(np.full((2, 3, 3), -1e-3), noise=1e-3) is None, "what noise alone may add up to"


def test_saturated_taxels_of_read_forces_are_not_trusted(folders, tmp_path):
    with pytest.raises(InputError, match="has no read_force"):
        run(folders, readings="read_force")
    spoiled = PLAIN + BALL
    spoiled[0, 0, 2] = 9.0
    extra = {}
    for jaw, side in enumerate(JAWS):
        share = np.zeros((3, 3))
        share[0, 2] = 0.4 * (jaw == 0)
        extra[f"read_force_{side}"] = Quantity(spoiled[jaw].tolist(), "N", "")
        extra[f"saturated_{side}"] = Quantity(share.tolist(), "1", "")
    read = stored(tmp_path / "read", grasp(PLAIN + BALL, extra=extra))
    result = run(folders, grasp=read, reference=None, readings="read_force", estimator=ThesisEstimator())
    assert value(result, "taxel_force_upper")[0, 2] < 1
    assert any("neighbours: 1" in words for words in result.warnings)


def test_other_jaws_in_the_reference_are_named(folders, tmp_path):
    """Readings that do not fit were put down to friction, closing or inclusions, though the jaws are known."""
    other = grasp(PLAIN, apart=0.5e-3)
    jaw = other.scene.jaws["lower"].model_copy(update={"tilt_x": np.radians(2), "width": 30e-3})
    scene = other.scene.model_copy(update={"jaws": other.scene.jaws | {"lower": jaw}})
    reference = stored(tmp_path / "tilted", replace(other, scene=scene))
    (warning,) = [words for words in run(folders, reference=reference).warnings if "is taken for lumps" in words]
    assert warning.startswith(
        "middle along x of the upper jaw is 20 mm, in the reference 20.5 mm; width of the lower jaw is 40 mm, in the reference "
        "30 mm; tilt_x of the lower jaw is 0°, in the reference 2°: what this changes"
    )
    assert not any("is taken for lumps" in words for words in run(folders).warnings)


def test_what_does_not_fit_is_refused(folders, tmp_path):
    other = stored(tmp_path / "closing", grasp(PLAIN, closing=0.9e-3))
    with pytest.raises(InputError, match="closed by 1 mm, those of the reference by 900 µm"):
        run(folders, reference=other)
    finer = TaxelLayout(pitch=9e-3, size=8e-3)
    with pytest.raises(InputError, match="another matrix"):
        run(folders, reference=stored(tmp_path / "layout", grasp(PLAIN, layout=finer)))
    apart = stored(tmp_path / "apart", grasp(PLAIN, apart=6e-3))
    with pytest.raises(InputError, match="6 mm apart sideways"):
        run(folders, grasp=apart)
    with pytest.raises(InputError, match="needs readings of the tissue without a lump"):
        run(folders, reference=None)
    with pytest.raises(StorageError):
        run(folders, grasp=str(tmp_path / "none"))
    nothing = Result("closed_form", Status.CONVERGED, "", {}, steps=(), units={})
    with pytest.raises(InputError, match="needed: a grasp or a matrix_readout"):
        run(folders, grasp=stored(tmp_path / "other", nothing))


def test_an_artery_is_as_near_as_its_centre_line():
    tube = Tube.example()
    points = tube.places(SIZE)
    np.testing.assert_allclose(points[:, 1:], np.broadcast_to([20e-3, 10e-3], (len(points), 2)))
    assert points[:, 0].min() == pytest.approx(0, abs=1e-3)
    assert points[:, 0].max() == pytest.approx(40e-3, abs=1e-3)


def test_a_case_file_reads_it(tmp_path, folders):
    text = f"""\
schema: tactsim/case/1
title: Where is it
experiment:
  kind: localization
  grasp: {folders[0]}
  reference: {folders[1]}
  noise: 1 mN
  dead: [[upper, 1, 1]]
  estimator: {{kind: thesis, background: reference, lateral: peak}}
"""
    path = tmp_path / "case.yaml"
    path.write_text(text, encoding="utf-8")
    case = load_case(path)
    assert case.experiment.estimator.lateral == "peak"
    assert case.experiment.run().status is Status.CONVERGED
    path.write_text(text.replace("noise: 1 mN", "noise: -1 mN"), encoding="utf-8")
    with pytest.raises(CaseError, match="noise"):
        load_case(path)


def test_the_views_say_where_the_estimator_did_not_read_what_they_draw(folders):
    words = "Read off the forces as they are; drawn is their difference from the reference."
    assert localized(run(folders, estimator=ThesisEstimator())).findings[-1] == words
    assert any("the reference was not used" in warning for warning in run(folders, estimator=ThesisEstimator()).warnings)
    assert not any("not used" in warning for warning in run(folders).warnings)
    assert words not in localized(run(folders)).findings
    assert words not in localized(run(folders, reference=None, estimator=ThesisEstimator())).findings
