"""The format of live frames."""

from __future__ import annotations

import json

import numpy as np
import pytest
from live_pages import description, frame_line, line, taxel_forces

from tactsim.errors import InputError
from tactsim.live.sources.frame_lines import LineSplitter, read_line
from tactsim.live.sources.scene import Frame, PageScene


@pytest.fixture
def scene() -> PageScene:
    found = read_line(line(description(title="hand")), None)
    assert isinstance(found, PageScene)
    return found


def test_a_description_and_a_frame_are_read(scene: PageScene) -> None:
    assert (scene.title, scene.layout.rows, scene.size.tolist()) == ("hand", 3, [40e-3, 40e-3, 20e-3])
    found = read_line(line(frame_line(1.5, closing=1e-3)), scene)
    assert isinstance(found, Frame)
    assert (found.time, found.closing) == (1.5, 1e-3)
    np.testing.assert_allclose(found.forces, taxel_forces(1)[0], rtol=1e-15)
    assert found.valid.all()


def test_lengths_may_have_units() -> None:
    matrix = {"rows": 2, "columns": 3, "pitch": "10 mm", "size": "9 mm"}
    found = read_line(line({**description(), "matrix": matrix, "block_size": ["4 cm", "40 mm", 0.02]}), None)
    assert isinstance(found, PageScene)
    assert (found.layout.pitch, found.size[0]) == (0.01, 0.04)


@pytest.mark.parametrize("nothing", [None, "NaN", "nan", float("nan"), float("inf"), 10**400])
def test_a_taxel_without_a_number_is_dead_and_told(scene: PageScene, nothing: object) -> None:
    content = frame_line()
    content["taxel_force_lower"][1][2] = nothing
    found = read_line(json.dumps(content).encode(), scene)
    assert isinstance(found, Frame)
    assert np.argwhere(~found.valid).tolist() == [[1, 1, 2]]
    assert found.notes() == ("dead or saturated taxels, interpolated from their neighbours: L2,3",)
    assert np.isfinite(found.readings(scene).filled).all()


def test_a_saturated_taxel_is_not_trusted(scene: PageScene) -> None:
    found = read_line(line(frame_line(saturated_upper=[[True, False, False], [False] * 3, [0, 0, 0]])), scene)
    assert isinstance(found, Frame)
    assert np.argwhere(~found.valid).tolist() == [[0, 0, 0]]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"{", "not JSON"),
        (b"\xff\xfe", "not JSON"),
        (b"[" * 100_000, "not JSON"),
        (b"[1]", "is not an object"),
        (line({"time": 1}), "taxel_force_upper: missing; needed: 3 rows of 3 numbers"),
        (line({**frame_line(), "time": None}), "time: missing"),
        (line({**frame_line(), "time": "1 s"}), "time: '1 s'; needed: a finite number"),
        (line({**frame_line(), "taxel_force_lower": [[1, 2, 3]]}), "taxel_force_lower: 1 rows; needed: 3 rows of 3"),
        (line({**frame_line(), "taxel_force_lower": [[1, 2]] * 3}), "taxel_force_lower, row 1: 2 numbers; needed: 3"),
        (line({**frame_line(), "taxel_force_upper": [[1, 2, 3], [1, "x", 2], [1, 2, 3]]}), "row 2, column 2: 'x'; needed"),
        (line({**frame_line(), "taxel_force_upper": [[1, 2, 1e9]] * 3}), "row 1, column 3 is 1e+09 N; allowed: up to 1e+06 N"),
        (
            line({**frame_line(), "taxel_force_upper": [[1, True, 3]] * 3}),
            "taxel_force_upper, row 1, column 2: True; needed: a number",
        ),
        (line({**description(), "block_size": [0.04, 0.04, True]}), "description: block_size.2"),
        (line({**description(), "matrix": {"rows": True, "columns": 3}}), "description: matrix.rows"),
        (line({**frame_line(), "force": 1}), "unknown key 'force'; known: time"),
        (line({**description(), "matrix": {"rows": 0}}), "description: matrix.rows"),
        (line({**description(), "colour": 1}), "description: colour"),
        (line({**description(), "schema": "tactsim/frames/2"}), "description: schema"),
        (line({**description(), "block_size": [0.04, -1, 0.02]}), "description: block_size.1"),
    ],
)
def test_a_malformed_line_says_what_and_where(scene: PageScene, content: bytes, words: str) -> None:
    with pytest.raises(InputError, match=r"^[^\n]+$") as caught:
        read_line(content, scene)
    assert words in str(caught.value)


def test_a_frame_needs_a_description() -> None:
    with pytest.raises(InputError, match='first line needs "schema": "tactsim/frames/1"'):
        read_line(line(frame_line()), None)


def test_lines_are_cut_wherever_chunks_end() -> None:
    whole = b"one\ntwo\r\n\n  \nthree\nrest"
    for size in (1, 2, 5, 100):
        splitter = LineSplitter()
        chunks = [whole[k : k + size] for k in range(0, len(whole), size)]
        found = [part for chunk in chunks for part in splitter.lines(chunk)]
        assert found == [b"one", b"two\r", b"three"]


def test_a_line_without_end_takes_no_memory() -> None:
    splitter = LineSplitter(longest=10)
    for _ in range(1000):
        assert list(splitter.lines(b"x" * 10)) == []
        assert len(splitter._waiting) <= 20
    assert list(splitter.lines(b"x\nnext\n")) == [None, b"next"]
    assert list(splitter.lines(b"y" * 11 + b"\n" + b"z" * 10 + b"\n")) == [None, b"z" * 10]
