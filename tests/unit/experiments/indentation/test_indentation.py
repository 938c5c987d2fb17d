"""What an indentation accepts, how it goes past the touch, and what it keeps when the mesh is refined or the user stops it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tactsim.contact.annulus import Annulus
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.sphere import Sphere
from tactsim.errors import CaseError, Collapsed
from tactsim.experiments.indentation.course import DisplacementPath, HistoryPath
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.indentation_3d import Indentation3D
from tactsim.experiments.indentation.record import energy_assumptions
from tactsim.experiments.indentation.scene import IndentationScene
from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.materials.library import named_material
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.specimen import Layer, Specimen
from tactsim.progress import Extent

SOFT = NeoHookean(c10=1000.0)
COARSE = MeshSettings(finest=0.3e-3, growth=1.0)


def thin(**changes):
    specimen = changes.pop("specimen", {})
    given = {
        "specimen": Specimen(**({"material": SOFT, "thickness": 3e-3, "radius": 7e-3} | specimen)),
        "body": Annulus(fillet=0.4e-3),
        "recess": 0.2e-3,
        "displacement": 0.6e-3,
        "mesh": COARSE,
        "steps": {"first": 0.05e-3},
    }
    return Indentation(**(given | changes))


def run(**changes):
    return thin(**changes).run()


@pytest.fixture(scope="module")
def plain():
    return run()


def test_threshold_quantities(plain):
    values = {name: quantity.value for name, quantity in plain.quantities.items()}
    assert plain.status == "converged"
    assert values["tissue_rise"] == pytest.approx(0.2e-3, rel=1e-4)
    assert values["threshold_pressure"] == pytest.approx(values["threshold_force"] / (np.pi * (3e-3**2 - 1.5e-3**2)))
    assert values["threshold_displacement"] == values["displacement"] < 0.6e-3
    assert any("fillet" in text for text in plain.assumptions)
    assert {name for step in plain.steps for name in step.values} <= set(plain.units)


def test_a_run_that_ends_before_its_first_state_has_no_profile_of_contact_pressure():
    findings = thin().begin().findings()
    assert not findings.steps
    assert findings.scene.contact is None


def test_the_profile_of_contact_pressure_is_that_of_hertz():
    """Hertz 1882; to 3 % of the pressure at the axis, as an element is a seventh of the contact's radius."""
    radius, depth = 10e-3, 0.05e-3
    ball = thin(
        specimen={"thickness": 30e-3, "radius": 30e-3},
        body=Sphere(radius=radius),
        contact=Coulomb(friction=0.0),
        recess=None,
        stop="displacement",
        displacement=depth,
        mesh=MeshSettings(finest=0.1e-3, growth=1.5, adaptive=False),
        steps={"first": 0.025e-3},
    ).run()
    profile = ball.scene_as(IndentationScene).contact
    distance, pressure, area = (np.array(values) for values in (profile.radius, profile.pressure, profile.area))
    contact_radius = np.sqrt(radius * depth)
    plane_modulus = 3 * SOFT.shear_modulus / (1 - 0.25)
    highest = 2 * plane_modulus / np.pi * np.sqrt(depth / radius)
    inside = distance < 0.9 * contact_radius
    assert inside.sum() >= 6
    expected = highest * np.sqrt(1 - (distance[inside] / contact_radius) ** 2)
    np.testing.assert_allclose(pressure[inside], expected, atol=0.03 * highest)
    assert not pressure[distance > 1.2 * contact_radius].any()
    assert pressure @ area == pytest.approx(ball["reaction_force"].value, rel=5e-3), "the face is nearly level"
    assert thin().at_rest().scene_as(IndentationScene).contact is None


def test_small_displacements_of_a_ball_are_small_copies_of_each_other():
    """Force over displacement to the power of 3/2, as by Hertz. With a contact the stiffer the smaller the displacement, points
    around the rim open and close by turns, so that small displacements take many short steps, and some find no way."""
    ball = {"specimen": {"thickness": 4e-3}, "body": Sphere(radius=2e-3), "recess": None, "stop": "displacement", "steps": {}}
    ball |= {"mesh": MeshSettings(growth=1.0, refinement=0.5), "contact": Coulomb(friction=0.4)}
    stiffness = []
    for displacement in (1e-6, 1e-7):
        result = run(**ball, displacement=displacement)
        assert len(result.steps) == 1
        stiffness.append(result.quantities["reaction_force"].value / displacement**1.5)
    assert stiffness[0] == pytest.approx(stiffness[1], rel=1e-2)  # the radius of contact is a hundredth of the thickness


def test_a_threshold_says_what_a_fit_in_compression_leaves_open():
    def lines_of(**changes):
        setup = thin(specimen={"material": named_material("icf_stable").material, **changes.pop("specimen", {})}, **changes)
        return energy_assumptions(setup)

    (line,) = lines_of()
    assert "icf_stable is fitted in compression alone (stretch 0.6 to 1)" in line
    assert "1.21 to 2.39 times its threshold pressure" in line
    skin = (Layer(material=named_material("b1a_stable").material, thickness=0.5e-3),)
    assert [text.split()[0] for text in lines_of(specimen={"layers": skin})] == ["b1a_stable", "icf_stable"]
    assert energy_assumptions(thin()) == [], "a material of the user's own"
    assert lines_of(specimen={"material": named_material("icf_printed").material}) == []


def test_run_goes_past_the_touch_with_both_sensors_loaded(plain):
    beyond = run(stop="displacement", displacement=0.4e-3)
    last = beyond.steps[-1].values
    assert beyond.status == "converged"
    assert last["displacement"] == pytest.approx(0.4e-3)
    assert last["sensor_force"] > 0
    assert last["reaction_force"] + last["sensor_force"] == pytest.approx(last["base_force"], rel=1e-8)
    assert last["tissue_rise"] < 0.2e-3 + 4e-7, "the sensor holds the tissue back"
    contact = beyond.scene_as(IndentationScene).contact
    radius, force = np.array(contact.radius), np.array(contact.pressure) * np.array(contact.area)
    on_sensor = force[radius < thin().body.inner_radius].sum()
    assert on_sensor == pytest.approx(last["sensor_force"], rel=0.02), "nearly level there, and drawn with the annulus"
    assert beyond.quantities["threshold_force"].value == pytest.approx(plain.quantities["threshold_force"].value, rel=1e-9)


def test_stopped_before_the_threshold_is_a_failure():
    result = run(displacement=0.1e-3)
    assert result.status == "failed"
    assert "not reached" in result.reason
    assert "threshold_pressure" not in result.quantities


def test_convex_tissue_starts_with_a_rise_and_concave_with_none():
    curved = {"surface_radius": 12e-3}
    convex = run(specimen={"surface": "convex", **curved}, displacement=0.5e-3, steps={"first": 3e-6})
    sag = 12e-3 - np.sqrt(12e-3**2 - np.array([1.5e-3, 1.9e-3]) ** 2)
    assert sag[0] < convex.steps[0].values["tissue_rise_axis"] < sag[1], "the fillet meets the surface between the two radii"
    concave = run(specimen={"surface": "concave", **curved}, displacement=0.05e-3, stop="displacement")
    assert concave.steps[0].values["tissue_rise_axis"] < 0


def test_hard_skin_raises_the_threshold_and_slipping_base_lowers_it(plain):
    pressure = plain.quantities["threshold_pressure"].value
    skin = run(specimen={"layers": (Layer(thickness=0.5e-3, material=NeoHookean(c10=10e3)),)})
    assert skin.quantities["threshold_pressure"].value > 1.5 * pressure
    slipping = run(specimen={"base": "slipping"})
    assert slipping.quantities["threshold_pressure"].value != pytest.approx(pressure, rel=0.01)


def test_same_case_same_numbers(plain):
    again = run()
    for name, quantity in plain.quantities.items():
        assert again.quantities[name].value == pytest.approx(quantity.value, rel=1e-10), name


def test_refined_state_is_the_same_state():
    experiment = thin(contact=Coulomb(friction=0.0))
    model = experiment.model()
    *_, (last, _) = DisplacementPath(experiment, experiment.drive(), model).states(lambda model, split: None)
    state, marked = last.contact, np.arange(0, len(model.mesh.elements), 4)
    finer, same, _ = model.refined(state, marked)
    assert len(finer.mesh.elements) > len(model.mesh.elements)

    def on_the_base(model, unknowns):
        forces = model.body.residual(unknowns)[: model.space.displacement_size].reshape(-1, model.space.dim)
        return forces[model.base_nodes].sum(axis=0)[1]  # those along the radius have no resultant

    np.testing.assert_allclose(on_the_base(model, state.unknowns), model.base_force(state)[1], rtol=1e-12)
    np.testing.assert_allclose(on_the_base(finer, same.unknowns), model.base_force(state)[1], rtol=0.02)
    assert finer.highest(same.unknowns, 1.5e-3) == pytest.approx(model.highest(state.unknowns, 1.5e-3), abs=1e-15)
    solved = finer.equilibrium(same, same.load, same.unknowns)
    assert finer.base_force(solved)[1] == pytest.approx(model.base_force(state)[1], rel=0.02)


def test_interruption_keeps_what_was_accepted():
    def stop_at_three(step):
        if step.step == 3:
            raise KeyboardInterrupt

    result = thin().run(stop_at_three)
    assert result.status == "interrupted"
    assert len(result.steps) == 3
    assert result.frames


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"specimen": {"radius": 2.9e-3}}, "is too small for a body"),
        ({"displacement": 3e-3}, "displacement: 3 mm must be smaller than the specimen's thickness 3 mm"),
        ({"recess": None}, "needs the recess"),
        ({"recess": 3.1e-3, "displacement": 1e-3}, "recess: 3.1 mm must be smaller"),
        ({"body": Sphere(radius=2e-3)}, "only a body with a hole, such as an annulus, has one"),
        ({"mesh": MeshSettings(finest=1e-3)}, "too coarse"),
        ({"specimen": {"thickness": 1e4}}, "units wrong"),
        ({"specimen": {"surface": "convex", "surface_radius": 12e-3}, "recess": 0.05e-3}, "before it touches the annulus"),
    ],
)
def test_impossible_experiments_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        thin(**changes)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"layers": (Layer(thickness=3e-3, material=SOFT),)}, "leave nothing"),
        ({"surface": "convex"}, "surface_radius belongs"),
        ({"surface_radius": 1.0}, "surface_radius belongs"),
        ({"surface": "convex", "surface_radius": 6e-3}, "at least the specimen's radius"),
        ({"surface": "concave", "surface_radius": 7e-3, "radius": 7e-3}, "as deep as"),
    ],
)
def test_impossible_specimens_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        Specimen(**({"material": SOFT, "thickness": 3e-3, "radius": 7e-3} | changes))


def test_a_run_to_the_threshold_is_as_far_as_the_tissue_has_risen() -> None:
    """By the largest displacement that is tried, a run that was done showed 11 % and hours to go."""
    example = Indentation.example()
    assert example.stop == "threshold"
    assert example.extent == Extent("tissue_rise", example.recess)
    further = example.model_copy(update={"stop": "displacement"})
    assert further.extent == Extent("displacement", example.displacement)


@pytest.mark.parametrize("kind", [Indentation, TimedIndentation, Indentation3D])
def test_a_run_whose_element_collapsed_names_the_key_of_the_mesh(
    kind: type[Indentation | TimedIndentation | Indentation3D], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It said that the mesh is too coarse, and left its reader to look for the key."""

    def states(self: object, adapted: object) -> Iterator[None]:
        yield from ()
        raise Collapsed("no step leads on")

    for path in (DisplacementPath, HistoryPath):
        monkeypatch.setattr(path, "states", states)
    reasons = []
    for refinement in (1.0, 1.5):
        example = kind.example()
        finer = example.model_copy(update={"mesh": example.mesh.model_copy(update={"refinement": refinement})})
        reasons.append(finer.run(None).reason)
    stopped = "stopped converging: no step leads on; smaller elements may lead on: mesh.refinement:"
    assert reasons == [f"{stopped} 2", f"{stopped} 3"]
