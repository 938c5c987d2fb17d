"""``tactsim new``, ``list`` and ``completion``: how one begins without a checkout."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tactsim.case import SCHEMA, Case, load_case, yaml_reading
from tactsim.case.template import template
from tactsim.cli import main
from tactsim.interfaces import Experiment
from tactsim.registry import kinds
from tactsim.shipped import shipped_cases


@pytest.mark.parametrize("kind", kinds(Experiment))
def test_the_written_case_is_a_starting_case_and_every_comment_a_default(kind: str, tmp_path: Path) -> None:
    text = template(kind)
    assert "``" not in text, "marks of a docstring"
    place = tmp_path / "case.yaml"
    place.write_text(text, encoding="utf-8")
    case = load_case(place)
    assert case.case_id == Case(schema=SCHEMA, title=case.title, experiment=kinds(Experiment)[kind].starting_case()).case_id
    place.write_text(re.sub(r"^  #(?=\S|  )", "  ", text, flags=re.MULTILINE), encoding="utf-8")
    assert place.read_text() != text or "defaults" not in text
    assert load_case(place).case_id == case.case_id


@pytest.mark.parametrize("kind", ["confusion", "localization", "matrix_readout"])
def test_a_case_that_reads_a_result_runs_as_it_is_written(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In an empty folder, from what comes with tactsim; the other kinds run their examples in the contract tests."""
    monkeypatch.chdir(tmp_path)
    assert main(["new", kind]) == 0
    assert main(["run", f"{kind}.yaml", "--figures", "none"]) == 0, capsys.readouterr().err
    warned = [line for line in capsys.readouterr().out.splitlines() if "warning" in line]
    expected = ["the film creeps"] if kind == "matrix_readout" else []  # the shipped grasp closed in one step
    assert len(warned) == len(expected)
    assert all(words in line for words, line in zip(expected, warned, strict=True))
    assert (tmp_path / "results" / kind / "result.json").is_file()


def test_a_grasp_starts_on_the_default_mesh() -> None:
    """The example of the tests has cells too coarse for the lump that a user will put into it."""
    assert "\n  #mesh:\n  #  kind: automatic\n" in template("grasp")


def test_a_file_is_written_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "film_test"]) == 0
    assert "run it with: tactsim run film_test.yaml" in capsys.readouterr().out
    assert main(["new", "film_test", "my film.yaml"]) == 0
    assert "run it with: tactsim run 'my film.yaml'\n" in capsys.readouterr().out, "as it can be pasted"
    (tmp_path / "film_test.yaml").write_text("mine")
    assert main(["new", "film_test"]) == 5
    assert (tmp_path / "film_test.yaml").read_text() == "mine"
    assert "--force" in capsys.readouterr().err
    assert main(["new", "film_test", "--force"]) == 0
    assert (tmp_path / "film_test.yaml").read_text() != "mine"
    assert main(["new", "film_tets", "-"]) == 2
    assert "did you mean 'film_test'" in capsys.readouterr().err
    assert main(["new", "film_test", "-"]) == 0
    assert "schema: tactsim/case/1" in capsys.readouterr().out


def test_a_new_case_says_where_its_schema_and_the_materials_are() -> None:
    lines = template("grasp").splitlines()
    assert lines[1].startswith("# An editor")
    assert lines[1].endswith("tactsim schema --out case.schema.json")
    assert "  # The tissue. Names of materials: tactsim list materials." in lines
    assert sum("tactsim list materials" in line for line in lines) == 1


def test_everything_that_ships_is_listed_with_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    shown = capsys.readouterr().out
    assert all(f"  {path.stem}" in shown for path in shipped_cases())
    assert all(word in shown for word in ("icf_stable", "indentation", "hypotheses", "table_3_1"))
    assert main(["list", "kinds"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(kinds(Experiment))
    assert all(len(line.split()) > 3 for line in lines)
    assert main(["list", "knids"]) == 2


def test_each_shipped_file_is_read_once_for_all_sections(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cases and sweeps stand in one folder, which was read for each of the two sections."""
    seen: list[str] = []
    read = yaml_reading.first_values
    monkeypatch.setattr(yaml_reading, "first_values", lambda text, *wanted: seen.append(text) or read(text, *wanted))
    assert main(["list"]) == 0
    assert len(seen) == len(set(seen)) > len(list(shipped_cases()))


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_completion_knows_every_command(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(command in script for command in ("run", "new", "list", "compare", "validate", "time-limit"))
    if shell != "bash":
        assert "compute a case and write its result" in script  # what the help of tactsim says, not the beginning of a paragraph
        assert "Computes a case and writes" not in script
    else:
        assert subprocess.run(["bash", "-n"], input=script, text=True, check=False).returncode == 0


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("run my_c", {"my_case.yaml"}),
        ("run annulus_icf my_c", {"my_case.yaml"}),
        ("run annulus_conv", {"annulus_convex"}),
        ("show annulus_conv", {"annulus_convex"}),
        ("sweep sweep_lu", {"sweep_lumps"}),
        ("new film_t", {"film_test"}),
        ("new my_c", set()),
        ("new grasp my_c", {"my_case.yaml"}),
        ("material icf_s", {"icf_stable"}),
        ("material my_c", {"my_case.yaml"}),
        ("validate table_3_3", {"table_3_3", "table_3_3_simulated"}),
        ("validate publ", {"published"}),
        ("run my_case.yaml --out fo", {"folder"}),
        ("show folder --web --reference fo", {"folder"}),
        ("data rank fo", {"folder"}),
        ("data rank folder --reference fo", {"folder"}),
        ("run annulus_icf --figures sv", {"svg"}),
    ],
)
def test_the_completion_in_bash_offers_names_and_files(
    typed: str, completed: set[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "my_case.yaml").touch()
    (tmp_path / "folder").mkdir()
    assert main(["completion", "bash"]) == 0
    script = capsys.readouterr().out
    words = ["tactsim", *typed.split()]
    press_tab = f"COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _shtab_tactsim 2>/dev/null"
    ask = ["bash", "--norc", "-c", f'{script}\n{press_tab}; printf "%s\\n" "${{COMPREPLY[@]}}"']
    offered = subprocess.run(ask, cwd=tmp_path, capture_output=True, text=True, check=False).stdout
    assert set(offered.split()) == completed


@pytest.mark.parametrize(("shell", "files"), [("zsh", "files:file:_files"), ("fish", "__fish_complete_path")])
def test_the_completion_of_the_other_shells_names_the_same(shell: str, files: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    lines = capsys.readouterr().out.splitlines()
    for name, with_files in (
        ("annulus_convex", True),
        ("icf_stable", True),
        ("film_thermogravimetry", True),
        ("film_test", False),
    ):
        offering = [line for line in lines if re.search(rf"\b{name}\b", line)]
        assert offering
        assert all((files in line) == with_files for line in offering)


def test_without_a_command_the_help_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    shown = capsys.readouterr()
    assert "compare" in shown.out
    assert "name one of the commands" in shown.err
