"""Pictures of the thesis that need a simulation: what they are made of, on invented runs, and one that is solved."""

from __future__ import annotations

import numpy as np
import pytest
from thesis_tables import shipped_tables

from tactsim.errors import InputError, UnknownName
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.results import Result
from tactsim.results.fields import AXIAL_STRESS
from tactsim.validation.figures import validation_figure
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.grasp import tactile_pictures
from tactsim.validation.quantities.runs import run_history
from tactsim.validation.quantities.sections import section_panel
from tactsim.validation.study import RunOutcome

PICTURES = {
    "section_2_3": ("Fig. 2.9a", "Fig. 2.9b", "Fig. 2.10"),
    "section_3_1_2": ("Fig. 3.5a", "Fig. 3.5b"),
    "figure_3_8": ("Fig. 3.8",),
    "table_3_2": ("Fig. 3.9",),
    "section_4_4": ("Fig. 4.8", "Fig. 4.9", "Fig. 4.10"),
    "table_4_1": ("Fig. 4.11",),
    "chapter_5": ("Fig. 5.7", "Fig. 5.8"),
    "section_6_6": ("Fig. 6.4", "Fig. 6.7a", "Fig. 6.7b", "Fig. 6.7c", "Fig. 6.8"),
    "appendix_a": ("Fig. 2", "Fig. 3"),
}
"""Pictures of the thesis by table; the maps of section 6.6 show Fig. 6.5 to 6.7 side by side."""


def outcome(history: dict[str, tuple[float, ...]], status: str = "converged") -> Inputs:
    run = RunOutcome(id="r", case_id="r", status=status, reason="end", quantities={}, history=history, seconds=1)
    return Inputs(studies={"s": (run,)})


@pytest.mark.parametrize("table", sorted(PICTURES))
def test_the_pictures_of_the_thesis_stand_in_their_tables(table: str) -> None:
    titles = [figure.title for figure in shipped_tables("thesis").tables[table].figures.values()]
    missing = [picture for picture in PICTURES[table] if not any(title.startswith(picture) for title in titles)]
    assert missing == []


def test_a_history_is_drawn_over_its_time() -> None:
    asked = {"title": "t", "study": "s", "run": "r", "curves": {"applied": "force"}, "y_axis": "force", "si_unit": "N"}
    data = run_history(outcome({"time": (0.0, 1.0), "force": (2.0, 3.0)}), **asked)
    assert data["panels"][0]["curves"] == [{"label": "applied", "x": [0.0, 1.0], "y": [2.0, 3.0], "style": "line"}]
    with pytest.raises(UnknownName, match="force"):
        run_history(outcome({"time": (0.0, 1.0)}), **asked)
    with pytest.raises(InputError, match="did not converge"):
        run_history(outcome({}, "failed"), **asked)


def corner_reads() -> Inputs:
    """A grasp in which the taxels of the front right corner, row 1 and column 3, read most, the upper ones more."""
    history = {"time": (1.0,), "displacement": (1e-3,)}
    for side, most in (("upper", 0.9), ("lower", 0.3)):
        for row, column in np.ndindex(3, 3):
            history[f"taxel_force_{side}_{row + 1}_{column + 1}"] = (most if (row, column) == (0, 2) else 0.1,)
    return outcome(history)


def test_views_show_a_lump_where_it_lies() -> None:
    data = tactile_pictures(corner_reads(), "t", "s", "views", shape=(21, 31))
    assert all("; white is " in panel["title"] for panel in data["panels"])
    front, left, top = (np.array(panel["grey"]) for panel in data["panels"])
    assert front.max() == left.max() == top.max() == 255.0
    assert front[:10].max() == 255.0  # upper half, at the right
    assert front.argmax() % 31 == 30
    assert left.argmax() % 31 == 30  # seen from the left, the front is at the right
    row, column = np.unravel_index(top.argmax(), top.shape)
    assert row > 10  # the front below; between the rows of sensors, where the two of them meet
    assert column == 30


def test_readings_of_plain_tissue_are_taken_off() -> None:
    lump, plain = corner_reads(), outcome({**corner_reads().study("s")[0].history, "taxel_force_upper_1_3": (0.1,)})
    inputs = Inputs(studies={"s": lump.study("s"), "plain": plain.study("s")})
    data = tactile_pictures(inputs, "t", "s", "views", shape=(21, 31), reference="plain")
    front = np.array(data["panels"][0]["grey"])
    assert front[0, 30] == 255.0  # the upper jaw alone reads more: the peak stands at it
    assert front[:, :15].max() == 0.0  # nothing in the other columns


def test_layers_of_the_image_in_space_share_one_scale() -> None:
    data = tactile_pictures(corner_reads(), "t", "s", "layers", shape=(21, 31), layers=5)
    layers = [np.array(panel["grey"]) for panel in data["panels"]]
    assert len(layers) == 5
    assert max(layer.max() for layer in layers) == 255.0
    brightest = int(np.argmax([layer.max() for layer in layers]))
    assert brightest == 1  # nearer the upper jaw, which reads more: a quarter of the way
    assert np.unravel_index(layers[brightest].argmax(), layers[brightest].shape) == (20, 30)


@pytest.fixture(scope="module")
def pressed() -> Result:
    example = Indentation.example()
    mesh = example.mesh.model_copy(update={"finest": 0.4e-3, "growth": 1.0})
    return example.model_copy(update={"mesh": mesh, "stop": "displacement", "displacement": 0.2e-3}).run()


def test_the_axial_stress_is_in_balance_with_the_force(pressed: Result) -> None:
    r"""Balance of forces times height: the integral of the axial stress over the deformed body is -F (H - d), both ends counted.

    A sign, the radial or the hoop stress in its place, or the pressure would fail.
    """
    frame = pressed.frames[-1]
    places = (frame.points + frame.point_data["displacement [m]"])[:, :2]
    corners = places[frame.cells["triangle6"][:, :3]]
    (ax, az), (bx, bz) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    volumes = np.abs(ax * bz - az * bx) / 2 * 2 * np.pi * corners[:, :, 0].mean(axis=1)
    total = float((volumes * np.asarray(frame.cell_data[AXIAL_STRESS]).ravel()).sum())
    force, moved, height = (
        float(value) for value in (pressed["base_force"].value, pressed["displacement"].value, -places[:, 1].min())
    )
    # straight sides for curved ones, and a plain mean for that over the volume, on coarse elements
    assert total == pytest.approx(-force * (height - moved), rel=0.02)


def test_a_section_is_drawn_with_face_and_sensor(pressed: Result) -> None:
    panel = section_panel(pressed, "ICF")
    assert len(panel["values"]) == len(panel["triangles"])
    (face, sensor), moved = panel["lines"], float(pressed["displacement"].value)
    top = max(point[1] for point in panel["points"])
    assert face[0][1] == pytest.approx(face[1][1])
    assert sensor[0][1] - face[0][1] == pytest.approx(0.8e-3)
    assert face[0][1] == pytest.approx(-moved)  # the undeformed surface is at 0
    assert 0 < top < moved
    data = {"form": "sections", "title": "t", "unit": "Pa", "label": "stress", "panels": [panel]}
    assert validation_figure(data).startswith(b"\x89PNG")


def test_what_has_no_section_is_refused(pressed: Result) -> None:
    with pytest.raises(InputError, match="did not converge"):
        section_panel(Result("indentation", "failed", "why", {}), "ICF")
