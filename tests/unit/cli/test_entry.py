"""The command line as a whole."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tactsim import __version__
from tactsim.cli import command_schema, entry, main
from tactsim.shipped import CASES

STORED_GRASP = str(CASES / "stored" / "grasp_lump")


def test_help_names_every_command_and_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for word in ("run", "show", "material", "schema", "exit codes", "130  interrupted"):
        assert word in text


@pytest.mark.parametrize("command", [command.NAME for command in entry.COMMANDS])
def test_every_command_has_examples(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, "--help"]) == 0
    text = capsys.readouterr().out
    assert f"tactsim {command}" in text.split("\nexample")[1]


@pytest.mark.parametrize(
    ("action", "needed"),
    [
        ("export", ["--to PLACE"]),
        ("rank", ["--reference RESULT"]),
        ("train", ["--reference RESULT", "--out PLACE"]),
        ("confusion", ["--reference RESULT"]),
    ],
)
def test_what_must_be_given_stands_in_no_brackets(action: str, needed: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", action, "--help"]) == 0
    usage = " ".join(capsys.readouterr().out.split("\n\n")[0].split())
    assert usage.startswith(f"usage: tactsim data {action} [-h]")
    for option in needed:
        assert f" {option} " in usage
    assert ("--out PLACE" in usage.replace("[--out PLACE]", "")) == ("--out PLACE" in needed)


def test_the_version_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"tactsim {__version__}\n"


@pytest.mark.parametrize(
    "arguments",
    [[], ["rnu"], ["run"], ["run", "a", "--unknown"], ["run", "a", "--quiet", "--progress"], ["show"], ["schema", "x"]],
)
def test_a_wrong_command_line_is_bad_input(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert "--help" in error


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["run", "annulus_icf", "--out", ""], "--out"),
        (["run", ""], "CASE"),
        (["schema", "--out", ""], "--out"),
        (["sweep", "sweep_closed_form", "--out", " "], "--out"),
        (["data", "export", "store", "--to", ""], "--to"),
        (["material", "--fit", ""], "--fit"),
    ],
)
def test_an_empty_path_is_bad_input(arguments: list[str], name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"error: argument {name}: {arguments[-1]!r} is no path; name a file or folder, . is the working")


@pytest.mark.parametrize("arguments", [["schema"], ["sweep", "sweep_closed_form"]])
def test_a_place_without_a_name_cannot_be_written(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*arguments, "--out", "."]) == 5
    assert capsys.readouterr().err.startswith("error: cannot write .: it is a folder without a name of its own")


def test_the_package_is_the_command() -> None:
    done = subprocess.run([sys.executable, "-m", "tactsim", "--version"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, f"tactsim {__version__}\n")


def test_an_unknown_option_leads_to_the_help_of_its_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "a", "--sett", "x=1"]) == 2
    assert capsys.readouterr().err == "error: unrecognized arguments: --sett x=1\nsee: tactsim run --help\n"
    assert main(["data", "export", "store", "--out", "x"]) == 2
    assert capsys.readouterr().err == "error: unrecognized arguments: --out x\nsee: tactsim data export --help\n"
    assert main(["data", "export", "store", "out.h5"]) == 2
    assert "arguments: out.h5; the place to write to follows --to\nsee" in capsys.readouterr().err
    assert main(["show", "a", "b"]) == 2
    assert "arguments: b; several results are laid side by side by: tactsim compare\nsee" in capsys.readouterr().err
    assert main(["--sett"]) == 2
    assert capsys.readouterr().err.endswith("see: tactsim --help\n")


@pytest.mark.parametrize("debug", [False, True])
def test_a_defect_is_reported_as_such(debug: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def broken(arguments: object) -> int:
        raise RuntimeError("wheel came off")

    monkeypatch.setattr(command_schema, "run", broken)
    assert main(["schema", *(["--debug"] if debug else [])]) == 1
    error = capsys.readouterr().err
    assert error.startswith("error: internal error (RuntimeError: wheel came off); please report it")
    assert f"line {broken.__code__.co_firstlineno + 1} of {__name__} is your own" in error
    assert ("Traceback" in error) == debug


def test_a_known_error_has_its_traceback_only_for_debugging(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(tmp_path)]) == 5
    assert "Traceback" not in capsys.readouterr().err
    assert main(["show", str(tmp_path), "--debug"]) == 5
    assert "Traceback" in capsys.readouterr().err


def test_help_is_quick_because_it_imports_nothing_heavy() -> None:
    code = "import sys; from tactsim.cli import main; main(['--help']); print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "pydantic", "pint", "ruamel", "matplotlib", "meshio"} & set(done.stderr.split())


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["run", "annulus_icf", "--set", "experiment.reces=1 mm"], 2),
        (["material", "icf_stable"], 0),
        (["show", STORED_GRASP], 0),
    ],
)
def test_what_needs_plain_units_alone_does_not_wait_for_pint(words: list[str], code: int) -> None:
    """Which takes a third of a second to load, with Dask where that is installed."""
    program = f"import sys; from tactsim.cli import main; code = main({words!r}); print(code, *sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    answered, *loaded = done.stderr.splitlines()[-1].split()
    assert int(answered) == code
    assert not {"pint", "dask", "scipy.optimize", "matplotlib", "numba"} & set(loaded)


@pytest.mark.parametrize("action", ["check", "info", "export", "rank", "train", "confusion"])
def test_each_action_of_data_has_its_own_help(action: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", action, "--help"]) == 0
    text = capsys.readouterr().out
    assert text.startswith(f"usage: tactsim data {action}")
    assert f"tactsim data {action} " in text.split("example:")[1]
    assert ("--reference" in text) == (action in ("rank", "train", "confusion"))
    assert ("--to" in text) == (action == "export")


@pytest.mark.parametrize(("words", "near"), [(["shwo", "x"], "show"), (["data", "chek", "x"], "check"), (["zzz"], "")])
def test_a_misspelt_command_suggests_the_one_that_was_meant(
    words: list[str], near: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    refusal = capsys.readouterr().err
    assert f"(did you mean {near!r}?)" in refusal if near else "did you mean" not in refusal
