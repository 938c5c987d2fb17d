"""Case files from strangers and from tired people: exit code 2 (or 5), the place, and nothing written or executed."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from pretence import CASE_TEXT

from tactsim.case.yaml_reading import plain_scalar
from tactsim.cli import main

BOMB = "\n".join(["a0: &a0 [1,1,1,1,1,1,1,1,1]", *(f"a{n}: &a{n} [{','.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 12))])

TABLE: dict[str, tuple[str | bytes, int, str]] = {
    "unknown key": (
        CASE_TEXT.replace("c10", "C01_kpa"),
        2,
        "case.yaml:14: experiment.specimen.layers.1.material.C01_kpa: unknown",
    ),
    "unknown key at the top": (CASE_TEXT + "extra: 1\n", 2, "case.yaml:15: extra: unknown key"),
    "wrong unit": (CASE_TEXT.replace("3 kPa", "3 mm"), 2, "'3 mm' has the wrong dimension"),
    "unknown unit": (CASE_TEXT.replace("3 kPa", "3 kPs"), 2, "unknown unit 'kPs'"),
    "bare number": (CASE_TEXT.replace("20 mm", "0.02"), 2, "radius: 0.02 has no unit"),
    "tower of powers": (CASE_TEXT.replace("20 mm", "20 m**9**9**9**9"), 2, "unknown unit"),
    "code in a unit": (CASE_TEXT.replace("20 mm", "20 __import__('os')"), 2, "unknown unit"),
    "nan": (CASE_TEXT + "  friction: .nan\n", 2, "experiment.friction: '.nan' is not a finite number"),
    "inf": (CASE_TEXT + "  friction: .inf\n", 2, "not a finite number"),
    "nan with a unit": (CASE_TEXT.replace("20 mm", "nan mm"), 2, "'nan mm' is not finite"),
    "infinite after conversion": (CASE_TEXT.replace("20 mm", "1e308 km"), 2, "is not finite"),
    "huge number": (CASE_TEXT + f"  friction: {'9' * 100_000}\n", 2, "not a finite number"),
    "empty": ("", 2, "the file is empty"),
    "list": ("- 1\n", 2, "a case is a mapping"),
    "python tag": (f"a: !!python/object/apply:os.system ['touch executed']\n{CASE_TEXT}", 2, "case.yaml:1: a: the tag"),
    "any tag": (
        CASE_TEXT.replace("3 kPa", "!!str 3 kPa"),
        2,
        "case.yaml:10: experiment.specimen.layers.0.material.modulus: the tag",
    ),
    "alias bomb": (BOMB, 2, "more than 100000 values"),
    "self-reference": ("a: &a {b: *a}\n", 2, "alias 'a' is not defined"),
    "merge key": ("a: &a {b: 1}\n" + CASE_TEXT + "  <<: *a\n", 2, "experiment.<<: unknown key"),
    "deep nesting": ("a: " + "[" * 100_000, 2, "levels deep"),
    "repeated key": (CASE_TEXT + "title: again\n", 2, "case.yaml:15: title: repeated key; it stands already on line 3"),
    "broken syntax": (CASE_TEXT + "  a: [1\n", 2, "not valid YAML"),
    "binary": (b"\x7fELF\x02\x01\x01\x00" * 100, 2, "not valid YAML"),
    "not utf-8": (CASE_TEXT.encode("utf-16"), 2, "not UTF-8"),
    "too large": ("# " + "x" * 2**20, 2, "larger than 1048576 bytes"),
    "future version": (CASE_TEXT.replace("case/1", "case/2"), 2, "this tactsim reads 'tactsim/case/1'"),
    "past version": (CASE_TEXT.replace("case/1", "case/0"), 2, "this tactsim reads 'tactsim/case/1'"),
    "hole outside": (CASE_TEXT.replace("radius: 20 mm", "radius: 20 mm\n    hole: 21 mm"), 2, "must be smaller than radius"),
}


@pytest.mark.parametrize("name", TABLE)
def test_a_bad_case_is_refused_in_words(
    name: str, case_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    content, code, words = TABLE[name]
    case_file.write_bytes(content.encode() if isinstance(content, str) else content)
    monkeypatch.chdir(case_file.parent)
    assert main(["run", "case.yaml"]) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("error: case.yaml")
    assert words in err
    assert not any(internal in err for internal in ("pydantic", "Traceback", "http", "ruamel", "function-before"))
    assert max(map(len, err.splitlines())) < 500
    assert os.listdir(".") == ["case.yaml"]


@pytest.mark.parametrize("make", [os.mkdir, lambda path: os.symlink("nowhere", path), lambda path: None])
def test_a_file_that_cannot_be_read_is_an_input_output_error(
    make: Callable[[str], None],
    tmp_path: Path,
    pretended: None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    make("bad.yaml")
    assert main(["run", "bad.yaml"]) == 5
    assert capsys.readouterr().err.startswith("error: cannot read the case file bad.yaml: ")
    assert not Path("results").exists()


def test_a_file_without_permission_is_an_input_output_error(
    case_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import builtins

    def refusing(path: object, *rest: object, **options: object) -> object:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(builtins, "open", refusing)
    assert main(["run", str(case_file)]) == 5
    assert "Permission denied" in capsys.readouterr().err


@pytest.mark.parametrize(
    "name", ["-case.yaml", "mit Leerzeichen.yaml", "größe-μ-测试.yaml", "quote'\".yaml", "line\nbreak.yaml", "100%.yaml"]
)
def test_unusual_names_work(name: str, tmp_path: Path, pretended: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(CASE_TEXT, encoding="utf-8")
    assert main(["run", "--quiet", "--", name]) == 0
    assert Path("results", Path(name).stem, "result.json").is_file()
    assert main(["run", "--quiet", "--out=-out dir", f"./{name}"]) == 0
    assert Path("-out dir", "result.json").is_file()


def test_a_name_that_is_not_unicode_works(tmp_path: Path, pretended: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    name = os.fsdecode(b"case\xff.yaml")
    Path(name).write_text(CASE_TEXT, encoding="utf-8")
    assert main(["run", name]) == 0
    assert main(["run", name, "--set", "nothing"]) == 2


def test_very_long_paths_are_refused_in_words(case_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "x" * 4096]) == 5
    assert main(["run", str(case_file), "--out", "y/" * 2048 + "z"]) == 5
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("text", ["012", "1_000", "0x10", "0o7", "1e3", "+.5", "yes", "on", "1:30", "2001-01-01"])
def test_old_yaml_surprises_stay_text_or_plain_numbers(text: str) -> None:
    expected = {"012": 12, "1e3": 1000.0, "+.5": 0.5}
    assert plain_scalar(text) == expected.get(text, text)
