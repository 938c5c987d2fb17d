"""One more kind of every extension point, defined here and named nowhere else: used, distinguished from others, and forgotten."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent
from types import ModuleType
from typing import Any, Literal

import numpy as np
import pytest
from made_grasps import LAYOUT, SIZE, plain_forces

from tactsim import interfaces, registry
from tactsim.case.json_schema import case_json_schema
from tactsim.case.loading import load_case
from tactsim.dataset.sampling.layout import layout_of
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.errors import AmbiguousKind, CaseError, StorageError, UnknownName
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.model import grasp_mesh
from tactsim.experiments.grasp.recorder import inclusion_kinds
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.scene import IndentationScene
from tactsim.experiments.localization.confusion import class_of
from tactsim.experiments.localization.source import computed_grasp
from tactsim.experiments.recording import RecordingSettings, recorder_for
from tactsim.experiments.threshold.contact_curve import ContactCurve, SensorShape
from tactsim.interfaces import (
    CaseKind,
    ContactLaw,
    Estimator,
    Experiment,
    Inclusion,
    Material,
    Recorder,
    ResultFigures,
    RigidBody,
    Scene,
    SensorFilm,
)
from tactsim.interfaces.readings import Readings
from tactsim.live.session.choices import offered_choices
from tactsim.localization.estimators.any_estimator import offered_estimators
from tactsim.plotting import figures_for
from tactsim.presentation import load_result
from tactsim.registry import forget, kind_class, kinds
from tactsim.results.result import Status
from tactsim.shipped import CASES

POINTS = (Material, RigidBody, ContactLaw, Inclusion, SensorFilm, Experiment, Estimator, Recorder, ResultFigures, Scene)
MODULES = {
    Scene: """
        from typing import Literal
        from tactsim.results.scene import Scene
        class Added(Scene):
            kind: Literal["added"] = "added"
            colour: str
    """,
    Material: """
        from typing import Literal
        from tactsim.materials.neo_hookean import NeoHookean
        class Added(NeoHookean):
            kind: Literal["added"] = "added"
    """,
    RigidBody: """
        from typing import Literal
        from tactsim.contact.plane import Plane
        class Added(Plane):
            kind: Literal["added"] = "added"
    """,
    ContactLaw: """
        from typing import Literal
        from tactsim.contact.coulomb import Coulomb
        class Added(Coulomb):
            kind: Literal["added"] = "added"
    """,
    Inclusion: """
        from typing import ClassVar, Literal
        from tactsim.mesh.inclusions.sphere import Sphere
        class Added(Sphere):
            data_set_number: ClassVar[int | None] = None
            kind: Literal["added"] = "added"
    """,
    SensorFilm: """
        from typing import Literal
        from tactsim.sensors.films.capacitive_film import CapacitiveFilm
        class Added(CapacitiveFilm):
            kind: Literal["added"] = "added"
    """,
    Experiment: """
        from typing import Literal
        from tactsim.experiments.film.film_test import FilmTest
        class Added(FilmTest):
            kind: Literal["added"] = "added"
    """,
    Estimator: """
        from typing import Literal
        from tactsim.interfaces import Estimator
        from tactsim.interfaces.estimate import Estimate
        class Added(Estimator):
            kind: Literal["added"] = "added"
            @classmethod
            def example(cls):
                return cls()
            def estimate(self, readings):
                return Estimate(False, (), "it never finds anything")
    """,
    Recorder: """
        from typing import ClassVar, Literal
        from tactsim.interfaces import Recorder
        class Added(Recorder):
            kind: Literal["added"] = "added"
            quantities: ClassVar = {"line_slope": ("S/N", "slope of the line")}
            def describe(self):
                return "added"
    """,
    ResultFigures: """
        from typing import Literal
        from matplotlib.figure import Figure
        from tactsim.interfaces import ResultFigures
        from tactsim.plotting.canvas import Plot
        class Added(ResultFigures):
            kind: Literal["added"] = "added"
            def drawings(self, result):
                return {"added.png": Plot(Figure)}
    """,
}


RING = """
    from typing import Literal
    import numpy as np
    from tactsim.contact.profile import Revolved, rounded_box
    from tactsim.interfaces.contact_shape import ContactShape
    class Added(Revolved):
        kind: Literal["added"] = "added"
        @classmethod
        def example(cls):
            return cls()
        @property
        def contact_shape(self):
            return ContactShape(3e-3, 1.5e-3, 0.4e-3)
        def profile_distance(self, p):
            return rounded_box(p, np.array([1.5e-3, 0.0]), np.array([3e-3, 20e-3]), 0.4e-3)
"""
"""A body with a hole and with none of the fields of an annulus."""


@pytest.fixture
def added(tmp_path: Path) -> Iterator[Any]:
    """Defines the modules of extension points; what they register is forgotten in the end."""
    defined: list[type[CaseKind]] = []

    def define(base: Any, name: str = "added_kind", text: str | None = None) -> Any:
        module = ModuleType(name)
        exec(compile(dedent(text or MODULES[base]), f"{name}.py", "exec", dont_inherit=True), module.__dict__)  # noqa: S102  a user's module
        defined.append(module.Added)  # type: ignore[attr-defined]
        return defined[-1]

    yield define
    for cls in defined:
        forget(cls)


def case(tmp_path: Path, experiment: str, changes: dict[str, str]) -> Any:
    """A case of one experiment in flow style, loaded."""
    text = f"schema: tactsim/case/1\ntitle: added\nexperiment: {experiment}\n"
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "case.yaml"
    path.write_text(text, encoding="utf-8")
    return load_case(path).experiment


GRASP = """
  kind: grasp
  block: {size: [40 mm, 40 mm, 20 mm], tissue: MATERIAL}
  inclusions: [{shape: {kind: SHAPE, center: [20 mm, 20 mm, 10 mm], radius: 5 mm}, material: lump}]
  contact: {kind: LAW, friction: 0.5}
  loading: {control: displacement, pieces: [{kind: ramp, to: 1 mm, duration: 1 s}]}
"""
PRESS = """
  kind: indentation
  specimen: {material: icf_stable, radius: 10 mm, thickness: 5 mm}
  body: {kind: BODY}
  stop: displacement
  displacement: 0.2 mm
"""
TIMED = """
  kind: timed_indentation
  specimen: {material: {kind: neo_hookean, c10: 3 kPa}, radius: 10 mm, thickness: 5 mm}
  body: {kind: BODY}
  loading: {control: displacement, pieces: [{kind: ramp, to: 0.2 mm, duration: 1 s}]}
  compare: half_space
"""
SMALL_GRASP = """
  kind: grasp
  block: {size: [20 mm, 20 mm, 10 mm], tissue: MATERIAL}
  contact: {kind: LAW, friction: 0.5}
  matrix: {rows: 2, columns: 2, pitch: 8 mm, size: 7 mm}
  loading: {control: displacement, pieces: [{kind: ramp, to: 0.3 mm, duration: 1 s}]}
  mesh: {kind: structured, cells: [2, 2, 2]}
"""
LOCALIZATION = "{kind: localization, grasp: LUMP, reference: PLAIN, noise: 1 mN, estimator: {kind: NAMED}}"
STORED = CASES / "stored"
FILM = "{kind: film_test, film: {kind: NAMED}, forces: [1 N, 2 N, 3 N], times: [1 s]}"


def test_a_material_is_named_in_a_case(added: Any, tmp_path: Path) -> None:
    changes = {"MATERIAL": "{kind: added, c10: 3 kPa}", "SHAPE": "sphere", "LAW": "coulomb"}
    with pytest.raises(CaseError, match="added"):
        case(tmp_path, GRASP, changes)
    cls = added(Material)
    assert type(case(tmp_path, GRASP, changes).block.tissue) is cls
    own, shipped = (
        case(tmp_path, SMALL_GRASP, {"MATERIAL": f"{{kind: {kind}, c10: 3 kPa}}", "LAW": "coulomb"}).run(None)
        for kind in ("added", "neo_hookean")
    )
    assert own.status is Status.CONVERGED
    assert own.quantities == shipped.quantities


def test_a_contact_law_is_named_in_a_case(added: Any, tmp_path: Path) -> None:
    cls = added(ContactLaw)
    assert type(case(tmp_path, GRASP, {"MATERIAL": "icf_stable", "SHAPE": "sphere", "LAW": "added"}).contact) is cls
    own, shipped, slippery = (
        case(tmp_path, SMALL_GRASP, {"MATERIAL": "icf_stable", "LAW": law, "0.5}": friction}).run(None)
        for law, friction in (("added", "0.5}"), ("coulomb", "0.5}"), ("added", "0.1}"))
    )
    assert own.status is Status.CONVERGED
    assert own.quantities == shipped.quantities
    assert own.quantities != slippery.quantities, "friction is felt"


def test_a_body_is_pressed_and_tilted_without_a_radius(added: Any, tmp_path: Path) -> None:
    cls = added(RigidBody)
    experiment = case(tmp_path, PRESS, {"BODY": "added"})
    assert type(experiment.body) is cls
    assert experiment.contact_radius == experiment.specimen.radius  # it has none: it reaches as far as the specimen
    text = PRESS + "  mesh: {finest: 2 mm, growth: 1, adaptive: false}\n"
    own, shipped = (case(tmp_path, text, {"BODY": body}).run(None) for body in ("added", "plane"))
    assert own.status is Status.CONVERGED
    assert own.quantities == shipped.quantities
    tilted = kind_class(RigidBody, "tilted").model_validate({"kind": "tilted", "body": {"kind": "added"}, "tilt_x": 0.1})
    assert type(tilted.body) is cls


def test_a_body_with_a_hole_has_a_recess_and_a_threshold(added: Any, tmp_path: Path) -> None:
    added(RigidBody, text=RING)
    mesh = "mesh: {finest: 0.3 mm, growth: 1, adaptive: false}"
    text = PRESS.replace("displacement: 0.2 mm", "displacement: 2 mm")
    text = text.replace("stop: displacement", f"recess: 0.2 mm\n  {mesh}")
    ring, annulus = (case(tmp_path, text, {"BODY": body}).run(None) for body in ("added", "annulus, fillet: 0.4 mm"))
    assert ring.status is Status.CONVERGED
    assert ring.quantities == annulus.quantities
    assert ring.steps == annulus.steps
    assert {"threshold_pressure", "tissue_rise"} <= set(ring.quantities)
    assert ContactCurve.of_result(ring, beyond=1e-4).shape == SensorShape(1.5e-3, 3e-3, 0.2e-3)
    beside = case(tmp_path, TIMED, {"BODY": "added"})
    assert (beside.compare, beside.contact_radius) == ("half_space", 3e-3)
    for other in ("rod", "plane"):
        with pytest.raises(CaseError, match=f"a closed form exists for a flat ring or disc, not for a {other}"):
            case(tmp_path, TIMED, {"BODY": other})


def test_an_inclusion_is_meshed_and_labelled(added: Any, tmp_path: Path) -> None:
    cls = added(Inclusion)
    grasp = case(tmp_path, GRASP, {"MATERIAL": "icf_stable", "SHAPE": "added", "LAW": "coulomb"})
    assert type(grasp.inclusions[0].shape) is cls
    assert inclusion_kinds()[:5] == ("none", "sphere", "ellipsoid", "tube", "surface")
    labels = recorder_for("grasp", RecordingSettings(), 1).labels(grasp)
    assert labels["inclusion_kind"].tolist() == [5]
    assert labels["inclusion_radius"][0] == pytest.approx(5e-3, rel=1e-12)
    np.testing.assert_allclose(labels["inclusion_center"][0], grasp.inclusions[0].shape.center, rtol=1e-12)
    meshed = case(
        tmp_path, GRASP.rstrip() + "\n  mesh: {kind: graded}\n", {"MATERIAL": "icf_stable", "SHAPE": "added", "LAW": "coulomb"}
    )
    assert (grasp_mesh(meshed).block.mesh.regions == 1).any()
    np.testing.assert_allclose(grasp.inclusions[0].shape.places(np.array(SIZE))[0], [20e-3, 20e-3, 10e-3], rtol=1e-12)


def test_a_hollow_inclusion_counts_as_an_artery_and_any_other_as_a_lump(added: Any) -> None:
    groups = (["added"], ["added", "tube"], ["added", "sphere"])
    assert added(Inclusion).hollow is False
    assert [class_of(shapes) for shapes in groups] == ["lump", None, "two_lumps"]
    forget(kind_class(Inclusion, "added"))
    added(Inclusion, text=MODULES[Inclusion].replace("sphere", "tube").replace("Sphere", "Tube"))
    assert [class_of(shapes) for shapes in groups] == ["artery", "two_arteries", None]


def test_a_film_is_tested_by_a_case(added: Any, tmp_path: Path) -> None:
    cls = added(SensorFilm)
    experiment = case(tmp_path, FILM, {"NAMED": "added"})
    assert type(experiment.film) is cls
    assert "reading_capacitance" in experiment.run(lambda step: None).quantities


def test_an_experiment_is_asked_for_by_a_case_and_described(added: Any, tmp_path: Path) -> None:
    cls = added(Experiment)
    experiment = case(tmp_path, FILM, {"film_test": "added", "NAMED": "film"})
    assert type(experiment) is cls
    assert "Added" in case_json_schema()["$defs"]


def test_an_estimator_is_offered_on_the_page_and_in_the_ranking(added: Any) -> None:
    assert "added" not in offered_estimators()
    added(Estimator)
    assert "added" in offered_estimators()
    choice = {one.name: one for one in offered_choices()}["added"]
    assert (choice.label, choice.needs_reference) == ("added", False)
    assert not choice.estimator.estimate(Readings(plain_forces(np.array([1e-3]))[0], LAYOUT, SIZE)).present


def test_an_estimator_is_named_in_a_case(added: Any, tmp_path: Path) -> None:
    grasps = {"LUMP": str(STORED / "grasp_lump"), "PLAIN": str(STORED / "grasp_plain")}
    with pytest.raises(CaseError, match="added"):
        case(tmp_path, LOCALIZATION, grasps | {"NAMED": "added"})
    cls = added(Estimator)
    experiment = case(tmp_path, LOCALIZATION, grasps | {"NAMED": "added"})
    assert type(experiment.estimator) is cls
    own = experiment.run(None)
    shipped = case(tmp_path, LOCALIZATION, grasps | {"NAMED": "thesis, background: reference"}).run(None)
    assert own.status is shipped.status is Status.CONVERGED
    assert [bool(one.quantities["present"].value) for one in (own, shipped)] == [False, True]


def test_a_recorder_and_figures_are_found_by_the_kind_of_the_experiment(added: Any, tmp_path: Path) -> None:
    for base in (Experiment, Recorder, ResultFigures):
        added(base)
    path = tmp_path / "sweep.yaml"
    film = FILM.replace("film_test", "added").replace("NAMED", "film").replace("3 N]", "{uniform: [3 N, 4 N]}]")
    path.write_text(f"schema: tactsim/sweep/1\ntitle: added\nexperiment: {film}\nsweep: {{samples: 2}}\n", encoding="utf-8")
    layout = layout_of(load_sweep(path))
    assert layout.recorder.describe() == "added"
    assert "line_slope" in {variable.name for variable in layout.variables}
    result = kinds(Experiment)["added"].example().run(lambda step: None)
    assert list(figures_for(result)) == ["added.png"]
    assert figures_for(result)["added.png"]("svg").startswith(b"<?xml")
    assert list(result.plot()) == ["added"]  # type: ignore[arg-type]
    assert (result.save(tmp_path / "kept") / "figures" / "added.png").exists()


def test_a_result_with_a_body_of_a_kind_that_is_not_loaded_says_so(added: Any, tmp_path: Path) -> None:
    added(RigidBody)
    text = PRESS + "  mesh: {finest: 2 mm, growth: 1, adaptive: false}\n"
    folder = case(tmp_path, text, {"BODY": "added"}).run(None).save(tmp_path / "kept")
    forget(kind_class(RigidBody, "added"))
    result = load_result(folder)
    with pytest.raises(StorageError, match="the kind 'added' is not known here; import the module that defines it first"):
        result.scene_as(IndentationScene)


def test_a_result_of_an_experiment_that_extends_another_is_the_same_when_it_is_loaded(tmp_path: Path) -> None:
    class Deeper(Indentation):
        kind: Literal["deeper"] = "deeper"

    try:
        text = (PRESS + "  mesh: {finest: 0.7 mm, growth: 1, adaptive: false}\n").replace("kind: indentation", "kind: deeper")
        result = case(tmp_path, text, {"BODY": "punch"}).run(None)
        again = load_result(result.save(tmp_path / "kept"))
        assert result.kind == "deeper"
        assert again.scene_as(IndentationScene) == result.scene_as(IndentationScene)
        assert again == result
    finally:
        forget(Deeper)


def test_a_result_of_an_experiment_that_extends_another_is_read_where_that_of_the_other_is(tmp_path: Path) -> None:
    class Firmer(Grasp):
        kind: Literal["firmer"] = "firmer"

    class Deeper(Indentation):
        kind: Literal["deeper"] = "deeper"

    try:
        grasp = SMALL_GRASP.replace("kind: grasp", "kind: firmer")
        firmer = case(tmp_path, grasp, {"MATERIAL": "icf_stable", "LAW": "coulomb"})
        folder = firmer.run(None).save(tmp_path / "firmer")
        assert case(tmp_path, f"{{kind: matrix_readout, grasp: {folder}}}", {}).run(None).status is Status.CONVERGED
        assert type(computed_grasp(str(folder))) is Firmer
        mesh = "mesh: {finest: 0.4 mm, growth: 1, adaptive: false}"
        text = PRESS.replace("stop: displacement", f"recess: 0.1 mm\n  {mesh}").replace(
            "displacement: 0.2 mm", "displacement: 2 mm"
        )
        pressed = case(tmp_path, text.replace("kind: indentation", "kind: deeper"), {"BODY": "annulus, fillet: 0.4 mm"}).run(None)
        assert ContactCurve.of_result(pressed, beyond=1e-4).shape == SensorShape(1.5e-3, 3e-3, 0.1e-3)
    finally:
        for cls in (Firmer, Deeper):
            forget(cls)


def test_all_points_stand_on_one_page() -> None:
    """And each is tried here: a kind of it is added and removed."""
    for base in POINTS:
        kinds(base)
    page = {base.__name__ for base in registry._registered if getattr(interfaces, base.__name__, None) is base}
    assert {base.__name__ for base in registry._registered} == page == {base.__name__ for base in POINTS}


@pytest.mark.parametrize("base", POINTS, ids=lambda base: base.__name__)
def test_a_kind_is_known_until_it_is_forgotten(base: Any, added: Any) -> None:
    known = set(kinds(base))
    cls = added(base)
    assert set(kinds(base)) == known | {"added"}
    assert kind_class(base, "added") is cls
    forget(cls)
    assert set(kinds(base)) == known
    with pytest.raises(UnknownName, match="added"):
        kind_class(base, "added")


@pytest.mark.parametrize("base", POINTS, ids=lambda base: base.__name__)
def test_two_classes_of_one_kind_are_an_error_that_names_both(base: Any, added: Any) -> None:
    added(base, "one_place")
    with pytest.raises(AmbiguousKind, match=r"one_place\.Added and another_place\.Added"):
        added(base, "another_place")


def test_a_kind_that_is_defined_after_a_refusal_is_explained_too(added: Any, tmp_path: Path) -> None:
    """The choices of an earlier refusal were taken, and a wrong key was asked whether it meant itself."""
    wrong = {"{kind: neo_hookean, c10: 3 kPa}": "{kind: added, c11: 3 kPa}", "BODY": "plane"}
    with pytest.raises(CaseError, match="unknown material kind 'added'"):
        case(tmp_path, TIMED, wrong)
    added(Material)
    allowed = "kind, bulk_modulus, relaxation, c10"
    with pytest.raises(CaseError, match=rf"c11: unknown key \(did you mean 'c10'\?\); allowed: {allowed}$"):
        case(tmp_path, TIMED, wrong)
