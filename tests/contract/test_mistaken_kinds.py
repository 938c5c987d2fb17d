"""Kinds of an author of an extension that are wrong: each is refused where it is used, with its class and method named."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
from made_grasps import LAYOUT, NOISE, SIZE, plain_forces
from matplotlib.figure import Figure
from pydantic import TypeAdapter, ValidationError

from tactsim.array import Array
from tactsim.contact.checks import check_law, checked_normals
from tactsim.errors import InputError, InvalidQuantity
from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.experiments.annulus.figures.closed_form import ClosedFormFigures
from tactsim.interfaces import ContactLaw, Experiment, Inclusion, Material, RigidBody, SensorFilm
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.run import Course, Findings
from tactsim.interfaces.solid import Point
from tactsim.localization.checked_estimate import estimate_of
from tactsim.materials.any_material import AnyMaterial
from tactsim.materials.derivatives import check_derivatives
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.library import LIBRARY
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.any_inclusion import check_inclusions
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_misfit
from tactsim.mesh.inclusions.sphere import Ball
from tactsim.plotting.canvas import Plot
from tactsim.presentation import load_result
from tactsim.registry import forget, kind_class
from tactsim.results import Quantity, Result, Status
from tactsim.results.document import document_text
from tactsim.results.result import rows
from tactsim.sensors.films.any_film import AnyFilm
from tactsim.sensors.films.film import Film

POINTS = 1e-3 * np.array([[0.0, 1.0, 2.0], [-3.0, -2.0, -1.0]])


def made_law(base: type[Hyperelastic], **methods: Callable[..., Any]) -> Any:
    law: Any = type("Mine", (base,), {**methods, "__module__": __name__})  # no kind of its own: it is not registered
    return law


WRONG_LAWS = {
    "factor": ({"energy_gradient": lambda s, I1, I2: (2 * s.c10 + 0 * I1, 0 * I1)}, "its W1 is .* Pa, by differences"),
    "second": ({"energy_hessian": lambda s, I1, I2: (s.c10 + 0 * I1, 0 * I1, 0 * I1)}, "energy_hessian of Mine .* its W11 is"),
    "one array": ({"energy_gradient": lambda s, I1, I2: s.c10 + 0 * I1}, r"must return \(W1, W2\).*it returned a ndarray"),
    "two of three": ({"energy_hessian": lambda s, I1, I2: (0 * I1, 0 * I1)}, r"\(W11, W12, W22\).*it returned 2 of them"),
    "shape": ({"energy_gradient": lambda s, I1, I2: (np.ones(5), 0 * I1)}, r"theirs are \(5,\), \(3,\)"),
    "failure": (
        {"energy_gradient": lambda s, I1, I2: int("x")},
        "energy_gradient of Mine failed at stretches of .*invalid literal",
    ),
}


@pytest.mark.parametrize("mistake", WRONG_LAWS)
def test_a_law_whose_derivatives_are_wrong_is_refused(mistake: str) -> None:
    """A wrong second derivative was a solver that gave up, a wrong first one the forces of another material."""
    methods, words = WRONG_LAWS[mistake]
    with pytest.raises(InputError, match=words):
        made_law(NeoHookean, **methods)(c10=3e3)


OWN = {"kind": "own_law", "youngs_modulus": 1e4, "poisson_ratio": 0.4}
WRONG_OWN_LAWS = {
    "shape": (("first_piola_kirchhoff", lambda law, F, p: F[0]), r"must return an array of the shape \(3, 3, 3\) for F"),
    "nothing": (("tangent", lambda law, F, p: None), "it returned a NoneType"),
    "no number": (("first_piola_kirchhoff", lambda law, F, p: F * np.nan), "first_piola_kirchhoff of Own is not finite"),
    "factor": (
        ("volume_change", lambda law, F: F[0, 0] - 1),
        "volume_change_gradient of Own is not the derivative of its volume",
    ),
    "failure": (("tangent", lambda law, F, p: int("x")), "tangent of Own failed at strains of 5%: invalid literal"),
    "pressure": (
        ("first_piola_kirchhoff", lambda law, F, p: LinearElastic.first_piola_kirchhoff(law, F, 2 * p)),
        "must contain the pressure times its volume_change_gradient",
    ),
    "slope of the pressure": (
        ("tangent", lambda law, F, p: LinearElastic.tangent(law, F, p) + p),
        "tangent of Own is not the derivative of its first_piola_kirchhoff",
    ),
}


@pytest.mark.parametrize("mistake", WRONG_OWN_LAWS)
def test_a_law_whose_own_stress_and_tangent_do_not_fit_is_refused(mistake: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """One without numbers was said to shear a section out of its plane, one with a wrong tangent did not converge."""

    class Own(LinearElastic):  # without its compiled form
        kind: Literal["own_law"] = "own_law"  # type: ignore[assignment]
        compiled_form: ClassVar[Any] = None

    reader: TypeAdapter[Material] = TypeAdapter(AnyMaterial)
    assert reader.validate_python(OWN).shear_modulus > 0
    (method, wrong), words = WRONG_OWN_LAWS[mistake]
    monkeypatch.setattr(Own, method, wrong)
    with pytest.raises(ValidationError, match=words):
        reader.validate_python(OWN)


def test_a_law_of_its_own_stress_reads_a_bulk_modulus_with_its_unit() -> None:
    """It was refused, and the bare number taken that every other quantity refuses."""
    field: TypeAdapter[Any] = TypeAdapter(Material.model_fields["bulk_modulus"].annotation)
    assert field.validate_python("2 MPa") == 2e6
    with pytest.raises(ValidationError, match="no unit"):
        field.validate_python(2e6, context={"units": "required"})


def test_every_shipped_material_has_the_derivatives_of_its_energy() -> None:
    laws = [entry.material for entry in LIBRARY.values() if isinstance(entry.material, Hyperelastic)]
    assert len(laws) > 5
    for law in laws:
        check_derivatives(law)


def test_a_kind_that_lacks_a_method_says_which() -> None:
    """It was an unknown kind, in a list of all others."""

    class Unfinished(Hyperelastic):
        kind: Literal["unfinished_law"] = "unfinished_law"

        def energy(self, I1: Array, I2: Array) -> Array:
            return I1

    with pytest.raises(InputError, match=r"'unfinished_law': its class .*Unfinished lacks energy_gradient, energy_hessian"):
        kind_class(Material, "unfinished_law")


def test_a_kind_that_is_defined_again_without_a_method_is_not_the_earlier_one() -> None:
    """A cell of a notebook run again with a method renamed went on computing with the class of the cell before."""

    def cell(**methods: Any) -> Any:
        stated = {"kind": "defined_again", "__annotations__": {"kind": Literal["defined_again"]}}
        names = {"__module__": __name__, "__qualname__": "Again"}
        return type(ContactLaw)("Again", (ContactLaw,), stated | names | methods)  # type: ignore[call-overload]

    none = {
        "example": classmethod(lambda cls: cls()),
        "traction_limit": lambda s, p: 0 * p,
        "traction_limit_slope": lambda s, p: 0 * p,
    }
    whole = cell(**none)
    try:
        assert kind_class(ContactLaw, "defined_again") is whole
        cell(**{name: none[name] for name in ("example", "traction_limit")})
        with pytest.raises(InputError, match="contact law kind 'defined_again': its class Again lacks traction_limit_slope"):
            kind_class(ContactLaw, "defined_again")
        whole = cell(**none)
        assert kind_class(ContactLaw, "defined_again") is whole
    finally:
        forget(whole)


def test_a_film_that_does_not_state_its_signal_says_so() -> None:
    """The run ended with an AttributeError of one word."""

    methods = {name: vars(Film)[name] for name in SensorFilm.__abstractmethods__}
    stated = {"kind": "voiceless_film", "__annotations__": {"kind": Literal["voiceless_film"]}, "__module__": __name__}
    type(SensorFilm)("Voiceless", (SensorFilm,), stated | methods)  # type: ignore[call-overload]
    with pytest.raises(InputError, match=r"sensor film kind 'voiceless_film': its class Voiceless lacks signal, unit$"):
        kind_class(SensorFilm, "voiceless_film")


class Leaning(RigidBody):
    """Returns what a test gives it."""

    answer: Any = None

    def signed_distance(self, x: Array) -> Any:
        return self.answer(x)

    @classmethod
    def example(cls) -> Leaning:
        return cls(kind="leaning")


def upward(x: Array, sign: float = 1.0) -> tuple[Array, Array, Array]:
    normal = np.zeros_like(x)
    normal[-1] = sign
    return -x[-1], normal, np.zeros((len(x), *x.shape))


def test_a_body_of_other_shapes_or_with_its_normal_inwards_is_refused() -> None:
    good = Leaning(kind="leaning", answer=lambda x: upward(x, -1.0))
    checked_normals(good, POINTS)
    with pytest.raises(InvalidQuantity, match="signed_distance of Leaning does not grow along its normal"):
        checked_normals(Leaning(kind="leaning", answer=upward), POINTS)
    with pytest.raises(InvalidQuantity, match=r"of the shapes \(3,\), \(2, 3\) and \(2, 2, 3\) at points \(2, 3\); it returned"):
        checked_normals(Leaning(kind="leaning", answer=lambda x: (x[-1].sum(), np.zeros(3), 0.0)), POINTS)


class Odd(ContactLaw):
    """Returns what a test gives it."""

    limit: Any = None

    def traction_limit(self, pressure: Array) -> Any:
        return self.limit(pressure)

    def traction_limit_slope(self, pressure: Array) -> Array:
        return 0.3 + 0 * pressure

    @classmethod
    def example(cls) -> Odd:
        return cls(kind="odd")


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        (lambda p: "much", "must return numbers"),
        (lambda p: np.ones(7), "must return numbers"),
        (lambda p: -p, "negative"),
        (lambda p: np.nan * p, "no number"),
    ],
)
def test_a_law_of_contact_without_a_limit_is_refused(limit: Any, words: str) -> None:
    check_law(Odd(kind="odd", limit=lambda p: 0.3 * p))
    with pytest.raises(InvalidQuantity, match=f"traction_limit of Odd.*{words}"):
        check_law(Odd(kind="odd", limit=limit))


class Lone(Inclusion):
    """Its solid, not in a tuple."""

    center: Point = (20e-3, 20e-3, 10e-3)

    @classmethod
    def example(cls) -> Lone:
        return cls(kind="lone")

    def solids(self, size: Array) -> Any:
        return Ball(np.array(self.center), 4e-3)


class Nothing(Lone):
    """Has no solid at all."""

    def solids(self, size: Array) -> Any:
        return ()


@pytest.mark.parametrize(("cls", "words"), [(Lone, ".*Ball"), (Nothing, r"\(\)")])
def test_an_inclusion_whose_solids_are_no_tuple_is_refused(cls: type[Lone], words: str) -> None:
    """Graded cells, which a grasp tries first, ask for them before anything else does."""
    refusal = rf"solids\(\) of {cls.__name__} returned {words}"
    with pytest.raises(InvalidQuantity, match=refusal):
        check_inclusions(SIZE, [cls(kind="lone")], 0.5e-3)
    assert re.match(refusal, str(graded_misfit(SIZE, [cls(kind="lone")], [], BlockMeshSettings())))


class Shrunk(Lone):
    """A ball of a negative radius."""

    def solids(self, size: Array) -> Any:
        return (Ball(np.array(self.center), -4e-3),)


class Torn(Lone):
    """Fails by itself."""

    def solids(self, size: Array) -> Any:
        return int("x")


@pytest.mark.parametrize(
    ("cls", "words"),
    [
        (Shrunk, r"the semi-axes \[-0.004, -0.004, -0.004\] m; allowed: three positive lengths"),
        (Torn, "invalid literal"),
    ],
)
def test_an_inclusion_whose_solids_cannot_be_made_is_named(cls: type[Lone], words: str) -> None:
    """A negative radius was meshed as a positive one, and an error in solids() did not say whose it was."""
    with pytest.raises(InvalidQuantity, match=rf"solids\(\) of {cls.__name__} failed: {words}"):
        check_inclusions(SIZE, [cls(kind="lone")], 0.5e-3)


class Answer:
    """An estimator that gives what a test wants."""

    def __init__(self, answer: Any):
        self.answer = answer

    def estimate(self, readings: Readings) -> Any:
        return self.answer


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, "Answer returned a NoneType; needed: an Estimate"),
        (lambda: Estimate(True, (EstimatedInclusion("sphere", (20.0, 20.0, 10.0)),), "in mm"), "far from the block"),
        (lambda: Estimate(True, (EstimatedInclusion("sphere", (20e-3, 20e-3)),), "flat"), r"centre of the shape \(2,\)"),  # type: ignore[arg-type]
    ],
)
def test_an_estimate_in_mm_or_of_nothing_is_refused(answer: Any, words: str) -> None:
    forces = plain_forces(np.array([1e-3]))[0]
    with pytest.raises(InvalidQuantity, match=words):
        estimate_of(Answer(answer() if callable(answer) else answer), Readings(forces, LAYOUT, SIZE, noise=NOISE))


class Beginning(Experiment):
    """Begins as a test wants."""

    answer: Any = None

    def begin(self) -> Any:
        return self.answer()

    @classmethod
    def example(cls) -> Beginning:
        return cls(kind="beginning")


def test_what_begin_returns_and_what_was_found_are_named_if_they_cannot_be_used() -> None:
    def run(answer: Callable[[], Any]) -> Result:
        return Beginning(kind="beginning", answer=answer).run(None)

    with pytest.raises(InputError, match=r"begin\(\) of Beginning returned a NoneType; needed: a Course"):
        run(lambda: None)
    with pytest.raises(InvalidQuantity, match="a is a float; needed: Quantity"):
        run(lambda: Course.computed(Findings("", quantities={"a": 1.0})))  # type: ignore[dict-item]
    with pytest.raises(InvalidQuantity, match=r"of force, time has columns of the lengths \[3, 4\]"):
        rows({"force": "N", "time": "s"}, (np.arange(3.0), np.arange(4.0)))


def found(**findings: Any) -> Result:
    return Beginning(kind="beginning", answer=lambda: Course.computed(Findings("", **findings))).run(None)


def test_a_text_among_the_findings_is_one_and_what_is_no_text_is_refused() -> None:
    """It was split into its letters, each a warning of its own."""
    result = found(assumptions="dry contact", warnings="beyond the tests")
    assert (result.assumptions, result.warnings) == (("dry contact",), ("beyond the tests",))
    assert Result("made_up", Status.CONVERGED, "", warnings="beyond").warnings == ("beyond",)  # type: ignore[arg-type]
    with pytest.raises(InvalidQuantity, match="assumptions of Beginning: None; needed: a tuple of texts"):
        found(assumptions=None)
    with pytest.raises(InvalidQuantity, match=r"warnings of a result of made_up: \(1\.0,\); needed"):
        Result("made_up", Status.CONVERGED, "", warnings=(1.0,))  # type: ignore[arg-type]


@pytest.mark.parametrize("method", ["assumptions", "warnings"])
def test_a_film_that_says_a_text_where_a_tuple_belongs_is_refused(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its letters were as many assumptions of the result."""
    reader: TypeAdapter[SensorFilm] = TypeAdapter(AnyFilm)
    reader.validate_python(Film.example())
    monkeypatch.setattr(Film, method, lambda *_: "thin")
    with pytest.raises(ValidationError, match=rf"{method}\(\) of Film returned 'thin'; needed: a tuple of texts"):
        reader.validate_python(Film.example())


@pytest.mark.parametrize("value", [np.nan, np.inf, [[1.0, np.nan]], np.array([np.inf]), np.float32("nan")])
def test_a_run_that_found_what_is_not_finite_did_not_converge(value: Any) -> None:
    """It was said to have converged."""
    good = Quantity(1.0, "N", "")
    result = found(quantities={"force": Quantity(value, "N", ""), "other": good})
    assert result.status is Status.FAILED
    assert result.reason == "not finite: force; needed: numbers, or None where there is none"
    assert result["other"].value == 1.0
    assert found(quantities={"force": Quantity([None, 1.0], "N", ""), "other": good}).status is Status.CONVERGED


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, r"drawings\(\) of ClosedFormFigures returned None; needed: file name -> Drawing"),
        (Figure(), r"drawings\(\) of ClosedFormFigures returned <Figure.*; needed: file name -> Drawing"),
        ({"a.png": Figure()}, r"drawings\(\) of ClosedFormFigures returned \{'a.png': <Figure.*; needed: file name -> Drawing"),
        ({"a.png": Plot(lambda: None)}, "what draws (a|this figure) returned a NoneType; needed: a figure of matplotlib"),  # type: ignore[arg-type,return-value]
    ],
)
def test_figures_that_are_none_are_named_and_cost_no_result(
    answer: Any, words: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Saving ended with a bare TypeError or AttributeError, and nothing was written."""
    result = ClosedForm.example().run(None)
    monkeypatch.setattr(ClosedFormFigures, "drawings", lambda self, result: answer)
    with pytest.raises(InvalidQuantity, match=words):
        result.plot()
    with pytest.warns(UserWarning, match=words):
        place = result.save(tmp_path / "kept")
    kept = load_result(place)
    assert kept.quantities == result.quantities
    assert re.search(words, kept.warnings[-1])


def test_a_result_that_could_not_be_read_again_is_not_written() -> None:
    """A unit that nobody knows, and lists of different lengths, were written and then refused as damage."""
    with pytest.raises(InvalidQuantity, match="length has the unknown unit 'furlongs'"):
        Result("made_up", Status.CONVERGED, "", {"length": Quantity(1.0, "furlongs", "")})
    with pytest.raises(InvalidQuantity, match="history has the unknown unit"):
        Result("made_up", Status.CONVERGED, "", units={"history": "furlongs"})
    for value in ([[1.0, 2.0], [3.0]], "text"):
        result = Result("made_up", Status.CONVERGED, "", {"odd": Quantity(value, "m", "")})
        with pytest.raises(InvalidQuantity, match=r"not written, for it could not be read again: quantities.odd.value"):
            document_text(result, "abc")
