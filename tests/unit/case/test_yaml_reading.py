"""Safe reading of YAML."""

from __future__ import annotations

import pytest

from tactsim.case.yaml_reading import LARGEST_COUNT, LARGEST_DEPTH, YamlProblems, first_values, read_yaml


def test_plain_values_follow_the_core_schema() -> None:
    text = "{a: 1, b: -2.5e3, c: true, d: null, e: ~, f: text, g: '1', h: [1, .5], i: yes, j: 0x10, k: 012, l: 1_000}"
    expected = {"a": 1, "b": -2500.0, "c": True, "d": None, "e": None, "f": "text", "g": "1", "h": [1, 0.5]}
    assert read_yaml(text).value == {**expected, "i": "yes", "j": "0x10", "k": 12, "l": "1_000"}


def test_keys_are_text() -> None:
    assert read_yaml("1: a\nnull: b\ntrue: c").value == {"1": "a", "null": "b", "true": "c"}


def test_every_key_path_has_its_line() -> None:
    document = read_yaml("a:\n  b:\n    - c: 1\n    - c: 2\n")
    assert document.lines[("a", "b", 1, "c")] == 4
    assert document.line(("a", "b", 1, "missing", "deeper")) == 4
    assert document.line(()) == 1


def test_an_alias_is_a_copy() -> None:
    value = read_yaml("a: &x {b: [1]}\nc: *x").value
    assert value["c"] == {"b": [1]}
    assert value["c"] is not value["a"]


@pytest.mark.parametrize("text", ["", "# nothing\n", "---\n", "null"])
def test_an_empty_text_is_none(text: str) -> None:
    assert read_yaml(text).value is None


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a: 1\nb: !!python/object/apply:os.system [x]", 2, "tag '!!python/object/apply:os.system'"),
        ("a: !!str 1", 1, "tag '!!str'"),
        ("!local\na: 1", 1, "tag '!local'"),
        ("a: ! b", 1, "tag"),
        ("a: 1\nb: 2\na: 3", 3, "repeated key; it stands already on line 1"),
        ("a: .nan", 1, "not a finite number"),
        ("a: -.inf", 1, "not a finite number"),
        ("a: 1e999", 1, "not a finite number"),
        ("a: " + "9" * 5000, 1, "not a finite number"),
        ("? [1, 2]\n: 3", 1, "a key must be plain text"),
        ("? {a: 1}\n: 3", 1, "a key must be plain text"),
        (": 3", 1, "a key must be plain text"),
        ("a: *b", 1, "alias 'b' is not defined"),
        ("a: &a [*a]", 1, "alias 'a' is not defined"),
        ("a: 1\n---\nb: 2", 2, "second document"),
        ("a: [1\nb: 2", 2, "not valid YAML: while parsing a flow sequence (begun on line 1) expected ',' or ']'"),
        ("a:\n  b 1\n  c: 2", 3, "the slip may be on the line before"),
        ("a: 'x\nb: 2\n", 3, "not valid YAML: while scanning a quoted scalar (begun on line 1) found"),
        ("a:\n\tb: 1", 2, "not valid YAML: a tab; write spaces"),
        ("a: \x07", 0, "not valid YAML"),
        ('a: "\\UFFFFFFFF"', 0, "not valid YAML"),
        ('a: "\\uD800"', 1, "not valid Unicode"),
        ("[" * 1000, 1, f"more than {LARGEST_DEPTH} levels"),
        ("- " * 1000, 1, f"more than {LARGEST_DEPTH} levels"),
    ],
)
def test_refusals_name_the_line(text: str, line: int, words: str) -> None:
    with pytest.raises(YamlProblems) as caught:
        read_yaml(text)
    assert words in caught.value.problems[0].message
    assert caught.value.problems[0].line == line


def test_several_problems_are_told_together() -> None:
    with pytest.raises(YamlProblems) as caught:
        read_yaml("a: !x 1\nb: .nan\na: 2")
    assert [problem.line for problem in caught.value.problems] == [1, 2, 3]


def test_an_alias_bomb_is_refused_before_it_grows() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 30)]
    with pytest.raises(YamlProblems, match=f"more than {LARGEST_COUNT} values"):
        read_yaml("\n".join(lines))


def test_first_values_are_read_no_further_than_to_the_last_of_them() -> None:
    text = "title: a\nexperiment:\n  size: 3 mm\n  kind: grasp\n  kind: twice\n"
    assert first_values(text, ("title",), ("experiment", "kind")) == {("title",): "a", ("experiment", "kind"): "grasp"}
    with pytest.raises(YamlProblems, match="repeated key"):
        first_values(text, ("title",), ("steps",))
    assert first_values("title: a\nrows: [1]\n", ("title",), ("experiment", "kind")) == {("title",): "a"}
