"""What a grasp accepts, how its forces add up, and how it follows closing, force, relaxation and the pressure in a lumen."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from pydantic import ValidationError

from tactsim.analytic.histories import History, Segment
from tactsim.errors import ConvergenceError, InputError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.lumen_pressure import MMHG, PulsePressure
from tactsim.experiments.grasp.model import grasp_mesh
from tactsim.experiments.grasp.readings import JawReading, check_sums
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.contact.surface_forces import TaxelForces
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.block_source import StructuredSource
from tactsim.mechanics.paths.history_path import smooth_intervals
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.structured_block import structured_block

pytestmark = pytest.mark.usefixtures("one_thread", "reader_here")
SIZE = (40e-3, 40e-3, 20e-3)
FEW = {"kind": "structured", "cells": (2, 2, 2)}
C10 = 1000.0
SOFT = {"kind": "neo_hookean", "c10": C10}
FADING = {"fractions": [0.5], "times": [1.0]}
CLOSING = {"control": "displacement", "pieces": [{"kind": "ramp", "to": 1e-3, "duration": 1.0}]}
ONE_STEP = {"steps": 1}
RAMP = {"kind": "ramp", "to": 1e-4, "duration": 1.0}
TUBE = {"kind": "tube", "centre_line": [(0.0, 20e-3, 10e-3), (40e-3, 20e-3, 10e-3)], "inner_radius": 4e-3, "wall": 3e-3}
BALL = {"kind": "sphere", "center": (20e-3, 20e-3, 10e-3), "radius": 5e-3}
PULSE = {"kind": "pulse", "beats": 1}


def aside(y=34e-3):
    return BALL | {"center": (20e-3, y, 10e-3), "radius": 3e-3}


def grasp(**changes):
    given = {
        "block": {"size": SIZE, "tissue": SOFT},
        "loading": CLOSING,
        "mesh": FEW,
        "time": ONE_STEP,
    }
    return Grasp.model_validate(given | changes)


def run(**changes):
    return grasp(**changes).run()


def values(result):
    assert result.status == "converged", result.reason
    return {name: quantity.value for name, quantity in result.quantities.items()}


def pressed(*pieces, control="displacement"):
    return {"control": control, "pieces": list(pieces)}


@pytest.fixture(scope="module")
def tube_file(tmp_path_factory):
    """A block with a ragged tube along x, as another program would write it."""
    block = structured_block(SIZE, (1, 8, 4), [Tube.model_validate(TUBE)])
    mesh, count = block.mesh, block.mesh.corner_count
    cells = meshio.CellBlock("tetra", mesh.elements[:, :4])
    path = tmp_path_factory.mktemp("meshes") / "tube.vtu"
    meshio.Mesh(1e3 * mesh.nodes[:count], [cells], cell_data={"region": [mesh.regions + 5]}).write(path)
    return {"kind": "file", "path": str(path), "unit": "mm", "regions": {"5": 0, "6": 1}}


def with_tube(file, lumen, **changes):
    inclusion = {"shape": TUBE, "material": "artery_wall", "lumen": lumen}
    return run(mesh=file, inclusions=[inclusion], **changes)


def test_taxels_read_the_cauchy_pressure_of_a_frictionless_block():
    quantities = values(run(contact={"kind": "coulomb", "friction": 0.0}, penetration_tolerance=1e-7))
    stretch = 1 - 2e-3 / SIZE[2]
    cauchy = 2 * C10 * (1 / stretch - stretch**2)
    for side in JAWS:
        pressure = np.array(quantities[f"taxel_pressure_{side}"])
        assert pressure == pytest.approx(np.full((3, 3), cauchy), rel=3e-4), "twice the penetration over the closing is 2e-4"
        assert np.abs(quantities[f"taxel_shear_{side}"]).max() < 1e-6 * cauchy * 81e-6
        parts = np.sum(quantities[f"taxel_force_{side}"]) + quantities[f"gap_force_{side}"] + quantities[f"outside_force_{side}"]
        assert parts == pytest.approx(quantities["reaction_force"], rel=1e-7)
    assert quantities["max_penetration"] <= 1e-7
    assert quantities["jaw_force_upper"] == pytest.approx(
        -np.array(quantities["jaw_force_lower"]), abs=1e-6 * quantities["reaction_force"]
    )


def test_what_a_run_records():
    result = run(
        time={"steps": 2}, inclusions=[{"shape": BALL, "material": "lump"}], mesh={"kind": "structured", "cells": (4, 4, 4)}
    )
    quantities = values(result)
    assert [step.values["time"] for step in result.steps] == [0.5, 1.0]
    assert [step.values["displacement"] for step in result.steps] == pytest.approx([0.5e-3, 1e-3])
    assert np.shape(quantities["taxel_force_upper_history"]) == (2, 3, 3)
    assert quantities["taxel_force_lower_history"][-1] == quantities["taxel_force_lower"]
    assert result.steps[-1].values["taxel_force_upper_1_3"] == quantities["taxel_force_upper"][0][2]
    assert {name for step in result.steps for name in step.values} <= set(result.units)
    assert any(result.scene.mesh.content in assumption for assumption in result.assumptions)
    assert [result.scene.jaw_places[side][2] for side in JAWS] == pytest.approx([SIZE[2] - 1e-3, 1e-3])
    assert len(result.frames) == 2
    frame = result.frames[-1]
    assert set(np.unique(frame.cell_data["region [1]"])) == {0.0, 1.0}
    squeezed = frame.point_data["displacement [m]"][:, 2].max() - frame.point_data["displacement [m]"][:, 2].min()
    assert squeezed == pytest.approx(2e-3, rel=0.02)
    assert frame.point_data["pressure [Pa]"].mean() > 0


def test_a_force_is_reached_by_the_closing_that_needs_it():
    closed = values(run(time={"steps": 2}))
    force = closed["reaction_force"]
    reached = values(run(loading=pressed({"kind": "ramp", "to": force, "duration": 1.0}, control="force")))
    assert reached["reaction_force"] == pytest.approx(force, rel=1e-6)
    assert reached["displacement"] == pytest.approx(1e-3, rel=0.03), (
        "twice the penetration tolerance, and another path of friction"
    )
    assert abs(reached["jaw_force_lower"][2]) == pytest.approx(force, rel=1e-6)


def test_a_held_closing_relaxes_by_the_series():
    tissue = SOFT | {"relaxation": FADING}
    result = run(
        block={"size": SIZE, "tissue": tissue},
        contact={"kind": "coulomb", "friction": 0.0},
        loading=pressed({"kind": "jump", "to": 1e-3, "duration": 3.0}),
        mesh=FEW | {"cells": (1, 1, 1)},
        penetration_tolerance=1e-6,
        time={"tolerance": 5e-3},
    )
    values(result)
    times, forces = (np.array([step.values[name] for step in result.steps]) for name in ("time", "reaction_force"))
    expected = 0.5 + 0.5 * np.exp(-times)
    assert forces / forces[0] == pytest.approx(expected, rel=5e-3), "error in time, and the penetration follows the pressure"


def test_pressure_alone_swells_the_block_against_the_jaws(tube_file):
    held = pressed({"kind": "hold", "duration": 0.5})
    swelling = [{"kind": "ramp", "to": 1000.0, "duration": 0.5}]
    result = with_tube(tube_file, {"kind": "history", "pieces": swelling}, loading=held)
    quantities = values(result)
    assert quantities["displacement"] == 0
    assert quantities["lumen_pressure"] == pytest.approx([1000.0])
    assert quantities["reaction_force"] > 1e-3
    assert quantities["jaw_force_upper"][2] == pytest.approx(-quantities["jaw_force_lower"][2], rel=1e-4)
    taxels = np.array(quantities["taxel_force_upper"])
    assert taxels[1].mean() > 2 * taxels[[0, 2]].mean(), "the row above the tube"


@pytest.mark.slow
def test_suction_draws_the_block_away_from_the_jaws(tube_file):
    held = pressed({"kind": "hold", "duration": 0.5})
    swelling = [{"kind": "ramp", "to": 1000.0, "duration": 0.5}]
    taxels = np.array(values(with_tube(tube_file, {"kind": "history", "pieces": swelling}, loading=held))["taxel_force_upper"])
    sucking = [{"kind": "jump", "to": -1000.0, "duration": 0.5}]
    sucked = values(with_tube(tube_file, {"kind": "history", "pieces": sucking}, loading=held))
    assert np.mean(sucked["taxel_force_upper"][1]) < 0.3 * taxels[1].mean()


def test_a_pulse_is_felt_under_a_closing(tube_file):
    pulse = PULSE | {"rise": 1.0, "rate": 1.0, "diastole": 500.0, "systole": 2000.0}
    result = with_tube(tube_file, pulse, loading=CLOSING, time={"steps": 1, "per_period": 4})
    values(result)
    pressures, forces = (np.array([s.values[name] for s in result.steps]) for name in ("lumen_pressure_1", "reaction_force"))
    assert pressures == pytest.approx([500.0, 1250.0, 2000.0, 1250.0, 500.0])
    assert forces.argmax() == 2
    assert [frame.time for frame in result.frames] == pytest.approx([1.0, 1.5, 2.0])
    assert "lumen 1: as given, 500 Pa to 2 kPa at 1 Hz, a raised cosine" in result.assumptions


def test_a_small_force_begins_at_the_edges_under_leaning_jaws():
    """Nothing holds the block before: under a force the first iterates of Newton threw it away."""
    leaning = run(
        block={"size": (44e-3, 32e-3, 28e-3), "tissue": SOFT},
        contact={"kind": "coulomb", "friction": 0.3},
        upper={"tilt_x": "1.44 deg"},
        lower={"tilt_x": "-1.22 deg"},
        mesh={"kind": "structured", "cells": (3, 3, 2)},
        loading=pressed({"kind": "ramp", "to": 0.1, "duration": 1.0}, control="force"),
    )
    forces = values(leaning)
    assert forces["jaw_force_upper"][2] == pytest.approx(0.1, rel=1e-6)
    assert np.add(forces["jaw_force_upper"], forces["jaw_force_lower"]) == pytest.approx(0.0, abs=1e-6)


def test_forces_that_do_not_add_up_are_refused():
    parts = TaxelForces(np.ones((3, 2, 2)), np.zeros(3), np.ones(3))
    check_sums(JawReading(parts, np.full(3, 5.0)), np.eye(3), "upper", 0.0)
    for wrong in (np.full(3, 5.0 + 3 * 1e-8 * 35), np.full(3, np.nan)):
        with pytest.raises(ConvergenceError, match="upper jaw miss its force"):
            check_sums(JawReading(parts, wrong), np.eye(3), "upper", 0.0)


def test_a_failure_keeps_what_was_accepted(monkeypatch):
    solve = GraspModel.equilibrium

    def failing(self, state, closing, guess, **more):
        if closing > 0.6e-3:
            raise ConvergenceError("no way")
        return solve(self, state, closing, guess, **more)

    monkeypatch.setattr(GraspModel, "equilibrium", failing)
    result = run(time={"steps": 2}, mesh=FEW | {"cells": (1, 1, 1)})
    assert result.status == "failed"
    assert "no way" in result.reason
    assert result.quantities["displacement"].value < 0.6e-3
    assert result.scene.solver.rejected_steps > 0


def test_steps_that_were_taken_back_before_a_failure_are_counted(monkeypatch):
    def failing(self, state, closing, guess, **more):
        raise ConvergenceError("no way")

    monkeypatch.setattr(GraspModel, "equilibrium", failing)
    result = run(mesh=FEW | {"cells": (1, 1, 1)})
    assert not result.steps
    assert result.scene.solver.rejected_steps > 5


def test_an_interruption_keeps_what_was_accepted():
    def interrupting(step):
        raise KeyboardInterrupt

    result = grasp(time={"steps": 2}, mesh=FEW | {"cells": (1, 1, 1)}).run(interrupting)
    assert result.status == "interrupted"
    assert len(result.steps) == 1


@pytest.mark.parametrize(("reading", "limits"), [("above_diastole", (0, 40)), ("absolute", (80, 120)), ("captions", (8, 12))])
def test_a_pulse_rises_and_beats(reading, limits):
    pulse = PulsePressure(kind="pulse", reading=reading, rate=2.0, rise=0.5)
    history = pulse.history(10.0)
    computed = history.value([0.5, 0.75, 1.0, 0.625, 9.75])
    least, most = (MMHG * value for value in limits)
    assert computed == pytest.approx([least, most, least, (least + most) / 2, most], abs=1e-9 * most)
    counted = replace_beats(pulse, 2).history(10.0)
    assert counted.value([1.25, 9.75]) == pytest.approx([most, least], abs=1e-9 * most)


def replace_beats(pulse, beats):
    return PulsePressure.model_validate(pulse.model_dump() | {"beats": beats})


def test_smooth_intervals_are_the_union_of_all_breakpoints():
    first = History((Segment(0.0, 1.0, 0.0, 2.0), Segment(1.0, 3.0, 5.0)))
    second = History((Segment(0.0, 1.0 + 1e-12, 1.0), Segment(1.0 + 1e-12, 2.0, 1.0, 1.0)))
    course = smooth_intervals([first, second], 3.0)
    assert [(s.start, s.end) for s in course] == [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)]
    assert course[0].at(0.5) == (1.0, 1.0)
    assert course[1].at(1.5) == pytest.approx((5.0, 1.5))
    assert course[2].at(2.5) == pytest.approx((5.0, 2.0))
    assert course[1].begins_at((5.0, 1.0 + 1e-12))
    assert [interval.sudden for interval in course] == [True, True, False]


def test_thin_blocks_are_held_by_friction():
    """Found from stick. The force of a block a twentieth as thick as wide is near that of a glued one."""
    thin = {"block": {"size": (20e-3, 20e-3, 1e-3), "tissue": SOFT}, "matrix": {"pitch": 6e-3, "size": 5e-3}}
    thin |= {"mesh": FEW | {"cells": (6, 6, 2)}, "loading": pressed({"kind": "ramp", "to": 20e-6, "duration": 1.0})}
    held, glued = (run(**thin, contact=law) for law in ({"kind": "coulomb", "friction": 0.6}, {"kind": "stick"}))
    assert len(held.steps) == 1
    force, largest = (result.quantities["reaction_force"].value for result in (held, glued))
    assert 0.9 * largest < force < largest


def test_small_closings_press_in_proportion():
    """With a contact the stiffer the smaller the closing is, points stick and slip by turns, and none of these finds a way."""
    stiffness = []
    for closing in (1e-6, 1e-7):
        ramp = pressed({"kind": "ramp", "to": closing, "duration": 1.0})
        result = run(loading=ramp, mesh={"kind": "graded", "size": 10e-3, "edge_size": 3e-3, "growth": 1.0})
        assert result.status.value == "converged"
        stiffness.append(result.quantities["reaction_force"].value / closing)
    assert stiffness[0] == pytest.approx(stiffness[1], rel=2e-3)  # penetration takes a thousandth


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"inclusions": [{"shape": BALL | {"radius": 11e-3}, "material": "lump"}]},
            "sphere 1 protrudes by .* through the lower face",
        ),
        ({"inclusions": [{"shape": BALL, "material": "lump"}] * 2}, "sphere 1"),
        (
            {"inclusions": [{"shape": BALL, "material": "lump", "lumen": PULSE}]},
            r"inclusions.0.lumen: sphere 1 has no empty space",
        ),
        ({"inclusions": [{"shape": TUBE, "material": "lump"}]}, "structured cannot follow the wall of tube 1; take kind: tetra"),
        ({"inclusions": [], "mesh": {"kind": "layers"}}, "exactly one ball, stretched or not"),
        (
            {
                "inclusions": [{"shape": shape, "material": "lump"} for shape in (TUBE, aside(), aside(y=6e-3))],
                "mesh": {"kind": "graded"},
            },
            "mesh.kind: graded: graded cells serve one lump beside tubes, .*; take kind: tetrahedra",
        ),
        ({"loading": pressed({"kind": "ramp", "to": 10e-3, "duration": 1.0})}, "less than half the block's height 20 mm"),
        ({"loading": pressed({"kind": "ramp", "to": 1e-15, "duration": 1.0})}, "lost in round-off .*; allowed: from 2 pm on"),
        ({"loading": pressed({"kind": "ramp", "to": -1e-3, "duration": 1.0})}, "falls to -1 mm"),
        ({"loading": pressed({"kind": "hold", "duration": 1.0})}, "nothing happens"),
        ({"loading": pressed({"kind": "jump", "to": 0.0, "duration": 1.0}, control="force")}, "must press all the time"),
        ({"upper": {"width": 30e-3, "offset": (0.0, 60e-3)}}, None),
        ({"upper": {"width": 30e-3, "depth": 30e-3, "offset": (0.0, 34e-3)}}, "upper.offset: at 34 mm the jaw passes beside"),
        (
            {"lower": {"depth": 20e-3}},
            r"matrix: 29 mm wide at a pitch of 10 mm \(the default\), more than lower.depth 20 mm",
        ),
        ({"matrix": {"columns": 6, "pitch": 9e-3}}, "matrix: 54 mm wide at a pitch of 9 mm, more than upper.width 50 mm"),
        ({"matrix": {"pitch": 5e-3}}, r"taxels of 9 mm \(the default\) overlap at a pitch of 5 mm; size must"),
        ({"inclusions": [{"shape": BALL, "material": "lumps"}]}, "did you mean 'lump'"),
        ({"inclusions": [{"shape": TUBE, "material": "lump", "lumen": PULSE | {"systole": 0.0}}]}, "greater than 0"),
        ({"inclusions": [{"shape": TUBE, "material": "lump", "lumen": PULSE | {"diastole": 1e5}}]}, "above diastole 100 kPa"),
    ],
)
def test_what_cannot_be_grasped_is_refused(changes, words):
    if words is None:
        assert grasp(**changes).jaw("upper").depth > 2 * 60e-3, "a jaw without a size covers the block wherever it stands"
        return
    with pytest.raises(ValidationError, match=words):
        grasp(**changes)


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        (
            {"kind": "graded"},
            r"200 µm from the upper face; allowed: .* inside the block, less with a smaller mesh.inclusion_size$",
        ),
        ({"kind": "tetrahedra"}, r"200 µm .* less with a smaller mesh.inclusion_size$"),
        ({"kind": "automatic"}, r"200 µm .* less with a smaller inclusion_size under mesh.graded, or mesh.tetrahedra where .*$"),
    ],
)
def test_a_body_that_is_only_too_near_is_told_what_lets_it_be(mesh, words):
    near = BALL | {"radius": 2e-3, "center": (20e-3, 20e-3, 17.8e-3)}
    with pytest.raises(ValidationError) as refused:
        grasp(mesh=mesh, inclusions=[{"shape": near, "material": "lump"}])
    assert re.search(words, refused.value.errors()[0]["msg"])
    grasp(mesh={"kind": "graded", "inclusion_size": 1.5e-3}, inclusions=[{"shape": near, "material": "lump"}])
    with pytest.raises(ValidationError) as refused:
        grasp(mesh=mesh, inclusions=[{"shape": near | {"radius": 3e-3}, "material": "lump"}])
    assert refused.value.errors()[0]["msg"].endswith("inside the block"), "it protrudes from any mesh"


def test_a_body_that_protrudes_is_told_the_distance_that_graded_cells_need():
    ball = BALL | {"radius": 11e-3}
    with pytest.raises(ValidationError, match="at least 250 µm inside the block"):  # tetrahedra need 780 µm
        grasp(mesh={"kind": "automatic"}, inclusions=[{"shape": ball, "material": "lump"}])


def test_jaws_grow_with_the_block_so_that_their_backs_are_out_of_reach():
    narrow = {"width": 200e-3, "depth": 200e-3, "fillet": 8e-3}  # more than half of 10 mm
    large = {"size": (400e-3, 400e-3, 300e-3), "tissue": grasp().block.tissue}
    jaw = grasp(block=large, upper=narrow).jaw("upper")
    assert jaw.thickness >= 300e-3, "tissue bulges beside it by less than the height of the block"


@pytest.mark.parametrize(("closing", "warned"), [(2.7e-3, False), (2.9e-3, True)])
def test_a_block_that_is_closed_so_far_that_elements_wrinkle_is_warned_of(closing, warned):
    result = run(
        block={"size": (40e-3, 40e-3, 20e-3), "tissue": {"kind": "neo_hookean", "c10": 2e3}},
        contact={"kind": "coulomb", "friction": 0.0},
        loading=pressed({"kind": "ramp", "to": closing, "duration": 1.0}),
        mesh={"kind": "structured", "cells": (2, 2, 1)},
    )
    assert any("wrinkle" in words for words in result.warnings) is warned


def test_a_mesh_that_does_not_fit_the_case_is_refused(tube_file):
    tube = {"shape": TUBE, "material": "artery_wall"}
    with pytest.raises(InputError, match=r"2 regions, the case has 3: the tissue and 2 inclusions"):
        run(mesh=tube_file, inclusions=[tube | {"shape": TUBE | {"inner_radius": 2e-3}}, {"shape": aside(), "material": "lump"}])
    with pytest.raises(InputError, match="unit right"):
        run(mesh=tube_file | {"unit": "m"}, inclusions=[tube])
    with pytest.raises(InputError, match="too coarse: no element lies in sphere 1; take more cells, or leave mesh out"):
        run(inclusions=[{"shape": BALL | {"radius": 0.5e-3}, "material": "lump"}])
    with pytest.raises(InputError, match=r"region 1 .* shares .* of its place with tube 1"):
        run(mesh=tube_file | {"regions": {"5": 1, "6": 0}}, inclusions=[tube])
    elsewhere = TUBE | {"centre_line": [(0.0, 8e-3, 10e-3), (40e-3, 8e-3, 10e-3)]}
    with pytest.raises(InputError, match=r"region 1 .* shares .* of its place with tube 1"):
        run(mesh=tube_file, inclusions=[tube | {"shape": elsewhere}])


def test_a_mesh_that_fills_the_lumen_is_refused(tmp_path):
    block = structured_block(SIZE, (1, 16, 8), [Tube.model_validate(TUBE)])
    full = structured_block(SIZE, (1, 16, 8))
    regions = np.zeros(len(full.mesh.elements), int)
    corners = full.mesh.nodes[full.mesh.elements[:, :4]].mean(axis=1)
    wall = {tuple(place) for place in block.mesh.nodes[block.mesh.elements[block.mesh.regions == 1, :4]].mean(axis=1).round(9)}
    regions[[tuple(place) in wall for place in corners.round(9)]] = 1
    path, count = tmp_path / "full.vtu", full.mesh.corner_count
    cells = meshio.CellBlock("tetra", full.mesh.elements[:, :4])
    meshio.Mesh(full.mesh.nodes[:count], [cells], cell_data={"region": [regions]}).write(path)
    mesh = {"kind": "file", "path": str(path), "unit": "m", "regions": {"0": 0, "1": 1}}
    with pytest.raises(InputError, match=r"no facet of the mesh lies on lumen:1; an empty space must be left out"):
        run(mesh=mesh, inclusions=[{"shape": TUBE, "material": "artery_wall"}])


def test_touching_lumps_are_refused_in_cells_too():
    touching = [BALL | {"center": (x, 20e-3, 10e-3)} for x in (15e-3, 25e-3)]
    with pytest.raises(ValidationError, match=r"sphere 1 and sphere 2 (are|overlap by) .*; allowed: at least 10 µm between"):
        grasp(inclusions=[{"shape": ball, "material": "lump"} for ball in touching])


@pytest.mark.parametrize("part", [1.0, 0.64])
def test_a_mesh_of_smaller_elements_than_asked_for_says_so(part, monkeypatch):
    made = StructuredSource.sourced

    def smaller(self, *block_and_jaws):
        sourced = made(self, *block_and_jaws)
        return replace(sourced, block=replace(sourced.block, part=part))

    monkeypatch.setattr(StructuredSource, "sourced", smaller)
    result = run(mesh={"kind": "structured", "cells": (4, 4, 4)})
    said = [words for words in result.assumptions if "mesh.inclusion_size" in words]
    assert [words.split()[3] for words in said] == ([] if part == 1 else ["0.64"])


@pytest.mark.parametrize("before", [False, True])
def test_the_time_in_which_a_mesh_was_made_earlier_is_none_of_this_run(before, monkeypatch):
    sourced = StructuredSource.sourced
    monkeypatch.setattr(StructuredSource, "sourced", lambda *given: replace(sourced(*given), made_before=before))
    result = run(mesh={"kind": "structured", "cells": (4, 4, 4)})
    assert ("meshing" in result.timing) is not before
    assert ["once made in" in words for words in result.assumptions if "made in" in words] == [before]


def test_a_ragged_lump_is_reported():
    lump = {"shape": BALL, "material": "lump"}
    result = run(mesh={"kind": "structured", "cells": (4, 4, 4)}, inclusions=[lump], loading=pressed(RAMP))
    assert any("the mesh gives sphere 1" in words for words in result.warnings)


def test_another_mesh_source_carries_the_content():
    sourced = grasp_mesh(grasp(mesh={"kind": "layers"}, inclusions=[{"shape": BALL, "material": "lump"}]))
    assert sourced.origin == "built in layers"
    assert replace(sourced, origin="").content == sourced.content
    assert len(sourced.content) == 32


@pytest.mark.parametrize(("end", "said"), [("0 mm", True), ("0.1 mm", False)])
def test_a_grasp_that_fails_once_its_jaws_have_let_go_says_so(monkeypatch, end, said):
    """It advised another mesh, though nothing held the block any more."""
    begun = Grasp._begun

    def failing(self):
        path, record = begun(self)

        def states():
            yield from path.states()
            raise ConvergenceError("no way on")

        return SimpleNamespace(states=states), record

    monkeypatch.setattr(Grasp, "_begun", failing)
    pieces = [{"kind": "ramp", "to": to, "duration": "1 s"} for to in ("0.2 mm", end)]
    result = run(loading=pressed(*pieces))
    assert result.reason.startswith("stopped converging: no way on")
    assert ("The jaws had let go of the block: they pressed with " in result.reason) == said


def test_doubts_are_known_before_anything_is_solved():
    plain = Grasp.example()
    assert plain.doubts() == []
    wide = plain.model_copy(update={"matrix": plain.matrix.model_copy(update={"pitch": 20e-3})})
    beyond = [f"8 of 9 taxels of the {side} jaw reach beyond the block" for side in JAWS]
    assert [doubt.split(":")[0] for doubt in wide.doubts()] == beyond
    huge = plain.model_copy(update={"block": plain.block.model_copy(update={"size": (40.0, 40.0, 20.0)})})
    assert any("block.size" in doubt for doubt in huge.doubts())
