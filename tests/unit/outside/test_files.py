"""Files of others: regular, bounded, found beside the case first."""

from __future__ import annotations

import copy
import os
import pickle
from pathlib import Path

import pytest
from pydantic import BaseModel, ValidationError

from tactsim.outside.files import CasePath, TooLarge, Unreadable, located, opened, opened_folder
from tactsim.outside.input_path import InputPath, input_paths


@pytest.fixture(autouse=True)
def working(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a folder of cases in it, and something outside of both."""
    for name in ("work", "cases", "outside"):
        (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / "work")
    return tmp_path


def test_a_file_is_looked_for_beside_the_case_and_then_in_the_working_folder(working: Path) -> None:
    path = CasePath("a.csv", working / "cases")
    with pytest.raises(Unreadable, match=r"a\.csv: No such file .*looked in the folder of the case and in the working folder"):
        opened(path, "table")
    (working / "work" / "a.csv").write_text("work")
    assert (opened(path, "table").place, opened(path, "table").text()) == ("in the working folder", "work")
    (working / "cases" / "a.csv").write_text("case")
    assert (opened(path, "table").place, opened(path, "table").text()) == ("beside the case", "case")
    assert opened("a.csv", "table").text() == "work"


def test_what_lies_outside_of_both_is_known(working: Path) -> None:
    secret = working / "outside" / "b.csv"
    secret.write_text("x")
    os.symlink(secret, working / "cases" / "link.csv")
    for name in (str(secret), "../outside/b.csv", "link.csv"):
        assert located(CasePath(name, working / "cases")) == "elsewhere"


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: os.symlink("/dev/zero", path)])
def test_only_regular_files_are_opened(make) -> None:
    make("thing")
    with pytest.raises(Unreadable, match=r"it is a (pipe|folder|device); allowed: a regular file"):
        opened("thing", "table")


def test_a_file_has_a_largest_size() -> None:
    Path("big").write_bytes(b"x" * 100)
    with pytest.raises(TooLarge, match="larger than 99 bytes"):
        opened("big", "table", 99)
    file = opened("big", "table", 100)
    Path("big").write_bytes(b"x" * 101)
    with pytest.raises(TooLarge):
        file.read()


def test_other_bytes_than_text_are_reported() -> None:
    Path("a").write_bytes(b"ok\xff")
    with pytest.raises(Unreadable, match="byte 0xff at 2 is not UTF-8 text; save it as UTF-8"):
        opened("a", "table").text()
    Path("a").write_bytes(b"\xef\xbb\xbfok")
    assert opened("a", "table").text() == "ok"


def test_names_cannot_forge_lines() -> None:
    with pytest.raises(Unreadable) as refusal:
        opened("a\nconverged\x1b[31m", "table")
    assert str(refusal.value) == "cannot read the table a\\nconverged\\x1b[31m: No such file or directory"
    with pytest.raises(Unreadable, match="embedded null"):
        opened("a\0b", "table")


def test_a_folder_is_found_alike(working: Path) -> None:
    (working / "cases" / "result").mkdir()
    assert opened_folder(CasePath("result", working / "cases"), "result")[1] == "beside the case"
    Path("file").write_text("")
    with pytest.raises(Unreadable, match="file is not a folder with a result"):
        opened_folder("file", "result")


class Source(BaseModel):
    """A part of a case."""

    path: InputPath
    more: tuple[InputPath, ...] = ()


def test_a_path_in_a_case_knows_the_folder_and_is_written_as_it_is() -> None:
    source = Source.model_validate_json('{"path": "a.csv", "more": ["b", "c"]}', strict=True, context={"folder": "cases"})
    assert source.path.beside == Path("cases")
    assert source.model_dump(mode="json") == {"path": "a.csv", "more": ["b", "c"]}
    assert [key for key, _ in input_paths({"source": source})] == [
        ("source", "path"),
        ("source", "more", 0),
        ("source", "more", 1),
    ]
    for copied in (copy.deepcopy(source.path), pickle.loads(pickle.dumps(source.path)), Source.model_validate(source).path):
        assert copied.beside == Path("cases")


@pytest.mark.parametrize("path", ["", " ", "a\0b", "x" * 5000])
def test_a_path_that_cannot_be_is_refused(path: str) -> None:
    with pytest.raises(ValidationError, match="a path of 1 to 4096 characters"):
        Source(path=path)
