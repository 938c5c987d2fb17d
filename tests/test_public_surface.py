"""What ``import tactsim`` offers: names, cases, results and data sets from Python."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pint
import pytest
from sweeps import Inline

import tactsim as ts
from tactsim.case.writing import case_text
from tactsim.contact.jaw import Jaw
from tactsim.dataset import TorchSamples, sample_case
from tactsim.dataset.figures import card as dataset_card
from tactsim.dataset.running import resuming
from tactsim.dataset.running.executors import LocalWorkers
from tactsim.errors import CaseError, InvalidQuantity, StorageError, UnknownName
from tactsim.experiments.grasp.scene import ReadGrasp
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting import canvas
from tactsim.results import FieldFrame
from tactsim.sensors.films.film import Film
from tactsim.shipped import shipped_cases

# fmt: off
NAMES = [
    "Annulus", "Block", "BoundaryValueProblem", "Case", "ClosedForm", "Coulomb", "Ellipsoid", "Embedded", "Estimator",
    "Experiment", "Grasp", "Inclusion", "Indentation", "InputError", "Material", "MooneyRivlin3", "NeoHookean",
    "Quantity", "Relaxation", "Result", "RigidBody", "SensorFilm", "Specimen", "Sphere", "TactsimError",
    "TaxelLayout", "TimedIndentation", "Tube", "choice", "close", "fit_relaxation", "fit_uniaxial", "kinds",
    "load_case", "load_data", "load_result", "log_uniform", "material", "normal", "read_uniaxial_curve", "save_case",
    "sweep", "uniform",
]
# fmt: on
HEAVY = ("numpy", "scipy", "pydantic", "pint", "numba", "skfem", "matplotlib", "xarray", "pyvista", "zarr", "ruamel", "meshio")


@pytest.fixture(scope="module")
def case() -> ts.Case:
    return ts.load_case("annulus_dynamic_load", {"experiment.points": 20})


@pytest.fixture(scope="module")
def result(case: ts.Case) -> ts.Result:
    return case.run()


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sweeps compute here and draw nothing: a worker takes seconds to begin, and one test has a real one and the figures."""
    monkeypatch.setattr(LocalWorkers, "of", lambda sweep, workers: Inline(sweep))
    monkeypatch.setattr(dataset_card, "card_figures", lambda store: {})


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The figures that are saved beside a result are empty files."""
    monkeypatch.setattr(canvas, "encoded", lambda figure, form: b"")


@pytest.fixture(scope="module")
def annuli(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set of two samples that no test changes."""
    place = tmp_path_factory.mktemp("data") / "annuli.zarr"
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(LocalWorkers, "of", lambda sweep, workers: Inline(sweep))
        patched.setattr(dataset_card, "card_figures", lambda store: {})
        ts.sweep(VARIED, samples=2, out=place, workers=1, splits={"train": 1.0, "validation": 0.0})
    return place


@pytest.fixture
def grasp() -> ts.Grasp:
    return ts.Grasp(
        block=ts.Block(size=("40 mm", "40 mm", "20 mm"), tissue="icf_stable"),
        inclusions=[ts.Embedded(ts.Sphere(center=("20 mm", "20 mm", "12 mm"), radius="4 mm"), material="lump")],
        loading=ts.close(to="1 mm", duration="1 s"),
    )


def test_the_names_are_these_and_each_is_documented() -> None:
    assert sorted(NAMES, key=str) == sorted(ts.__all__)
    assert set(dir(ts)) == {*NAMES, "__version__"}
    assert [name for name in ts.__all__ if not getattr(ts, name).__doc__] == []
    with pytest.raises(AttributeError, match="no attribute 'grasp'"):
        _ = ts.grasp  # type: ignore[attr-defined]


def test_nothing_heavy_is_loaded_before_it_is_used() -> None:
    code = f"import sys, tactsim; dir(tactsim); sys.exit(' '.join(set({HEAVY!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr.strip() == ""


def test_a_case_file_loads_its_own_kind_only() -> None:
    code = (
        "import sys; from tactsim import load_case; load_case('annulus_icf'); from tactsim.interfaces import Experiment;"
        "from tactsim.registry import _registered;"
        "assert {*_registered[Experiment]} == {'indentation'}, _registered[Experiment];"
        "sys.exit(' '.join({'numba', 'skfem', 'matplotlib', 'scipy.optimize', 'xarray', 'pyvista'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr.strip() == ""


def test_a_quantity_is_one_type_for_numbers_and_arrays(result: ts.Result) -> None:
    deepest = result["largest_displacement"]
    assert deepest.to("mm").value == pytest.approx(1e3 * deepest.value, rel=1e-15)
    assert (deepest.unit, deepest.to("mm").unit, deepest.array.dims) == ("m", "mm", ())
    assert float(deepest) == deepest.value == float(deepest.array)
    assert f"{deepest.to('mm'):.2f}".endswith(" mm")
    with pytest.raises(InvalidQuantity, match="'kPa' is not a unit of what is in 'm'"):
        deepest.to("kPa")
    with pytest.raises(UnknownName, match="did you mean 'largest_displacement'"):
        _ = result["largest_displacment"]
    taxels = ts.Quantity([[1.0, 2.0]], "N", "forces")
    assert taxels.to("mN").value == [[1000.0, 2000.0]]
    assert f"{taxels.to('mN'):.1f}" == "[[1000.0, 2000.0]] mN"
    assert f"{ts.Quantity([1.25, None], '1', 'a hole'):.1f}" == "[1.2, nan]"
    readings = ts.Result(kind="grasp", status=result.status, reason="", quantities={"taxel_force_upper": taxels})
    assert readings["taxel_force_upper"].array.dims == ("row", "column")
    assert readings["taxel_force_upper"].array.attrs["units"] == "N"


def test_operators_and_elementwise_functions_of_quantities_give_the_units_that_follow() -> None:
    forces, closing = ts.Quantity([0.2, 0.4], "N", "forces"), ts.Quantity(2.0, "mm", "closing")
    registry = pint.get_application_registry()
    for computed, numbers, unit in (
        (forces / closing, [100.0, 200.0], "N/m"),
        (np.array([1, 2]) * forces, [0.2, 0.8], "N"),
        (3 * closing - 1 * registry.mm, 5e-3, "m"),
        (np.sqrt(closing * closing), 2e-3, "m"),
        (-abs(-forces), [-0.2, -0.4], "N"),
        (2 * ts.Quantity(0.25, "1", "share"), 0.5, ""),
    ):
        assert computed.m_as(unit) == pytest.approx(np.array(numbers), rel=1e-15)
    assert (forces > 0.3 * registry.N).tolist() == [False, True]
    assert (float(np.sum(forces)), np.max(forces), np.stack([forces, forces]).shape) == (pytest.approx(0.6), 0.4, (2, 2))
    with pytest.raises(pint.DimensionalityError):
        _ = forces + closing


@pytest.mark.parametrize(
    ("name", "shape", "words", "axes"),
    [
        ("jaw_force_upper", (3,), "force (x, y, z) of the tissue", ("component",)),
        ("taxel_shear_upper", (4, 5, 2), "force (x, y) along the face; [row][column], row 1", ("row", "column", "component")),
        ("taxel_force_upper_history", (2, 4, 5), "forces", ("time", "row", "column")),
        ("rise", (2, 3, 4), "rise of the tissue [ratio, force, time]", ("ratio", "force", "time")),
        ("confusion", (2, 2), "estimates by [true class][estimated class]: none", ("true_class", "estimated_class")),
        ("noise", (3,), "of each sensor", ("dim_0",)),
    ],
)
def test_axes_of_an_array_have_the_names_that_its_description_gives(
    name: str, shape, words: str, axes, result: ts.Result
) -> None:
    quantities = {name: ts.Quantity(np.zeros(shape).tolist(), "1", words)}
    array = ts.Result(kind="grasp", status=result.status, reason="", quantities=quantities)[name].array
    assert array.dims == axes


def test_taxels_lie_in_their_places_and_steps_at_their_times(result: ts.Result) -> None:
    """Taxels 10 mm apart; the upper jaw stands 2 mm beside the middle of the block along x, the lower one 1 mm along y."""
    scene = ReadGrasp(
        block_size=(0.04, 0.04, 0.02),
        inclusions=(),
        jaws={side: Jaw(width=0.05, depth=0.05) for side in JAWS},
        jaw_places={"upper": (0.022, 0.02, 0.02), "lower": (0.02, 0.021, 0.0)},
        matrix=ts.TaxelLayout(rows=2, columns=3, pitch="10 mm", size="9 mm"),
    )
    quantities = {
        "taxel_force_upper": ts.Quantity(np.zeros((2, 3)).tolist(), "N", "forces [row][column]"),
        "taxel_shear_lower": ts.Quantity(np.zeros((2, 3, 2)).tolist(), "N", "force (x, y), [row][column]"),
        "taxel_force_lower_history": ts.Quantity(np.zeros((2, 2, 3)).tolist(), "N", "forces [time][row][column]"),
        "taxel_force_upper_odd": ts.Quantity(np.zeros((4, 3)).tolist(), "N", "of another matrix [row][column]"),
        "time_history": ts.Quantity([0.5, 1.0], "s", "time, at each accepted step [time]"),
        "displacement_history": ts.Quantity([5e-4, 1e-3], "m", "closing of each jaw, at each accepted step [time]"),
    }
    readings = ts.Result(kind="matrix_readout", status=result.status, reason="", quantities=quantities, scene=scene)
    upper = readings["taxel_force_upper"].to("mN").array
    np.testing.assert_allclose(upper["column"], [0.012, 0.022, 0.032], rtol=1e-12)
    np.testing.assert_allclose(upper["row"], [0.015, 0.025], rtol=1e-12)
    assert upper["row"].attrs["units"] == "m"
    shear = readings["taxel_shear_lower"].array
    np.testing.assert_allclose(shear["row"], [0.016, 0.026], rtol=1e-12)
    assert list(shear["component"].values) == ["x", "y"]
    over_time = readings["taxel_force_lower_history"].array
    assert over_time.sel(time=1.0).dims == ("row", "column")
    assert over_time["displacement"].dims == ("time",)
    np.testing.assert_array_equal(over_time["displacement"], [5e-4, 1e-3])
    assert "row" not in readings["taxel_force_upper_odd"].array.coords  # never places of another number of taxels


def test_a_result_goes_through_its_names(result: ts.Result) -> None:
    assert list(result) == list(result.quantities)
    assert {name: result[name] for name in result} == result.quantities


def test_the_history_is_a_dataset_with_units(result: ts.Result) -> None:
    history = result.history
    assert history["force"].attrs["units"] == "N"
    np.testing.assert_array_equal(history["force"], [step.values["force"] for step in result.steps])
    assert history.sizes == {"step": len(result.steps)}


@pytest.mark.usefixtures("undrawn")
def test_a_saved_result_is_the_same_to_the_last_bit(result: ts.Result, tmp_path: Path) -> None:
    again = ts.load_result(result.save(tmp_path / "first"))
    assert again == result
    assert again.provenance == result.provenance
    assert again.scene == result.scene
    changed = result.quantities | {"force": ts.Quantity(np.nextafter(result["force"].value, 1), "N", result["force"].description)}
    assert ts.Result(**{**vars(result), "quantities": changed}) != result
    with pytest.raises(StorageError, match=r"first exists; use --force \(in Python: force=True\) to replace it"):
        result.save(tmp_path / "first")
    assert again.save(tmp_path / "first", force=True).is_dir()


@pytest.mark.usefixtures("undrawn", "reader_here")
def test_a_result_is_saved_without_its_fields_if_they_are_not_wanted(result: ts.Result, tmp_path: Path) -> None:
    points, cells = np.zeros((3, 3)), {"triangle": np.array([[0, 1, 2]])}
    frame = FieldFrame(0.0, points, cells, {"displacement [m]": points})
    whole = replace(result, frames=(frame,))
    assert len(ts.load_result(whole.save(tmp_path / "whole")).frames) == 1
    without = ts.load_result(whole.save(tmp_path / "without", fields=False))
    assert without.frames == ()
    assert without == result


def test_an_experiment_without_a_file_is_kept_too(tmp_path: Path) -> None:
    result = ts.ClosedForm.example().run()
    again = ts.load_result(result.save(tmp_path / "second"))
    assert again == result
    assert again.provenance["case"]["experiment"]["kind"] == "closed_form"


def test_a_notebook_begins_with_the_threshold_and_unfolds_what_is_beyond_twelve(result: ts.Result) -> None:
    """The threshold pressure was the thirteenth of an annulus, and of a grasp no taxel was listed."""
    forces = ts.Quantity([[0.2, 0.3], [0.1, 0.4]], "N", "force on each taxel")
    fillers = {f"filler_{k}": ts.Quantity(1.0, "m", "filler") for k in range(12)}
    threshold = ts.Quantity(45e3, "Pa", "force over area")
    html = replace(result, quantities={"taxel_force": forces, **fillers, "threshold_pressure": threshold})._repr_html_()
    shown, hidden = html.split("<details>")
    assert shown.index("threshold_pressure") < shown.index("45 kPa") < shown.index("taxel_force")
    assert "2 x 2 values, 100 mN to 400 mN" in shown
    assert ("2 more" in hidden, "filler_10" in shown, "filler_11" in hidden) == (True, False, True)


def test_a_notebook_shows_a_case_as_its_file():
    case = ts.load_case("annulus_icf", {"experiment.recess": "0.4 mm"})
    shown = case._repr_html_()
    assert shown == f"<pre>{case_text(case)}</pre>"
    assert "recess: 400 µm" in shown
    assert "kind: indentation" in case.experiment._repr_html_()
    assert "&lt;b&gt;" in case.model_copy(update={"title": "<b>bold</b>"})._repr_html_()


def test_a_result_shows_itself(result: ts.Result) -> None:
    (name, figure), *_ = result.plot().items()
    assert (name, figure.get_size_inches()[0] > 3) == ("closed_form", True)
    html = result._repr_html_()
    assert "converged" in html
    assert "largest_displacement" in html
    assert html.count("data:image/png;base64,") == 1
    assert result.plot()._repr_html_().count("data:image/png;base64,") == len(result.plot())  # at the end of a cell of a notebook
    assert result.plot("closed_form")._repr_png_().startswith(b"\x89PNG")
    assert repr(result).startswith("<Result of closed_form: converged")
    assert result.plot("closed_form").get_size_inches()[0] > 3
    with pytest.raises(UnknownName, match=r"unknown figure 'closed_from' \(did you mean 'closed_form'\?\); known: closed_form"):
        result.plot("closed_from")
    with pytest.raises(ts.InputError, match="holds no fields"):
        result.fields()


@pytest.mark.parametrize("path", [p for p in shipped_cases() if "schema: tactsim/case/" in p.read_text()], ids=lambda p: p.stem)
def test_a_written_case_is_the_same_case(path: Path, tmp_path: Path) -> None:
    case = ts.load_case(path)
    text = case_text(case)
    written = tmp_path / path.name
    written.write_text(text, encoding="utf-8")
    for folder in ("data", "surfaces"):
        if (path.parent / folder).is_dir():
            (tmp_path / folder).symlink_to(path.parent / folder)
    assert ts.load_case(written).case_id == case.case_id


def test_a_case_built_in_python_is_saved_and_read_as_the_same(grasp: ts.Grasp, tmp_path: Path) -> None:
    place = ts.save_case(grasp, tmp_path / "my_grasp.yaml")
    again = ts.load_case(place)
    assert again.experiment == grasp
    assert "radius: 4 mm" in place.read_text()
    assert "material: lump" in place.read_text()
    with pytest.raises(StorageError, match="exists"):
        ts.save_case(grasp, place)


def test_a_saved_design_keeps_what_was_given_though_it_is_the_default_and_every_bit(tmp_path: Path) -> None:
    default = ts.Annulus().outer_radius
    fitted = ts.MooneyRivlin3(c10=7838.8393223224548, c01=1234.5678901234567, c11=-2000.1234567890123)
    specimen = {"material": fitted, "thickness": "10 mm"}
    options = {"specimen": specimen, "recess": "0.8 mm", "displacement": 0.7 * 1e-3}
    design = ts.Indentation(body=ts.Annulus(outer_radius=default), **options)
    text = ts.save_case(design, tmp_path / "design.yaml").read_text()
    assert "outer_radius: 3 mm" in text
    assert "inner_radius" not in text, "nobody gave it"
    assert "      c10: 7.838839322322455 kPa\n      c01: 1.2345678901234567 kPa\n" in text
    again = ts.load_case(tmp_path / "design.yaml")
    assert (again.experiment.specimen.material, again.experiment.displacement) == (fitted, 0.7 * 1e-3)
    unwritten = ts.save_case(ts.Indentation(**options), tmp_path / "unwritten.yaml")
    assert ts.load_case(unwritten).case_id == again.case_id, "a default that is written out is the same case"


def test_lengths_may_be_text_pint_or_si() -> None:
    units = pint.UnitRegistry()
    assert ts.Sphere((20 * units.mm, "2 cm", 0.02), 4e3 * units.um) == ts.Sphere((0.02, 0.02, 0.02), 4e-3)
    case = ts.load_case("annulus_icf", {"experiment.recess": 0.4 * units.mm})
    assert case.experiment.recess == 0.4e-3
    assert ts.Sphere([20, 20, 20] * units.mm, np.float32(0.5)) == ts.Sphere(np.full(3, 0.02), np.array(0.5))
    assert ts.close(np.int64(1), 2 * units.s) == ts.close(1, 2)


def test_a_quantity_of_a_result_is_a_value_of_a_case(result: ts.Result) -> None:
    force = result["largest_force"].to("mN")
    read = ts.kinds("body")["annulus"](inner_radius=ts.Quantity(1.5, "mm", "of a drawing"), outer_radius="3 mm")
    assert read.inner_radius == 1.5e-3
    with pytest.raises(ts.InputError, match=f"^Annulus: inner_radius: '{force.value} mN' has the wrong dimension"):
        ts.Annulus(inner_radius=force)
    with pytest.raises(ts.InputError, match=r"^Annulus: inner_radius: '3' has no unit; expected a length"):
        ts.Annulus(inner_radius=3 * pint.UnitRegistry().dimensionless)


@pytest.mark.usefixtures("in_this_process")
def test_parts_that_are_built_in_python_stand_in_overrides_mappings_and_variations(tmp_path: Path) -> None:
    rubber, ball = ts.NeoHookean(c10="3 kPa"), ts.Sphere((0.02, 0.02, 0.01), "3 mm")
    case = ts.load_case("annulus_icf", {"experiment.specimen.material": rubber})
    assert case.experiment.specimen.material == rubber
    inclusions = [ts.Embedded(ball, "lump")]
    assert ts.load_case("grasp_plain", {"experiment.inclusions": inclusions}).experiment.inclusions == tuple(inclusions)
    press = ts.ClosedForm.example()
    assert ts.load_case({"schema": "tactsim/case/1", "experiment": press}).experiment == press
    varied = press.vary({"material": rubber, "outer_radius": ts.uniform(2e-3, np.float64(4e-3)), "thickness": 0.01, "points": 5})
    data = ts.sweep(varied, samples=8, out=tmp_path / "annuli.zarr", workers=1, splits={"train": 0.5, "validation": 0.5})
    assert ((data["outer_radius"] >= 2e-3) & (data["outer_radius"] <= 4e-3)).all()
    weighted = press.vary({"outer_radius": ts.choice(2e-3, 4e-3, weights=(1, 0))})
    data = ts.sweep(weighted, samples=8, out=tmp_path / "two.zarr", workers=1, splits={"train": 0.5, "validation": 0.5})
    assert (data["outer_radius"] == 2e-3).all()
    pressed = ts.ClosedForm(material=rubber, loading=ts.close("0.1 mm", "1 s"), points=5).vary(
        {"loading.pieces.0.to": ts.uniform(1e-4, 2e-4)}
    )
    data = ts.sweep(pressed, samples=8, out=tmp_path / "pressed.zarr", workers=1, splits={"train": 0.5, "validation": 0.5})
    assert data["varied_loading_pieces_0_to"].attrs["units"] == "m", "not N, as under force control"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ts.Block(size=("40", "40 mm", "20 mm"), tissue="icf_stable"), r"Block: size.0: '40' has no unit"),
        (
            lambda: ts.Block(tissue="icf_stabel"),
            r"Block: tissue: unknown material set 'icf_stabel' \(did you mean 'icf_stable'\?\)",
        ),
        (lambda: ts.Sphere((0, 0, 0), radius="4 mm", colour=1), r"Sphere: colour: unknown key; allowed: kind, center, radius"),
        (lambda: ts.Specimen(material="lump", thickness="2 furlong"), r"'furlong', which is not a unit that is read"),
        (lambda: ts.Indentation(specimen=ts.Specimen(material="lump"), body={"kind": "anulus"}, displacement=1e-3), "'annulus'"),
        (
            lambda: ts.load_case("annulus_icf", {"experiment.recess": "4 kPa"}),
            r"^override experiment.recess: '4 kPa' has the wrong dim",
        ),
        (
            lambda: ts.load_case("grasp_plain", {"experiment.loading.pieces": [{"kind": "ramp", "duration": "1 s"}]}),
            r"^override experiment.loading.pieces: experiment.loading.pieces.0.to: missing; expected .* such as '1.5 mm'$",
        ),
        (lambda: ts.close(to="1 s", duration="1 s"), r"^close: to: '1 s' has the wrong dimension; expected a length"),
        (lambda: ts.close("1 mm", 0), r"^close: duration: 0 is out of range; must be greater than 0 s$"),
        (lambda: ts.close("1 mm", "1 s", hold="x"), r"^close: hold: 'x' is not a quantity; expected a time with its unit"),
        (lambda: ts.load_case("annulus_ifc"), r"unknown case 'annulus_ifc' \(did you mean 'annulus_icf'\?\)"),
    ],
)
def test_what_is_wrong_is_refused_in_the_words_of_a_file(make, words: str) -> None:
    with pytest.raises((CaseError, UnknownName), match=words):
        make()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: ts.fit_relaxation([1, 2, 3]),
            r"\[1, 2, 3\] is not a curve; expected the path of a CSV file, or a RelaxationCurve",
        ),
        (lambda: ts.fit_uniaxial([1, 2], "stable"), r"\[1, 2\] is not a curve; expected what read_uniaxial_curve returns"),
        (lambda: ts.choice([]), r"choice: \[\] is one option; give the options one by one"),
        (lambda: ts.choice(), "choice: no option is given"),
        (lambda: ts.choice("2 mm", "4 mm", weights=(1,)), "choice: weights"),
        (lambda: ts.normal("2 mm", "-1 mm"), "normal: .*the latter must be positive"),
        (lambda: ts.normal("2 mm", "1 mm", low="1 mm"), "give both bounds or neither"),
        (lambda: ts.uniform("2 mm", "6 kg"), r"^uniform: '6 kg' has the wrong dimension; expected a length"),
        (lambda: ts.uniform("4 mm", "2 mm"), "uniform: .* must increase"),
        (lambda: ts.log_uniform(0, 1), "log_uniform: .* must be positive"),
        (
            lambda: ts.sweep(ts.ClosedForm.example(), out="x.zarr"),
            r"^sweep: ClosedForm\(.* does not vary; expected experiment.vary",
        ),
        (lambda: ts.save_case(ts.NeoHookean.example(), "x.yaml"), r"^save_case: NeoHookean\(.* is neither a case nor an exp"),
    ],
)
def test_arguments_of_functions_are_refused_at_once(make, words: str) -> None:
    with pytest.raises(ts.InputError, match=words):
        make()


def test_a_variation_shows_what_varies_and_not_the_whole_experiment(grasp: ts.Grasp) -> None:
    varied = grasp.vary({"block.tissue.c10": ts.uniform("2 kPa", "6 kPa")})
    assert repr(varied) == "<Variation of grasp: block.tissue.c10={'uniform': ['2 kPa', '6 kPa']}>"


def test_a_place_that_an_experiment_lacks_cannot_vary(grasp: ts.Grasp) -> None:
    radius = ts.uniform("2 mm", "6 mm")
    shape = ts.choice(ts.Sphere((0.02, 0.02, 0.01), "4 mm"), ts.Ellipsoid.example())
    drawn = dict.fromkeys(("inclusions.0.shape.radius", "loading.pieces.0.to", "upper.width"), radius)
    for place, one in (drawn | {"block.tissue.c10": ts.uniform("2 kPa", "6 kPa"), "readout.seed": {"integer": [1, 9]}}).items():
        assert grasp.vary({place: one}).places == {place: one}
    assert grasp.vary({"inclusions.0.shape": shape, "inclusions.0.shape.semi_axes.0": radius})
    for place, words in {
        "inclusions.0.shape.raduis": r"^vary: inclusions.0.shape: unknown key 'raduis' \(did you mean 'radius'\?\); allowed:",
        "inclusions.1.shape.radius": "^vary: inclusions: a list without an entry '1'; entries: 0$",
        "inclusions[0].shape.radius": r"^vary: unknown key 'inclusions\[0\]' \(did you mean 'inclusions.0'\?\)",
        "blok.tissue": r"^vary: unknown key 'blok' \(did you mean 'block'",
        "block.size.0.x": r"^vary: block.size.0: 0.04 has no entry 'x'$",
    }.items():
        with pytest.raises(CaseError, match=words):
            grasp.vary({place: radius})


@pytest.mark.parametrize(
    ("place", "drawn"),
    [
        ("inclusions.0.shape.radius", ts.uniform("3 kg", "4 kg")),
        ("inclusions.0.shape.center.2", ts.choice("3 kPa")),
        ("upper.width", ts.normal("3 N", "1 N")),
        ("loading.pieces.0.to", ts.log_uniform("3 s", "4 s")),
        ("block.size.0", {"range": ["3 V", "4 V", 3]}),
    ],
)
def test_a_quantity_of_another_dimension_cannot_vary_there(grasp: ts.Grasp, place: str, drawn: dict[str, Any]) -> None:
    """It was taken until the sweep was run."""
    case = ts.load_case("grasp_lump_icf")
    for vary, key in ((grasp.vary, place), (case.vary, f"experiment.{place}")):
        with pytest.raises(CaseError, match=rf"^vary: {place}: '3 .*' has the wrong dimension; expected a length with its unit"):
            vary({key: drawn})
    assert grasp.vary({place: ts.uniform(3e-3, 4e-3)}), "numbers are in SI"
    assert grasp.vary({place: ts.uniform("3 mm", "4 mm")})


def test_more_values_than_fields_are_refused() -> None:
    with pytest.raises(TypeError, match="at most 2 values by position, 3 were given"):
        ts.Sphere((0, 0, 0), "4 mm", 3)
    with pytest.raises(TypeError, match="center is given by position and by name"):
        ts.Sphere((0, 0, 0), center=(1, 1, 1), radius="4 mm")


@pytest.mark.parametrize(
    ("values", "meant"),
    [
        ((36e3,), "c10=36000.0 in Pa or c10='36 kPa'"),
        (("36 kPa",), "c10='36 kPa'"),
        ((36, 2), "c10=36 in Pa or c10='36 Pa'"),
    ],
)
def test_the_first_value_of_a_material_is_not_taken_for_its_bulk_modulus(values: tuple[Any, ...], meant: str) -> None:
    """``NeoHookean(36e3)`` said that c10 is missing, and with ``c10`` beside it took it for the bulk modulus."""
    for named in ({}, {"c10": "1 kPa"}):
        with pytest.raises(TypeError, match=rf"^NeoHookean takes values by name, .*; did you mean {re.escape(meant)}\?$"):
            ts.NeoHookean(*values, **named)


def test_a_needed_field_that_stands_first_may_go_by_position() -> None:
    soft, loading = ts.NeoHookean(c10="1 kPa"), ts.ClosedForm.example().loading
    assert ts.ClosedForm(soft, loading=loading).material == soft


def test_a_changed_copy_is_refused_as_the_value_is_where_it_is_made() -> None:
    press = ts.ClosedForm.example()
    assert press.model_copy(update={"outer_radius": "4 mm"}).outer_radius == 4e-3
    for wrong, words in {
        ("outer_radus", "4 mm"): "outer_radus: unknown key .did you mean 'outer_radius'",
        ("outer_radius", "4 kPa"): "outer_radius: '4 kPa' has the wrong dimension",
        ("outer_radius", -1.0): "outer_radius",
    }.items():
        with pytest.raises(ts.InputError, match=words):
            press.model_copy(update=dict([wrong]))
    with pytest.raises(ts.InputError, match=r"cannot be changed; .*model_copy"):
        press.outer_radius = 4e-3  # type: ignore[misc]
    grasp = ts.Grasp.example()
    copied = grasp.model_copy(update={"contact": {"kind": "coulomb", "friction": 0.3}})
    assert copied.model_fields_set == grasp.model_fields_set | {"contact"}, "what was not given stays a default"


def test_a_set_has_no_order() -> None:
    with pytest.raises(ts.InputError, match=r"size: .*has no order; expected a list"):
        ts.Block(size={"40 mm", "41 mm", "20 mm"}, tissue="icf_stable")


def test_a_case_is_not_written_over_a_folder(tmp_path: Path) -> None:
    for wrong, words in {tmp_path: "is a folder; name the file", None: "save_case: needed: a path"}.items():
        with pytest.raises(ts.TactsimError, match=words):
            ts.save_case(ts.ClosedForm.example(), wrong, force=True)  # type: ignore[arg-type]


def test_kinds_are_listed_by_the_name_of_their_point() -> None:
    assert ts.kinds("experiment")["grasp"] is ts.Grasp
    assert "annulus" in ts.kinds("body")
    with pytest.raises(UnknownName, match="known: body, contact"):
        ts.kinds("bodies")
    assert ts.kinds()["contact"] == ts.kinds("contact")


def test_a_variation_becomes_a_data_set(tmp_path: Path) -> None:
    varied = ts.ClosedForm.example().vary({"outer_radius": ts.uniform("2 mm", "4 mm"), "points": 5})
    with pytest.warns(UserWarning, match="no sample that is done; take more samples"):  # of four, each split has none or one
        data = ts.sweep(varied, samples=4, out=tmp_path / "annuli.zarr", workers=1, title="Annuli")
    assert data.sizes["sample"] == 4
    with pytest.raises(StorageError, match=r"go on with it by --resume \(in Python: resume=True\), or choose another folder"):
        ts.sweep(varied, samples=4, out=tmp_path / "annuli.zarr", workers=1, title="Annuli")
    radii = data["varied_outer_radius"].values
    assert ((radii > 2e-3) & (radii < 4e-3)).all()
    assert len(set(radii)) == 4
    with pytest.raises(ts.InputError, match="outer_radus"):
        ts.sweep(ts.ClosedForm.example().vary({"outer_radus": ts.uniform("2 mm", "4 mm")}), samples=2, out=tmp_path / "b.zarr")
    with pytest.raises(ts.InputError, match="uniform"):
        ts.sweep(
            ts.ClosedForm.example().vary({"outer_radius": {"uniform": ["4 mm", "2 mm"]}}), samples=2, out=tmp_path / "c.zarr"
        )
    assert not (tmp_path / "b.zarr").exists()


@pytest.mark.usefixtures("in_this_process")
def test_an_interrupted_sweep_says_what_is_kept_and_how_to_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a word on splits that are empty because samples are left; a shorter continuation is refused with a remedy."""
    varied = ts.ClosedForm.example().vary({"outer_radius": ts.uniform("2 mm", "4 mm"), "points": 5})
    how = {"out": tmp_path / "annuli.zarr", "workers": 1, "splits": {"train": 0.5, "validation": 0.5}}
    with monkeypatch.context() as patched:
        patched.setattr(LocalWorkers, "of", lambda sweep, workers: Inline(sweep, stop_after=1))
        with pytest.raises(KeyboardInterrupt, match=r"^\d+ of 12 samples are kept in .*annuli\.zarr; go on with resume=True$"):
            ts.sweep(varied, samples=12, **how)
    assert 0 < ts.load_data(how["out"]).sizes["sample"] < 12
    with pytest.raises(StorageError, match="has 12 samples, 8 would lose some; ask for at least as many, or choose another"):
        ts.sweep(varied, samples=8, resume=True, **how)
    assert ts.sweep(varied, samples=12, resume=True, **how).sizes["sample"] == 12


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("during", ["closing the workers", "drawing"])
def test_a_second_interruption_of_a_sweep_says_how_to_go_on_too(
    during: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It ends the sweep at once, wherever that was, and the samples that were done are there."""
    varied = ts.ClosedForm.example().vary({"outer_radius": ts.uniform("2 mm", "4 mm"), "points": 5})
    how = {"samples": 12, "out": tmp_path / "annuli.zarr", "workers": 1, "splits": {"train": 0.5, "validation": 0.5}}

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(LocalWorkers, "of", lambda sweep, workers: Inline(sweep, stop_after=1))
        if during == "drawing":
            patched.setattr("tactsim.dataset.figures.card.card_figures", interrupt)
        else:
            closings = iter([interrupt])
            patched.setattr(Inline, "close", lambda self: next(closings, list)())
        with pytest.raises(KeyboardInterrupt, match=r"^the samples .* kept in .*\.zarr; go on with resume=True$") as stopped:
            ts.sweep(varied, **how)
    assert stopped.value.__suppress_context__, "a notebook shows one traceback, not those of both interruptions"
    assert ts.sweep(varied, resume=True, **how).sizes["sample"] == 12


@pytest.mark.usefixtures("in_this_process")
def test_a_sweep_goes_on_with_changed_code_if_that_is_accepted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    varied = ts.ClosedForm.example().vary({"outer_radius": ts.uniform("2 mm", "4 mm"), "points": 5})
    how = {"samples": 2, "out": tmp_path / "annuli.zarr", "workers": 1, "splits": {"train": 1.0, "validation": 0.0}}
    ts.sweep(varied, **how)
    monkeypatch.setattr(resuming, "code_identity", lambda: "another")
    with pytest.raises(StorageError, match=r"\(in Python: accept_changed_code=True\), or begin anew"):
        ts.sweep(varied, resume=True, **how)
    assert ts.sweep(varied, resume=True, accept_changed_code=True, **how).sizes["sample"] == 2


@pytest.mark.parametrize(
    ("package", "extra", "job"),
    [
        ("zarr", "data", lambda place: ts.load_data(place)),
        ("torch", "torch", lambda place: TorchSamples(place, inputs=["largest_force"])[0]),
        ("pymoo", "identification", lambda place: ts.load_case("dma_atrial").run()),
    ],
)
def test_a_missing_extra_is_named_with_what_installs_it(
    package: str, extra: str, job: Any, annuli: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a program as in the shell, also where the job imports it late."""
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ts.InputError, match=rf"{package}, needed for .*: pip install 'tactsim\[{extra}\]'$"):
        job(annuli)


def test_a_sweep_refuses_what_its_workers_cannot_load_before_it_makes_a_store(tmp_path: Path) -> None:
    class OwnTissue(ts.NeoHookean):
        kind: Literal["own_tissue"] = "own_tissue"

    class OwnFilm(Film):
        kind: Literal["own_film"] = "own_film"

    class OwnForm(ts.ClosedForm):
        kind: Literal["own_form"] = "own_form"

    place = {"outer_radius": ts.uniform("2 mm", "4 mm"), "points": 5}
    experiment = ts.ClosedForm.example()
    settings: dict[str, Any] = {"samples": 2, "out": tmp_path / "own.zarr", "workers": 1}
    with pytest.raises(ts.InputError, match="OwnForm is defined in this session"):
        ts.sweep(OwnForm.example().vary(place), **settings)
    with pytest.raises(ts.InputError, match="OwnTissue is defined in this session"):
        ts.sweep(experiment.model_copy(update={"material": OwnTissue(c10=2e3)}).vary(place), **settings)
    with pytest.raises(ts.InputError, match="OwnFilm is defined in this session"):
        ts.sweep(experiment.vary(place), reading={"film": {"kind": "own_film"}}, **settings)
    assert not (tmp_path / "own.zarr").exists()


def test_the_signature_of_every_kind_reads_without_machinery() -> None:
    classes = [cls for point in ts.kinds().values() for cls in point.values()]
    assert len(classes) > 40
    for cls in classes:
        text = str(inspect.signature(cls))
        assert " at 0x" not in text, cls.__name__
        assert "Annotated" not in text, cls.__name__
    assert str(inspect.signature(ts.Sphere)) == "(*, center: tuple[float, float, float], radius: float)"


VARIED = ts.ClosedForm.example().vary({"outer_radius": ts.uniform("2 mm", "4 mm"), "points": 5})


@pytest.mark.parametrize(
    ("call", "needed"),
    [
        (lambda result: ts.load_case(3), "a case: needed: a path or a text, not 3"),
        (lambda result: ts.load_result(None), "the folder of a result: needed: a path or a text, not None"),
        (lambda result: result.save(None), "the folder of a result: needed: a path or a text, not None"),
        (lambda result: result.plot(3), "unknown figure '3'"),
        (lambda result: result["largest_force"].to(3), "needed: a unit as text, such as 'N', not 3"),
        (lambda result: ts.load_data(None), "the folder of a data set: needed: a path or a text, not None"),
        (lambda result: ts.sweep(VARIED, samples=2, out=None), "sweep: out: needed: a path or a text, not None"),
        (lambda result: sample_case(None, 0), "the folder of a data set: needed: a path or a text, not None"),
        (lambda result: ts.choice("2 mm", "3 mm", weights=1), "choice: weights: 1 must be a list of 2"),
        (lambda result: result.experiment.vary(None), "vary: None is not a mapping from key paths to distributions; expected"),
        (lambda result: result.experiment.vary([("outer_radius", ts.uniform(1, 2))]), "is not a mapping from key paths"),
        (lambda result: result.experiment.vary({3: ts.uniform(1, 2)}), "vary: 3 is not a key path, which is a text"),
        (lambda result: ts.load_case("annulus_icf").vary(None), "vary: None is not a mapping"),
        (lambda result: ts.load_case("annulus_icf").vary({"recess": 1}), "(did you mean 'experiment.recess'?)"),
        (
            lambda result: ts.load_case("annulus_icf").vary({"title": 1}),
            "vary: 'title' is not within the experiment;",
        ),
    ],
    ids=[
        *("load_case", "load_result", "save", "plot", "to", "load_data", "sweep_out", "sample_case", "weights", "no_places"),
        *("pairs", "number_as_place", "case_without_places", "place_without_section", "title"),
    ],
)
def test_a_value_of_another_type_is_refused_in_words(call: Any, needed: str) -> None:
    with pytest.raises(ts.InputError, match=re.escape(needed)):
        call(ts.ClosedForm.example().run())


@pytest.mark.usefixtures("in_this_process")
def test_a_case_varies_at_the_key_paths_of_its_file(tmp_path: Path) -> None:
    case = ts.load_case("annulus_dynamic_load", {"title": "Presses", "output.fields": "none", "experiment.points": 5})
    varied = case.vary({"experiment.outer_radius": ts.uniform("2 mm", "4 mm")})
    data = ts.sweep(varied, samples=3, out=tmp_path / "presses.zarr", workers=1, splits={"train": 1.0, "validation": 0.0})
    assert data.attrs["title"] == "Presses"
    again = sample_case(tmp_path / "presses.zarr", np.int64(2))
    assert (again.title, again.output.fields) == ("Presses", "none")
    assert again.experiment.outer_radius == data["varied_outer_radius"].values[2]
    with pytest.raises(ts.InputError, match=r"vary: unknown key 'outer_radios'.*did you mean 'outer_radius'"):
        case.vary({"experiment.outer_radios": ts.uniform("2 mm", "4 mm")})
    for wrong in ("0", None, 1.5, True):
        with pytest.raises(ts.InputError, match="is not the number of a sample; the data set has samples 0 to 2"):
            sample_case(tmp_path / "presses.zarr", wrong)
