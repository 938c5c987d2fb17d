"""Random damage to a data set: every command ends in words and with a documented exit code."""

from __future__ import annotations

import json
import os
import resource
import shutil
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sweeps import assert_same, compute_once_here, small_store, sweep_file

from tactsim.cli import main
from tactsim.dataset import load
from tactsim.dataset.cost import COST
from tactsim.dataset.figures import card as dataset_card
from tactsim.errors import TactsimError

QUICK = settings(derandomize=True, deadline=None, max_examples=8, suppress_health_check=list(HealthCheck))
LONG = settings(QUICK, max_examples=int(os.environ.get("FUZZ_N", "3000")))
CODES = {0, 2, 3, 4, 5}
MEMORY = 6 * 2**30
"""Bytes of address space beyond which a reader has believed a number in a file; libraries and threads reserve three of them."""
SPOILT_VALUES: list[Any] = [
    None, True, False, 0, -1, 1, 7, 10**12, 10**30, 1.5, float("nan"), "", "x", "NaN", "\n\x1b[31m", "0" * 2000, [], [1], [0],
    [-1], [10**12], [None], [[]], {}, {"name": "x"}, {"a": {"b": [1]}}, [24], [24, 4], [10**12, 4], "float64", "object", "string",
    "int64", "<U5", "sample", "../../etc", "/etc/passwd",
]  # fmt: skip


@cache
def kept() -> Path:
    """A small store that stays as it is, removed with the folder of all temporary files."""
    import tempfile

    folder = Path(tempfile.mkdtemp(prefix="fuzzed"))
    return small_store(folder)


@pytest.fixture(autouse=True)
def bounded(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Samples are computed once and in this process, nothing is drawn, and memory is bounded."""
    compute_once_here(monkeypatch)
    monkeypatch.setattr(dataset_card, "card_figures", lambda store: {})
    kept()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


def places_in(value: Any, place: tuple = ()) -> Iterator[tuple]:
    """Key paths of every value within a JSON value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in inner:
        yield (*place, key)
        yield from places_in(item, (*place, key))


def spoil_json(path: Path, draw: Any) -> None:
    """Changes or removes one value of a description, also within the text of the sweep."""
    metadata = json.loads(path.read_text())
    places = [place for place in places_in(metadata) if "consolidated_metadata" not in place[:-1]]
    place = draw(st.sampled_from(places))
    holder = metadata
    for key in place[:-1]:
        holder = holder[key]
    if place[-1] == "sweep" and draw(st.booleans()):
        holder["sweep"] = spoilt_text(holder["sweep"], draw)
    elif draw(st.integers(0, 3)):
        holder[place[-1]] = draw(st.sampled_from(SPOILT_VALUES))
    else:
        del holder[place[-1]]
    path.write_text(json.dumps(metadata))


def spoilt_text(text: str, draw: Any) -> str:
    content = json.loads(text)
    place = draw(st.sampled_from(list(places_in(content))))
    holder = content
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] = draw(st.sampled_from(SPOILT_VALUES))
    return json.dumps(content)


def spoil_bytes(path: Path, draw: Any) -> None:
    """Truncates a file, replaces some of it, empties it, makes it longer, or exchanges it for another chunk."""
    content = bytearray(path.read_bytes())
    how = draw(st.integers(0, 5))
    at = draw(st.integers(0, max(0, len(content) - 1)))
    if how == 0:
        content = content[:at]
    elif how == 1:
        content[at : at + 4] = draw(st.binary(min_size=1, max_size=8))
    elif how == 2:
        content = bytearray(draw(st.binary(max_size=40)))
    elif how == 3:
        content += draw(st.binary(min_size=1, max_size=40))
    elif how == 4:
        content = bytearray(len(content))
    else:
        others = sorted(place for place in kept().rglob("c/**/*") if place.is_file())
        content = bytearray(draw(st.sampled_from(others)).read_bytes())
    path.write_bytes(content)


def spoil_tree(path: Path, store: Path, draw: Any) -> None:
    """Removes a file or its folder, or puts something else in its place."""
    how = draw(st.integers(0, 3))
    if how == 1 and path.parent != store:
        shutil.rmtree(path.parent)
        return
    path.unlink()
    if how == 2:
        path.mkdir()
    elif how == 3:
        path.symlink_to(draw(st.sampled_from(["/dev/zero", "/etc/passwd", ".", "nowhere"])))


def damaged(store: Path, draw: Any) -> None:
    for _ in range(draw(st.integers(1, 3))):
        files = sorted(place for place in store.rglob("*") if place.is_file() and not place.is_symlink())
        if not files:
            return
        descriptions = [place for place in files if place.name == "zarr.json"]
        kind = draw(st.integers(0, 2))
        if kind == 0 and descriptions:
            path = draw(st.sampled_from(descriptions))
            try:
                spoil_json(path, draw)
            except ValueError:  # spoilt before
                spoil_bytes(path, draw)
        elif kind == 1:
            spoil_bytes(draw(st.sampled_from(files)), draw)
        else:
            spoil_tree(draw(st.sampled_from(files)), store, draw)


def tried(folder: Path, capsys: pytest.CaptureFixture[str], data: st.DataObject) -> None:
    """Every command on a damaged store."""
    place, case = folder / "s.zarr", sweep_file(folder)
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(kept(), place)
    damaged(place, data.draw)
    commands = [["data", "check", str(place)], ["data", "info", str(place)], ["show", str(place)]]
    commands.append(["sweep", str(case), "--out", str(place), "--resume"])
    commands.append(["data", "check", str(place)])
    for command in commands:
        code = main(command)
        printed = capsys.readouterr()
        assert code in CODES, printed.err
        assert "\x1b" not in printed.out + printed.err
    if code == 0:  # what is found to be whole is what was written, but for what a sample cost, which no checksum covers
        assert_same(kept(), place, without=COST)
    with suppress(TactsimError):
        load(place).load()


@QUICK
@given(data=st.data())
def test_random_damage_ends_in_words(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory, capsys: pytest.CaptureFixture[str]
) -> None:
    tried(tmp_path_factory.mktemp("fuzz"), capsys, data)


@pytest.mark.slow
@LONG
@given(data=st.data())
def test_much_random_damage_ends_in_words(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory, capsys: pytest.CaptureFixture[str]
) -> None:
    tried(tmp_path_factory.mktemp("fuzz"), capsys, data)
