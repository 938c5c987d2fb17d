"""The figures of a grasp: cut, maps, view in space and histories of a made-up result."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from drawn import colliding_words, text_of
from matplotlib.axes import Axes
from scenes import Unrendered, grasp_scene, unmarked_figures
from solids import assert_close

from tactsim.cli.figures.result_figures import rendered_figures
from tactsim.errors import TactsimError
from tactsim.experiments.grasp.figures import view as grasp_view
from tactsim.experiments.grasp.figures.grasp import history_figure, maps_figure, section_figure
from tactsim.experiments.grasp.figures.moment import shown_moment
from tactsim.experiments.grasp.figures.section import CuttingPlane, cutting_plane
from tactsim.experiments.grasp.figures.viewed import outline, viewed
from tactsim.experiments.grasp.figures.views import views_figure
from tactsim.experiments.grasp.scene import SimulatedGrasp
from tactsim.interfaces.drawing import BegunDrawing
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.structured_block import morphed_block
from tactsim.outside.processes import Ended
from tactsim.plotting import canvas, figures_for, off_screen
from tactsim.plotting.plane_cut import OUTER, interfaces, plane_cut
from tactsim.results import FieldFrame, Quantity, Result, Status, StepRecord
from tactsim.results.fields import CORNER_PRESSURE

SIZE = np.array([40e-3, 40e-3, 20e-3])
SPHERE = Sphere(center=(20e-3, 20e-3, 12e-3), radius=5e-3)
CLOSING = 1e-3
STEPS = 6
ENDS = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]
"""Corners of a tetrahedron at the ends of its edges, in the order of VTK."""


def made_up_frame():
    """A block squeezed by 1 mm from above and below that bulges, its pressure highest over the lump."""
    mesh = morphed_block(SIZE, SPHERE, BlockMeshSettings(size=5e-3, inclusion_size=2e-3)).mesh
    x, y, z = (mesh.nodes / SIZE - 0.5).T
    bulge = 0.08 * (1 - 3 * z**2)
    moved = np.stack([bulge * x * SIZE[0], bulge * y * SIZE[1], -2 * CLOSING * z], axis=1)
    away = ((mesh.nodes - SPHERE.center) ** 2).sum(axis=1)
    pressure = 4e3 * np.exp(-away / 8e-3**2) + 2e3 * np.exp(-4 * (x**2 + y**2))
    pressure[mesh.elements[:, 4:]] = pressure[mesh.elements[:, ENDS]].mean(axis=2)
    fields = {"displacement [m]": moved, "pressure [Pa]": pressure}
    return FieldFrame(1.0, mesh.nodes, {"tetra10": mesh.elements}, fields, {"region [1]": mesh.regions.astype(float)})


def made_up(*, frame=None, status=Status.CONVERGED, steps=STEPS, tilt=0.0, layout=None):
    """A grasp with a lump nearer to the upper jaw."""
    layout = layout or TaxelLayout()
    x, y = ((layout.borders(along).mean(axis=1)) for along in "xy")
    shape = np.exp(-((y[:, None] - 2e-3) ** 2 + (x[None] - 1e-3) ** 2) / 9e-3**2)
    pressure = {"upper": 2e3 + 5e3 * shape, "lower": 2.2e3 + 1.5e3 * shape}
    course = np.linspace(1 / steps, 1, steps)
    quantities = {"displacement": Quantity(CLOSING, "m", "")}
    for side in JAWS:
        force = pressure[side] * layout.area
        quantities |= {
            f"taxel_pressure_{side}": Quantity(pressure[side].tolist(), "Pa", ""),
            f"taxel_force_{side}": Quantity(force.tolist(), "N", ""),
            f"taxel_force_{side}_history": Quantity((course[:, None, None] ** 1.3 * force).tolist(), "N", ""),
        }
    scene = grasp_scene(SIZE, layout, [SPHERE], closing=CLOSING - 25e-3 * abs(tilt), tilt_y=tilt)
    records = tuple(
        StepRecord(
            k + 1,
            4,
            1e-12,
            {"time": s, "displacement": s * CLOSING, "jaw_force_upper_z": 5 * s**1.3, "jaw_force_lower_z": -5.1 * s**1.3}
            | {"lumen_pressure_1": 1e4 + 2e3 * np.sin(6 * s)},
        )
        for k, s in enumerate(course)
    )
    frames = () if frame is None else (frame,)
    return Result("grasp", status, "because", quantities, steps=records, frames=frames, title="A made-up grasp", scene=scene)


@pytest.fixture(scope="module")
def frame():
    return made_up_frame()


def test_cut_has_the_areas_and_outlines_of_block_and_lump(frame):
    still = replace(frame, point_data={**frame.point_data, "displacement [m]": np.zeros_like(frame.points)})
    for level, radius in ((20e-3, 5e-3), (23e-3, 4e-3)):
        cut = plane_cut(still, 1, level, frame.points[:, 0])
        assert cut.areas().sum() == pytest.approx(SIZE[0] * SIZE[2], rel=1e-3)  # slivers are left out
        np.testing.assert_allclose(cut.values, cut.triangles[:, :, 0], atol=1e-12)
        lump = (cut.between == [0, 1]).all(axis=1)
        away = np.linalg.norm(cut.segments[lump] - SPHERE.center[::2], axis=2)
        np.testing.assert_allclose(away, radius, rtol=0.02)  # quadratic elements on the sphere
        lengths = np.linalg.norm(np.diff(cut.segments, axis=1)[:, 0], axis=1)
        assert lengths[lump].sum() == pytest.approx(2 * np.pi * radius, rel=0.01)
        assert lengths[~lump].sum() == pytest.approx(2 * (SIZE[0] + SIZE[2]), rel=1e-9)
        assert (cut.between[~lump] == [OUTER, 0]).all()


def test_cut_of_a_deformed_block_is_where_the_plane_is_now(frame):
    moved = frame.points * [1.0, 2.0, 1.0] + [0.0, 5e-3, 0.0] - frame.points
    shifted = replace(frame, point_data={**frame.point_data, "displacement [m]": moved})
    assert len(plane_cut(shifted, 1, 3e-3, frame.points[:, 1]).triangles) == 0
    np.testing.assert_allclose(plane_cut(shifted, 1, 25e-3, frame.points[:, 1]).values, 10e-3, atol=1e-12)


def test_values_of_elements_may_jump_where_regions_meet(frame):
    regions = np.asarray(frame.cell_data["region [1]"])
    by_element = np.repeat(1.0 + regions[:, None], 4, axis=1)
    jumping = plane_cut(frame, 1, 20e-3, by_element)
    assert set(np.unique(jumping.values.round(9))) == {1.0, 2.0}
    nodal = np.ones(len(frame.points))
    nodal[np.unique(frame.cells["tetra10"][regions == 1])] = 2.0
    assert len(np.unique(plane_cut(frame, 1, 20e-3, nodal).values.round(3))) > 2
    linear = frame.points[frame.cells["tetra10"][:, :4], 0]
    whole = plane_cut(frame, 1, 20e-3, frame.points[:, 0])
    assert plane_cut(frame, 1, 20e-3, linear).values.max() == pytest.approx(whole.values.max(), rel=0.02)


def test_an_artery_is_shown_at_its_highest_pressure_in_every_picture(frame, monkeypatch):
    result = made_up(frame=frame)
    course = [0.0, 1e3, 5e3, 2e3, 1e3, 0.0]
    steps = tuple(
        replace(step, values=step.values | {"lumen_pressure_1": p}) for step, p in zip(result.steps, course, strict=True)
    )
    frames = (replace(frame, time=steps[2].values["time"]), replace(frame, time=steps[-1].values["time"]))
    pulsing = replace(result, steps=steps, frames=frames)
    shown = shown_moment(pulsing)
    assert [frame.time for frame in shown.frames] == [frames[0].time]
    assert shown.steps == steps
    force = np.asarray(result.quantities["taxel_force_upper_history"].value)[2]
    np.testing.assert_array_equal(shown.quantities["taxel_force_upper"].value, force)
    opened = CLOSING - steps[2].values["displacement"]
    assert shown.scene_as(SimulatedGrasp).jaw_places["upper"][2] == pytest.approx(SIZE[2] - CLOSING + opened)
    monkeypatch.setattr(grasp_view, "Rendering", Unrendered)
    pictures = {name: text_of(picture.figure()) for name, picture in figures_for(pulsing).items() if hasattr(picture, "figure")}
    pictures["grasp_view.png"] = grasp_view.view_figure(shown, grasp_view.view_rendering(shown)).get_suptitle()
    told = {name for name, words in pictures.items() if "highest pressure, 5 kPa" in words}
    assert told == set(pictures) - {"grasp_history.png"}, "a picture of another moment, or of one that is not named"
    assert pulsing.plot()["grasp_view"].get_suptitle() == pictures["grasp_view.png"]
    assert shown_moment(result) is result
    assert shown_moment(replace(pulsing, frames=frames[1:])).quantities == pulsing.quantities


def test_walls_of_an_artery_do_not_take_the_colours_of_the_tissue(frame):
    """The same region at a hundred times its pressure, once as a ball, once as the wall of a tube."""
    corners = frame.point_data["pressure [Pa]"][frame.cells["tetra10"][:, :4]]
    stiff = corners * np.where(frame.cell_data["region [1]"] == 1, 100.0, 1.0)[:, None]
    result = made_up(frame=replace(frame, cell_data={**frame.cell_data, CORNER_PRESSURE: stiff}))
    tube = Tube(centre_line=((0, 20e-3, 12e-3), (40e-3, 20e-3, 12e-3)), inner_radius=4e-3, wall=1e-3)
    artery = replace(result, scene=grasp_scene(SIZE, TaxelLayout(), [tube], closing=CLOSING))
    highest, labels = {}, {}
    for name, shown in (("ball", result), ("tube", artery)):
        figure = section_figure(shown)
        highest[name] = figure.axes[0].collections[0].get_clim()[1]
        labels[name] = text_of(figure)
    assert highest["ball"] > 100  # kPa
    assert 4 < highest["tube"] < 7
    assert "of the area outside walls" in labels["tube"]
    assert "outside walls" not in labels["ball"]


def test_interfaces_close_every_region_once(frame):
    faces, between = interfaces(frame)
    corners = frame.points[faces[:, :3]]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    outer = between[:, 0] == OUTER
    sides = SIZE[[0, 0, 1]] * SIZE[[1, 2, 2]]
    assert areas[outer].sum() == pytest.approx(2 * sides.sum(), rel=1e-9)
    volumes = np.linalg.det(corners) / 6  # of the cones from the origin, which add up if all faces look outward
    assert volumes[outer].sum() == pytest.approx(SIZE.prod(), rel=1e-9)
    assert volumes[~outer].sum() == pytest.approx(4 / 3 * np.pi * SPHERE.radius**3, rel=0.15)
    assert areas[~outer].sum() == pytest.approx(4 * np.pi * SPHERE.radius**2, rel=0.1)  # flat facets of a coarse ball


def test_plane_passes_the_inclusion_and_crosses_a_long_one(frame):
    assert cutting_plane(frame, SIZE) == CuttingPlane(1, pytest.approx(20e-3, abs=1e-4), 1)
    rod = np.abs(frame.points[frame.cells["tetra10"]].mean(axis=1)[:, 1:] - [20e-3, 10e-3]).max(axis=1) < 5e-3
    along_x = replace(frame, cell_data={"region [1]": rod.astype(float)})
    assert cutting_plane(along_x, SIZE) == CuttingPlane(0, pytest.approx(20e-3, abs=1e-4), 1)
    bare = replace(frame, cell_data={"region [1]": 0.0 * rod})
    assert cutting_plane(bare, SIZE) == CuttingPlane(1, 20e-3, 0)


def test_outline_of_a_ball_is_that_of_its_disc():
    x, y, distance = outline(SPHERE.solids(SIZE)[0], SIZE, 2)
    covered = (distance < 0).astype(float)
    area = covered.sum() * (x[1] - x[0]) * (y[1] - y[0])
    assert area == pytest.approx(np.pi * 5.0**2, rel=0.02)
    middle = ((covered * x).sum() / covered.sum(), (covered * y[:, None]).sum() / covered.sum())
    np.testing.assert_allclose(middle, [20.0, 20.0], atol=0.1)


def test_maps_put_row_1_in_front_and_column_1_at_the_smallest_x():
    pressures = {"upper": np.arange(1.0, 7.0).reshape(2, 3) * 1e3, "lower": np.full((2, 3), 5e2)}
    result = made_up(layout=TaxelLayout(rows=2, columns=3, pitch=8e-3, size=6e-3))
    written = {f"taxel_pressure_{side}": Quantity(pressures[side].tolist(), "Pa", "") for side in JAWS}
    axes = maps_figure(replace(result, quantities={**result.quantities, **written})).axes
    places = {text.get_text().removesuffix(" kPa"): text.get_position() for text in axes[0].texts}
    assert places["1.00"][0] == pytest.approx(12.0)
    assert places["1.00"][1] == pytest.approx(16.0)
    assert places["3.00"][0] == pytest.approx(28.0)
    assert places["4.00"][1] == pytest.approx(24.0)
    assert {"row 1", "row 2", "col. 3"} <= set(places)
    assert "0.50" in {text.get_text() for text in axes[1].texts}
    squares = [next(c for c in axis.collections if len(c.get_facecolor()) == 6) for axis in axes[:2]]
    assert tuple(squares[0].get_facecolor()[0]) != tuple(squares[1].get_facecolor()[0])


def test_forces_on_the_maps_keep_the_zeros_that_count():
    result = made_up(layout=TaxelLayout(rows=1, columns=2))
    forces = {"upper": [[0.302, 0.27]], "lower": [[0.0, -0.1]]}
    written = {f"taxel_force_{side}": Quantity(force, "N", "") for side, force in forces.items()}
    axes = maps_figure(replace(result, quantities={**result.quantities, **written})).axes
    assert {"0.30 N", "0.27 N"} <= {text.get_text() for text in axes[0].texts}
    assert {"0 N", "−0.10 N"} <= {text.get_text() for text in axes[1].texts}


def test_no_taxel_is_left_out_of_those_that_carry_most_by_round_off():
    """Of eight taxels alike by symmetry seven were named."""
    force = np.array([[1.0, 2.0, 1.0], [2.0, 3.0, 2.0], [1.0, 2.0, 1.0]])
    course = np.linspace(1 / STEPS, 1, STEPS)[:, None, None]
    histories = {
        f"taxel_force_{side}_history": Quantity((course * force * (1 + sign * 1e-15)).tolist(), "N", "")
        for side, sign in (("upper", -1), ("lower", 1))
    }
    result = made_up()
    axes = history_figure(replace(result, quantities={**result.quantities, **histories})).axes
    assert axes[0].get_title(loc="left").endswith("straight between the solved steps (marks)")
    axis = axes[-1]
    assert axis.get_title(loc="left").startswith("the 10 of 18 taxels that carry most")
    assert [len(text.get_text().split()) for text in axis.get_legend().get_texts()] == [2, 8]
    assert {line.get_linestyle() for line in axis.get_lines()} == {"-"}  # as of the upper jaw, which is the first


def test_a_legend_of_many_taxels_alike_counts_those_that_it_does_not_name():
    force = np.linspace(1 / STEPS, 1, STEPS)[:, None, None] * np.ones((4, 5))
    histories = {f"taxel_force_{side}_history": Quantity(force.tolist(), "N", "") for side in JAWS}
    result = made_up(layout=TaxelLayout(rows=4, columns=5, pitch=6e-3, size=5e-3))
    axis = history_figure(replace(result, quantities={**result.quantities, **histories})).axes[-1]
    (text,) = (text.get_text() for text in axis.get_legend().get_texts())
    assert text.endswith("U4,1 U4,2 U4,3\nand 22 more")


def test_a_small_grasp_is_drawn_as_a_large_one():
    pictures = []
    for part in (1.0, 0.1):
        layout = TaxelLayout(pitch=part * 11e-3, size=part * 9e-3)
        jaw = {name: part * length for name, length in {"width": 50e-3, "depth": 50e-3, "fillet": 2e-3}.items()}
        scene = grasp_scene(part * np.array(SIZE), layout, closing=part * CLOSING, **jaw)
        axis = maps_figure(replace(made_up(layout=layout), scene=scene)).axes[0]
        named = next(text for text in axis.texts if text.get_text() == "row 1")
        pictures.append([*axis.get_xlim(), *axis.get_ylim(), *named.get_position()])
    assert_close(pictures[1], 0.1 * np.array(pictures[0]), 1e-12)


@pytest.mark.parametrize(
    ("layout", "form"),
    [
        (TaxelLayout(), r"\d\.\d\d kPa"),
        (TaxelLayout(rows=4, columns=4, pitch=9e-3, size=8e-3), r"\d\.\d\d"),
        (TaxelLayout(rows=4, columns=5, pitch=7.2e-3, size=6.4e-3), r"\d\.\d\d"),
        (TaxelLayout(rows=8, columns=8, pitch=4.5e-3, size=4e-3), r"\d\.\d"),
    ],
    ids=["three by three", "four by four", "four by five", "eight by eight"],
)
@pytest.mark.parametrize("status", [Status.CONVERGED, pytest.param(Status.FAILED, marks=pytest.mark.slow)])
def test_pressures_fit_into_their_taxels_and_are_legible(layout, form, status):
    """With their unit and the force beneath them those of four by five were written in letters of 4 and 3 points."""
    shape = (layout.rows, layout.columns)
    pressure = np.random.default_rng(1).uniform(0.3e3, 5e3, shape)
    loads = {f"taxel_pressure_{side}": Quantity(pressure.tolist(), "Pa", "") for side in JAWS}
    result = made_up(layout=layout, status=status)
    figure = maps_figure(replace(result, quantities=result.quantities | loads))
    figure.draw_without_rendering()
    for axis in figure.axes[:2]:
        taxel = np.ptp(axis.transData.transform([(0, 0), (1e3 * layout.size, 0)])[:, 0])
        written = [text for text in axis.texts if re.fullmatch(form, text.get_text())]
        assert len(written) == layout.rows * layout.columns
        assert max(text.get_window_extent().width for text in written) <= taxel
        assert min(text.get_fontsize() for text in written) >= 5.0


def test_pressures_that_would_not_be_legible_are_left_to_the_colours():
    words = text_of(maps_figure(made_up(layout=TaxelLayout(rows=8, columns=8, pitch=2.5e-3, size=2.3e-3))))
    assert "kPa" in words
    assert "beneath it the force" not in words
    assert not re.search(r"\d kPa", words)


def test_sums_of_the_taxels_keep_their_zeros():
    """2.61 N stood beside 2.6 N."""
    layout = TaxelLayout()
    pressure = np.full((layout.rows, layout.columns), 2.6 / layout.area / layout.rows / layout.columns)
    result = made_up(layout=layout)
    loads = {f"taxel_force_{side}": Quantity((pressure * layout.area).tolist(), "N", "") for side in JAWS}
    words = text_of(maps_figure(replace(result, quantities=result.quantities | loads)))
    assert "upper jaw (U): 2.60 N on the taxels" in words


def test_large_matrix_shows_colours_only():
    words = text_of(maps_figure(made_up(layout=TaxelLayout(rows=12, columns=12, pitch=2.5e-3, size=2e-3))))
    assert "N on the taxels" in words
    assert "kPa" in words


def test_figures_show_what_is_seen(frame):
    result = made_up(frame=frame, tilt=0.02)
    section = text_of(section_figure(result))
    for words in ("A made-up grasp", "cut at y = 20 mm through the middle of sphere 1", "pressure in the tissue in kPa", "U2,2"):
        assert words in section
    maps = text_of(maps_figure(result))
    for words in ("upper jaw", "lower jaw (L)", "x in mm", "row 3"):
        assert words in maps
    course = text_of(history_figure(result))
    for words in ("pressure in the lumen", "time in s", "9 of 18 taxels"):
        assert words in course


def test_the_panels_of_a_history_have_one_axis_of_time():
    """The forces begin at rest, the pressure in an artery at the first step: a pulse seemed to come before its forces."""
    assert len({axis.get_xlim() for axis in history_figure(made_up()).axes}) == 1


def test_history_without_time_is_over_the_closing():
    result = made_up()
    steps = tuple(replace(s, values={n: v for n, v in s.values.items() if n != "time"}) for s in result.steps)
    assert "closing of each jaw in mm" in text_of(history_figure(replace(result, steps=steps)))


def test_single_step_without_fields_leaves_the_maps():
    alone = made_up(steps=1)
    assert list(figures_for(alone)) == ["grasp_maps.png", "views.png"]
    assert "time in s" not in text_of(maps_figure(alone))
    assert figures_for(replace(alone, steps=())) == {}


def test_failed_run_is_marked(frame, monkeypatch):
    assert "FAILED; the last accepted step is shown: because" in text_of(maps_figure(made_up(status=Status.FAILED)))
    monkeypatch.setattr(grasp_view, "Rendering", Unrendered)
    assert unmarked_figures(made_up(frame=frame)) == []


def test_maps_come_first_and_the_view_last(frame):
    drawings = figures_for(made_up(frame=frame))
    names = [
        "grasp_maps.png",
        "grasp_section.png",
        "grasp_history.png",
        "views.png",
        "grasp_view.png",
    ]
    assert list(drawings) == names
    assert [name for name, draw in drawings.items() if isinstance(draw, BegunDrawing)] == [grasp_view.VIEW]
    assert drawings["grasp_history.png"]().startswith(b"\x89PNG")


def test_camera_projects_to_pixels():
    camera = off_screen.Camera((0.0, 0.0, 0.0), (0.0, -1.0, 0.0), 2.0, (200, 100))
    np.testing.assert_allclose(camera.project(np.array([[0, 0, 0], [1, 5, 0], [0, 5, 1]])), [[100, 50], [125, 50], [100, 25]])


def test_view_shows_the_scene_where_the_camera_puts_it():
    corners = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1]])
    camera = off_screen.Camera((0.0, 0.0, 0.0), (0.0, -1.0, 0.0), 2.0, (200, 100))
    surface = off_screen.Surface(corners, np.array([[0, 1, 2]]), np.array([[1.0, 0.0, 0.0]]))
    try:
        (content,) = off_screen.Rendering([surface], [camera]).pictures()
    except TactsimError as error:
        pytest.skip(str(error))
    red = content[:, :, 1] < 128
    y, x = np.nonzero(red)
    assert red.sum() == pytest.approx(25**2 * 2, rel=0.05)
    np.testing.assert_allclose([x.min(), x.max(), y.min(), y.max()], [75, 125, 25, 75], atol=1.5)


class Unable:
    """A renderer that ends at once, without a picture."""

    def __init__(self, *arguments, **options):
        self.stopped = False

    def wait(self, time_limit):
        return Ended(-6, "WARN| libOSMesa not found.")

    def stop(self):
        self.stopped = True


def test_machine_that_cannot_render_says_why(monkeypatch, frame):
    monkeypatch.setattr(off_screen, "Child", Unable)
    monkeypatch.setattr(canvas, "encoded", lambda figure, form: b"")  # how the others look is of no interest
    drawn, warnings = rendered_figures(made_up(frame=frame))
    assert grasp_view.VIEW not in drawn
    assert "grasp_maps.png" in drawn
    assert re.search(r"grasp_view\.png is left out.*libOSMesa not found", " ".join(warnings))


def test_a_rendering_that_nobody_waits_for_leaves_nothing(monkeypatch):
    begun = []
    monkeypatch.setattr(off_screen, "Child", lambda *arguments, **options: begun.append((Unable(), arguments)) or begun[0][0])
    off_screen.Rendering([], [])
    ((child, (_, (scene, _))),) = begun
    assert child.stopped
    assert not Path(scene).parent.exists()


def test_a_rendering_that_cannot_start_leaves_nothing(monkeypatch):
    begun = []

    def refused(module, arguments, **options):
        begun.append(Path(arguments[0]).parent)
        raise OSError("no more processes")

    monkeypatch.setattr(off_screen, "Child", refused)
    with pytest.raises(OSError, match="no more processes"):
        off_screen.Rendering([], [])
    assert not begun[0].exists()


def test_view_names_what_it_shows(monkeypatch, frame):
    monkeypatch.setattr(grasp_view, "Rendering", Unrendered)
    result = made_up(frame=frame)
    rendering = grasp_view.view_rendering(result)
    words = text_of(grasp_view.view_figure(result, rendering))
    for expected in ("upper jaw", "lower jaw", "sphere 1", "each jaw closed by 1 mm", "kPa"):
        assert expected in words
    surfaces, cameras = rendering.surfaces, rendering.cameras
    for camera in cameras:
        places = camera.project(np.concatenate([surface.points for surface in surfaces]))
        assert (places > 0).all()
        assert (places < camera.pixels).all()


def test_columns_closer_than_their_names_have_the_first_and_the_last_named():
    """Eight columns at 2.5 mm were named over one another."""
    result = made_up(layout=TaxelLayout(rows=8, columns=8, pitch=2.5e-3, size=2.2e-3))
    figure = views_figure(result, viewed(result))
    top = next(axis for axis in figure.axes if axis.get_title(loc="left").startswith("top"))
    named = {text.get_text() for text in top.texts}
    assert named == {"row 1", "row 8", "col. 1", "col. 8"}


@pytest.mark.parametrize(
    "size",
    [
        (30.5e-3, 32e-3, 20e-3),
        pytest.param((24e-3, 24e-3, 16e-3), marks=pytest.mark.slow),
        pytest.param((24e-3, 30e-3, 40e-3), marks=pytest.mark.slow),
    ],
)
def test_the_words_of_the_views_stand_clear_in_blocks_of_any_shape(size):
    """The title of the front view lay on the name of the axis above it where the top view just filled its place."""
    layout = TaxelLayout(rows=3, columns=4, pitch=6e-3, size=5e-3)
    scene = grasp_scene(np.array(size), layout, [SPHERE], closing=CLOSING)
    result = replace(made_up(layout=layout), title="Two lumps", scene=scene)
    assert colliding_words(views_figure(result, viewed(result))) == []


def test_the_numbers_of_the_taxels_show_no_round_off():
    """Forces of 8.77e-12 mN beside one of 15 mN were wider than their taxel."""
    result = made_up()
    grasp = viewed(result)
    signal = np.full((2, 3, 3), 14.8e-3)
    signal[0, 0], signal[1, 2] = (8.77e-15, -2e-15, 0.568e-3), (-0.5647e-3, 0.0, 1.02e-3)
    figure = views_figure(result, replace(grasp, signal=signal))
    maps = {axis.get_title(loc="left"): {text.get_text() for text in axis.texts} for axis in figure.findobj(Axes)}
    assert maps["upper jaw in mN"] == {"0", "0.568", "14.8"}
    assert maps["lower jaw in mN"] == {"0", "−0.565", "1.02", "14.8"}


def test_the_views_say_that_jaws_are_not_above_each_other():
    result = made_up()
    assert viewed(result).taxels_in_words == "taxels,"
    x, y, z = result.scene.jaw_places["upper"]
    scene = result.scene.model_copy(update={"jaw_places": result.scene.jaw_places | {"upper": (x + 2e-3, y, z)}})
    assert viewed(replace(result, scene=scene)).taxels_in_words == "taxels, midway between the jaws;"


def test_a_cut_between_taxels_says_that_it_meets_none(frame):
    assert "no taxel" not in section_figure(made_up(frame=frame)).axes[0].get_title(loc="left")
    four = made_up(frame=frame, layout=TaxelLayout(rows=4, columns=4, pitch=9e-3, size=8e-3))
    assert section_figure(four).axes[0].get_title(loc="left").endswith("\nno taxel is cut")
