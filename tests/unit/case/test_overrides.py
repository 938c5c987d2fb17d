"""Overrides from the command line."""

from __future__ import annotations

import pytest

from tactsim.case import load_case
from tactsim.case.overrides import apply_override
from tactsim.case.yaml_reading import YamlProblems, read_yaml
from tactsim.errors import CaseError, InputError

TEXT = "a: {b: 1, c: null}\nlayers: [{t: 1 mm}, {t: 2 mm}]\nempty: []"


@pytest.mark.parametrize(
    ("override", "place", "value"),
    [
        ("a.b=2", ("a", "b"), 2),
        ("a.b=2 mm", ("a", "b"), "2 mm"),
        ("a.b=[1, {x: 2}]", ("a", "b"), [1, {"x": 2}]),
        ("a.b=", ("a", "b"), None),
        ("a.b=x=y", ("a", "b"), "x=y"),
        ("layers.1.t=3 mm", ("layers", 1, "t"), "3 mm"),
        ("layers.0=null", ("layers", 0), None),
    ],
)
def test_a_value_is_set(override: str, place: tuple[str | int, ...], value: object) -> None:
    document = read_yaml(TEXT)
    assert apply_override(document, override) == place
    found = document.value
    for key in place:
        found = found[key]
    assert found == value


def test_a_missing_mapping_is_created_and_named() -> None:
    document = read_yaml(TEXT)
    assert apply_override(document, "a.c.d.e=1") == ("a", "c")
    assert document.value["a"]["c"] == {"d": {"e": 1}}


def test_a_list_entry_that_is_null_can_be_entered() -> None:
    document = read_yaml("layers: [null]")
    assert apply_override(document, "layers.0.t=1 mm") == ("layers", 0)
    assert document.value == {"layers": [{"t": "1 mm"}]}


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("a.b", "not of the form path.to.key=value"),
        ("=1", "not of the form"),
        ("a..b=1", "not of the form"),
        ("a.b.c=1", "a.b is 1, which has no entry 'c'"),
        ("layers.2.t=1 mm", "entries: 0 to 1"),
        ("layers.-1.t=1 mm", "without an entry '-1'"),
        ("layers.x=1", "without an entry 'x'"),
        ("empty.0=1", "the list is empty"),
        ("a.b=[1", "cannot be read"),
        ("a.b=!!python/name:os.system x", "tag"),
        ("a.b=.nan", "not a finite number"),
    ],
)
def test_what_cannot_be_set_is_refused(override: str, words: str) -> None:
    with pytest.raises(YamlProblems, match=words.replace(".", r"\.")):
        apply_override(read_yaml(TEXT), override)


MINE = """schema: tactsim/case/1
experiment:
  kind: indentation
  specimen: {material: icf_stable, thickness: 4 mm, radius: 8 mm}
  recess: 0.8 mm
  displacement: 2 mm
"""


def test_a_part_of_a_default_can_be_set(tmp_path):
    """A case as `tactsim new` writes it says nothing of body and contact; their kinds and other dimensions stay."""
    path = tmp_path / "mine.yaml"
    path.write_text(MINE)
    plain = load_case(path).experiment
    changed = load_case(path, ["experiment.body.inner_radius=1 mm", "experiment.contact.friction=0.2"]).experiment
    assert changed.body == plain.body.model_copy(update={"inner_radius": 1e-3})
    assert changed.contact == plain.contact.model_copy(update={"friction": 0.2})
    with pytest.raises(CaseError, match=r"override experiment.contact.friction: -0.1 is out of range"):
        load_case(path, ["experiment.contact.friction=-0.1"])
    with pytest.raises(CaseError, match=r"penetration_tolerance: '1e-30 m' is out of range; must be at least 1 pm"):
        load_case(path, ["experiment.penetration_tolerance=1e-30 m"])  # the unit of a value that may be left out
    with pytest.raises(CaseError, match=r"unknown key \(did you mean 'friction'"):
        load_case(path, ["experiment.contact.fricton=0.1"])


@pytest.mark.parametrize("value", [1 + 2j, b"0.8 mm", {1, 2}, object(), [b"0.8 mm"]], ids=lambda value: type(value).__name__)
def test_what_no_case_file_can_hold_is_refused(value):
    with pytest.raises(CaseError, match=r"override experiment\.recess: .* cannot stand in a case; allowed: texts, numbers, "):
        load_case("annulus_icf", {"experiment.recess": value})
    with pytest.raises(InputError, match="cannot stand in a case"):
        load_case({"schema": "tactsim/case/1", "experiment": value})


def test_a_path_is_set_as_text(tmp_path):
    case = load_case("dma_atrial", {"experiment.data": {"kind": "file", "path": tmp_path / "moduli.csv"}})
    assert case.experiment.data.path == str(tmp_path / "moduli.csv")
