"""From a file to a validated case."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
from pretence import CASE_TEXT, Pretence

from tactsim.case import Case, load_case
from tactsim.case.yaml_reading import read_yaml
from tactsim.errors import CaseError, StorageError
from tactsim.outside.files import LIMITS
from tactsim.shipped import CASES


def refused(path: Path, text: str, *overrides: str) -> list[str]:
    """The lines of the refusal, without the folder of the file."""
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as caught:
        load_case(path, overrides)
    return str(caught.value).replace(str(path), path.name).splitlines()


def test_a_valid_case_is_in_si_with_defaults(case_file: Path) -> None:
    case = load_case(case_file)
    assert isinstance(case, Case)
    assert isinstance(case.experiment, Pretence)
    assert case.experiment.specimen.layers[0].thickness == 0.01
    assert case.experiment.friction == 0.4
    assert case.title == "A pretended case"
    assert case.output.fields == "all"


def test_overrides_are_validated_like_the_file(case_file: Path) -> None:
    case = load_case(case_file, ["experiment.specimen.layers.1.thickness=3000 um", "output.fields=last"])
    assert case.experiment.specimen.layers[1].thickness == 0.003
    assert case.output.fields == "last"


def test_a_single_override_may_be_a_text_as_it_is(case_file: Path) -> None:
    assert load_case(case_file, "output.fields=last").output.fields == "last"


def test_every_fault_is_told_with_line_path_value_and_choices(case_file: Path) -> None:
    text = CASE_TEXT.replace("radius: 20 mm", "raduis: 20 mm").replace("thickness: 10 mm", "thickness: -1 mm")
    text = text.replace("modulus: 3 kPa", "modulus: 3 mm").replace("kind: stiff", "kind: stif") + "  friction: 3\n"
    assert refused(case_file, text) == [
        "case.yaml:7: experiment.specimen.raduis: unknown key (did you mean 'radius'?); allowed: radius, layers, hole",
        "case.yaml:9: experiment.specimen.layers.0.thickness: '-1 mm' is out of range; must be greater than 0 m",
        "case.yaml:10: experiment.specimen.layers.0.material.modulus: '3 mm' has the wrong dimension; "
        "expected a pressure with its unit, such as '1 kPa'",
        "case.yaml:13: experiment.specimen.layers.1.material.kind: unknown kind 'stif' (did you mean 'stiff'?); "
        "choices: soft, stiff",
        "case.yaml:15: experiment.friction: 3 is out of range; must be at most 2.0",
    ]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "c10: 10 kPa",
            "c10: 10",
            "14: experiment.specimen.layers.1.material.c10: 10 has no unit; expected text such as '10 kPa' or '10 Pa'",
        ),
        ("c10: 10 kPa", "c10: 10 kPs", "14: experiment.specimen.layers.1.material.c10: '10 kPs' has an unknown unit 'kPs'; "),
        ("c10: 10 kPa", "c10: true", "14: experiment.specimen.layers.1.material.c10: True is not a quantity; "),
        (
            "c10: 10 kPa",
            "exponent: 2",
            "12: experiment.specimen.layers.1.material.c10: missing; expected a quantity with its unit, ",
        ),
        ("kind: pretence", "kind: pretense", "5: experiment.kind: unknown kind 'pretense' (did you mean 'pretence'?); choices: "),
        ("kind: pretence", "knid: pretence", "4: experiment.kind: missing; choices: pretence"),
        ("title: A", "titel: A", "3: titel: unknown key (did you mean 'title'?); allowed: schema, title, experiment, output"),
        ("title: A pretended case", "title: 5", "3: title: 5 is not allowed; expected a text"),
        ("radius: 20 mm", "hole: 30 mm", "6: experiment.specimen: hole 0.03 m must be smaller than radius 0.02 m"),
        ("kind: pretence", "kind: pretence\n  named: x", "4: experiment: unknown pretended name 'x'; known: known, other"),
        ("kind: pretence", "kind: pretence\n  steps: true", "6: experiment.steps: true is not allowed; expected a whole number"),
        ("kind: pretence", "kind: pretence\n  steps: '3'", "6: experiment.steps: '3' is not allowed; expected a whole number"),
        ("kind: pretence", "kind: pretence\n  steps: 1.5", "6: experiment.steps: 1.5 is not allowed; expected a whole number"),
        ("kind: pretence", "kind: pretence\n  friction: nan", "6: experiment.friction: 'nan' is not allowed; expected a number"),
        (
            "kind: pretence",
            "kind: pretence\n  friction: 0,6",
            "6: experiment.friction: '0,6' is not allowed; expected a number; decimals begin with a point, not a comma",
        ),
        (
            "kind: pretence",
            "kind: pretence\n  friction: 40 %",
            "6: experiment.friction: '40 %' is not allowed; expected a number, 0.4 for 40 %",
        ),
        ("modulus: 3 kPa}", "modulus: 3,5 kPa}", "10: experiment.specimen.layers.0.material.5 kPa: unknown key"),
        ("kind: pretence", "kind: pretence\n  pause: nan s", "6: experiment.pause: 'nan s' is not finite; "),
        (
            "{kind: soft, modulus: 3 kPa}",
            "{modulus: 3 kPa}",
            "10: experiment.specimen.layers.0.material.kind: missing; choices: ",
        ),
        ("{kind: soft, modulus: 3 kPa}", "3", "10: experiment.specimen.layers.0.material: 3 is not allowed; expected a mapping "),
        ("tactsim/case/1", "tactsim/case/2", "2: schema: the version 'tactsim/case/2' is not supported; this tactsim reads "),
        ("tactsim/case/1", "0", "2: schema: the version 0 is not supported; this tactsim reads 'tactsim/case/1'"),
        ("schema: tactsim/case/1\n", "", "2: schema: missing; the file must begin with 'schema: tactsim/case/1'"),
    ],
)
def test_one_fault(case_file: Path, old: str, new: str, expected: str) -> None:
    lines = refused(case_file, CASE_TEXT.replace(old, new))
    assert any(line.startswith(f"case.yaml:{expected}") for line in lines), lines
    assert not any("pydantic" in line or "http" in line for line in lines)


def test_a_union_with_a_word_names_both(case_file: Path) -> None:
    (line,) = refused(case_file, CASE_TEXT + "  element_size: 3 Pa\n")
    assert "experiment.element_size: '3 Pa' has the wrong dimension" in line
    assert line.endswith("choices: 'auto'")


def test_a_sweep_with_the_schema_of_a_case_is_answered_with_that_of_a_sweep(case_file: Path) -> None:
    """Each of its distributions was refused instead."""
    (line,) = refused(case_file, CASE_TEXT + "  friction: {uniform: [0, 1]}\nsweep: {samples: 3}\n")
    assert line.endswith("sweep: a case has no such section; a sweep begins with 'schema: tactsim/sweep/1'")


def test_the_missing_experiment_is_told(case_file: Path) -> None:
    (line,) = refused(case_file, "schema: tactsim/case/1\n")
    assert line.startswith("case.yaml:1: experiment: missing; expected a mapping with a kind of pretence")


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("experiment.frction=1", "override experiment.frction: unknown key (did you mean 'friction'?); allowed: kind, "),
        ("experiment.solver.tolerance=1", "override experiment.solver.tolerance: experiment.solver: unknown key; allowed: "),
        ("experiment.specimen.layers=null", "override experiment.specimen.layers: null is not allowed; expected a list"),
        ("experiment.specimen.layers.0=1", "override experiment.specimen.layers.0: 1 is not allowed; expected a mapping with "),
        ("experiment.specimen.layers.9.thickness=1 mm", "override experiment.specimen.layers.9.thickness=1 mm: experiment."),
        ("experiment.friction", "override experiment.friction: 'experiment.friction' is not of the form path.to.key=value"),
        ("friction=1", "override friction: unknown key (did you mean 'experiment.friction'?); allowed: schema, title, "),
        ("experiment=null", "override experiment: null is not a mapping with a 'kind'; choices: pretence"),
        (
            "experiment.kind=x",
            "override experiment.kind: unknown kind 'x'; choices: pretence; a kind that is defined in Python is known in that "
            "process alone: load the case there with ts.load_case",
        ),
        ("schema=tactsim/case/9", "override schema: the version 'tactsim/case/9' is not supported"),
    ],
)
def test_a_fault_of_an_override_names_the_override(case_file: Path, override: str, expected: str) -> None:
    lines = refused(case_file, CASE_TEXT, override)
    assert lines[0].startswith(expected), lines


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "the file is empty"),
        (b"# only a comment\n", "the file is empty"),
        (b"- 1\n", "holds [1]; a case is a mapping"),
        (b"text", "holds 'text'; a case is a mapping"),
        (b"title: \xff\xfe\n", "case.yaml:1: byte 0xff is not UTF-8 text"),
        ("title: x".encode("utf-16"), "is not UTF-8 text"),
        (b"\x7fELF\x00\x01", "not valid YAML"),
        (b"#" * (LIMITS["case file"] + 1), "larger than 1048576 bytes"),
    ],
)
def test_unusable_content(case_file: Path, content: bytes, words: str) -> None:
    case_file.write_bytes(content)
    with pytest.raises(CaseError) as caught:
        load_case(case_file)
    assert words in str(caught.value)


def test_a_byte_order_mark_is_fine(case_file: Path) -> None:
    case_file.write_text(CASE_TEXT, encoding="utf-8-sig")
    assert load_case(case_file).title == "A pretended case"


def test_unreadable_files(tmp_path: Path, pretended: None) -> None:
    os.symlink(tmp_path / "nowhere", tmp_path / "dangling.yaml")
    for path in (tmp_path, tmp_path / "missing.yaml", tmp_path / "dangling.yaml", tmp_path / ("x" * 4096), "a\0b"):
        with pytest.raises(StorageError, match="cannot read the case file"):
            load_case(path)


def test_of_two_files_of_one_name_the_missing_one_is_blamed(tmp_path: Path) -> None:
    """The path of the one that is there is part of that of the other."""
    shutil.copy(CASES.parent / "meshes" / "lump.stl", tmp_path)
    case = read_yaml((CASES / "grasp_stl.yaml").read_text(encoding="utf-8")).value
    lump = case["experiment"]["inclusions"][0]
    paths = ("lump.stl", "sub/lump.stl")
    case["experiment"]["inclusions"] = [lump | {"shape": lump["shape"] | {"path": str(tmp_path / path)}} for path in paths]
    case["experiment"]["inclusions"][0]["shape"]["path"] = "lump.stl"
    (tmp_path / "case.json").write_text(json.dumps(case), encoding="utf-8")
    with pytest.raises(StorageError, match=r"experiment.inclusions.1.shape.path: "):
        load_case(tmp_path / "case.json")


def test_a_data_set_is_no_case_and_its_commands_are_named(tmp_path: Path) -> None:
    (tmp_path / "lumps.zarr").mkdir()
    (tmp_path / "lumps.zarr" / "zarr.json").write_text("{}", encoding="utf-8")
    with pytest.raises(
        StorageError, match=r"lumps.zarr is a data set, not a case; tactsim show \S+ and tactsim data info \S+ say"
    ):
        load_case(tmp_path / "lumps.zarr")


def test_a_mapping_is_a_case_and_refused_in_the_words_of_a_file(pretended: None) -> None:
    value = read_yaml(CASE_TEXT).value
    assert load_case(value, {"experiment.steps": 7}).experiment.steps == 7
    assert "steps" not in value["experiment"], "the mapping stays as it is"
    assert load_case(value) == load_case(read_yaml(CASE_TEXT).value)
    with pytest.raises(CaseError, match=r"^case: titel: unknown key \(did you mean 'title'\?\)"):
        load_case(value | {"titel": "A"})
    with pytest.raises(CaseError, match=r"^override experiment.steps: 'x' is not allowed"):
        load_case(value, {"experiment.steps": "x"})
    with pytest.raises(CaseError, match=r"^override experiment.steps.0.x: experiment.steps is"):
        load_case(value, {"experiment.steps": 7, "experiment.steps.0.x": 1})


def test_a_folder_of_the_name_of_a_shipped_case_is_no_case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """``tactsim run annulus_icf --out annulus_icf`` could not be run twice."""
    monkeypatch.chdir(tmp_path)
    Path("annulus_icf").mkdir()
    assert load_case("annulus_icf").experiment.kind == "indentation"
    Path("my_results").mkdir()
    with pytest.raises(StorageError, match="it is a folder"):
        load_case("my_results")
