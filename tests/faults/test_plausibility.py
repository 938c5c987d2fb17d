"""Numbers that look like a wrong unit are reported, those that nobody can mean are refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from tactsim.cli import main
from tactsim.errors import InvalidQuantity
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.warnings import unlikely
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.materials.library import named_material
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.materials.polynomial import Polynomial
from tactsim.mechanics.outcome.plausibility import oddities
from tactsim.shipped import CASES
from tactsim.units import parse_quantity


@pytest.mark.parametrize(
    ("coefficients", "words"),
    [
        ({"c10": 1e-9}, ["shear modulus of 2 nPa", "1 Pa to 1 GPa"]),
        ({"c10": 2e9}, ["shear modulus of 4 GPa"]),
        ({"c10": 500.0, "bulk_modulus": 50.0}, ["0.05 times its shear modulus of 1 kPa", "Poisson's ratio is -0.804"]),
        ({"c10": 500.0, "bulk_modulus": 5e9}, ["5e+06 times its shear modulus", "take bulk_modulus: null"]),
    ],
)
def test_an_unusual_material_is_reported_with_both_values(coefficients, words):
    (warning,) = oddities({"tissue": NeoHookean(**coefficients)})
    assert warning.startswith("tissue has ")
    assert all(word in warning for word in words)


@pytest.mark.parametrize(
    ("constants", "words"),
    [
        ("equilibrium", "shear modulus of 4e+12 Pa at once, by its fractions"),
        ("instantaneous", "shear modulus of 4 \u00b5Pa in the end"),
    ],
)
def test_fractions_that_leave_next_to_nothing_are_reported(constants, words):
    memory = {"fractions": (0.5, 0.5 - 1e-9), "times": (0.1, 1.0), "constants": constants}
    (warning,) = oddities({"tissue": NeoHookean(c10=2e3, relaxation=memory)})
    assert words in warning
    assert oddities({"tissue": NeoHookean(c10=2e3, relaxation=memory | {"fractions": (0.5, 0.4)})}) == []


@pytest.mark.parametrize(
    "material", [MooneyRivlin2(c10=1000.0, c01=-300.0), Polynomial(coefficients={"c10": 1000.0, "c01": -300.0})]
)
def test_a_negative_second_coefficient_is_reported_where_it_loses_stability(material):
    (warning,) = oddities({"tissue": material})
    assert "c01 = -300 Pa beside c10 = 1 kPa" in warning
    assert "stable only while all principal stretches stay within 0." in warning
    assert oddities({"tissue": MooneyRivlin2(c10=1000.0, c01=300.0)}) == []


def test_stiffness_and_sizes_far_apart_are_reported():
    (warning,) = oddities({"fat": NeoHookean(c10=500.0), "steel": NeoHookean(c10=1e8)})
    assert warning.startswith("steel with a shear modulus of 200 MPa is 2e+05 times as stiff as fat with 1 kPa")
    assert any("thickness of 400 mm is 4e+03 times radius of 100 µm" in warning for warning in far_apart())


def far_apart():
    return oddities({}, tissue={"thickness": 0.4}, bodies={"radius": 1e-4})


@pytest.mark.parametrize("thickness", [4.0])
def test_a_layer_of_metres_is_reported(thickness):
    case = Indentation.example()
    wide = case.specimen.model_copy(update={"thickness": thickness})
    warnings = case.model_copy(update={"specimen": wide}).doubts()
    assert "specimen.thickness is 4 m; usual for tissue: 20 µm to 500 mm: is its unit right?" in warnings


def test_a_grasp_in_micrometres_is_reported():
    given = Grasp.example().model_dump()
    given["block"]["size"] = [40e-6, 40e-6, 15e-6]
    given["matrix"] |= {"pitch": 10e-6, "size": 9e-6}
    given["upper"] = given["lower"] = {"fillet": 1e-6}
    given["loading"]["pieces"][0]["to"] = 1e-6
    warnings = unlikely(Grasp.model_validate(given))
    assert any(warning.startswith("block.size along z is 15 µm") for warning in warnings)
    assert any(warning.startswith("matrix.size is 9 µm") for warning in warnings)


def test_the_result_of_a_run_reports_them():
    soft = {"kind": "neo_hookean", "c10": 1e-9}
    case = Grasp.example().model_dump()
    case["block"]["tissue"], case["mesh"]["cells"] = soft, (2, 2, 2)
    result = Grasp.model_validate(case).run()
    assert any("block.tissue has a shear modulus of 2 nPa" in warning for warning in result.warnings)


@pytest.mark.parametrize("kind", [Indentation, Grasp])
def test_nothing_is_reported_of_usual_cases(kind):
    case = kind.example()
    assert case.doubts() == []


@pytest.mark.parametrize("name", ["icf_stable", "b1a_stable", "atrial", "lump", "artery_wall", "icf_printed", "b1a_printed"])
def test_nothing_is_reported_of_the_library(name):
    assert oddities({name: named_material(name).material}) == []


@pytest.mark.parametrize("text", ["1e-400 mm", "-3e-999 m", "1e-323 mm", "0.000001e-320 m"])
def test_a_number_lost_to_zero_is_refused(text):
    with pytest.raises(InvalidQuantity, match="too small to be told from 0"):
        parse_quantity(text, "m")


@pytest.mark.parametrize("text", ["0 mm", "0.000 mm", "0e-400 m", "-0 m", "0e9 um"])
def test_zero_is_zero(text):
    assert parse_quantity(text, "m") == 0


@pytest.mark.parametrize("text", ["20 furlong", "3 parsec", "2 hands", "1 light_year", "1 kibimeter", "5 mile"])
def test_a_unit_that_nobody_measures_tissue_in_is_refused(text):
    with pytest.raises(InvalidQuantity, match=r"not a unit that is read; allowed are m, mm, inch, .*mmHg"):
        parse_quantity(text, "m")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1 inch", "m", 0.0254),
        ("12 mmHg", "Pa", 1599.87),
        ("10 cmH2O", "Pa", 980.665),
        ("10 mmH2O", "Pa", 98.0665),
        ("2 psi", "Pa", 13789.5),
        ("1 kgf", "N", 9.80665),
        ("5 dyn", "N", 5e-5),
        ("5 dyn/cm^2", "Pa", 0.5),
        ("3 min", "s", 180.0),
        ("0.05 eV", "J", 8.0109e-21),
        ("2 mN/um", "N/m", 2e3),
    ],
)
def test_units_of_laboratories_are_read(text, unit, value):
    assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-5)


def test_a_metre_for_a_millimetre_is_refused_with_the_key_its_line_and_what_is_usual(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The mesh of a block of 30 m was refused without the block, the file and the line."""
    text = (CASES / "grasp_plain.yaml").read_text(encoding="utf-8")
    case = tmp_path / "case.yaml"
    case.write_text(text.replace("40 mm, 40 mm, 20 mm", "30 m, 40 mm, 20 mm"), encoding="utf-8")
    lines = case.read_text(encoding="utf-8").splitlines()
    block, mesh = (next(k for k, line in enumerate(lines, 1) if line.strip().startswith(f"{key}:")) for key in ("block", "mesh"))
    long = "experiment.block.size along x is 30 m; usual for tissue: 20 µm to 500 mm: is its unit right?"
    for command in (["show", str(case)], ["run", str(case), "--out", str(tmp_path / "out")]):
        assert main(command) == 2
        refused, *doubts = capsys.readouterr().err.splitlines()
        assert refused.startswith(f"error: {case}:{mesh}: experiment.mesh.size, ")
        assert "1001 cells along a side or more" in refused
        assert doubts[0] == f"{case}:{block}: {long}"
        assert all(doubt.startswith(f"{case}:{block}: experiment.block.size") for doubt in doubts), "of what the case says alone"
    option = "experiment.block.size=[30 m, 40 mm, 20 mm]"
    assert main(["run", "grasp_plain", "--set", option, "--out", str(tmp_path / "out")]) == 2
    assert f"--set experiment.block.size: {long}" in capsys.readouterr().err
