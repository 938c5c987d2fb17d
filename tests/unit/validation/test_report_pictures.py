"""Pictures stand below the rows that they belong to, with what the source says of them."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from thesis_tables import TABLE, write_tables

from tactsim.errors import CaseError
from tactsim.validation import TableOutcome, Validation, compare, html_report, json_report, load_tables, markdown_report
from tactsim.validation.figures.overview import overview_figure
from tactsim.validation.pictures import parts, placed_pictures

PICTURES = """\
figures:
  beside:
    says: The thesis says that it is soft
    rows: [stiff*, known]
    draw: {kind: band_pictures, title: 'Fig. 1: bands', signals: [0.1, 0.2]}
  last:
    says: The thesis draws nothing
    rows: [supply]
    draw: {kind: band_pictures, title: 'Fig. 2: other bands', signals: [0.1, 0.2]}
"""
FILES = {"small": {"small_beside.png": b"first", "small_last.png": b"second"}}


def validated(folder: Path, text: str = TABLE + PICTURES) -> Validation:
    loaded = load_tables(write_tables(folder, text))
    return Validation(loaded, (compare("small", loaded.tables["small"], folder, {}),))


def outcome(folder: Path) -> TableOutcome:
    (table,) = validated(folder).outcomes
    return table


def test_a_picture_stands_below_the_last_of_its_rows(tmp_path: Path) -> None:
    first, second = placed_pictures(outcome(tmp_path))
    assert (first.below, second.below) == ("known", "supply")
    assert first.rows == {"reproduced": ("stiffness",), "outside": ("known",)}
    assert first.caption == "Fig. 1: bands. The thesis says that it is soft. Here: reproduced: stiffness; outside: known."
    assert parts(["stiffness", "known", "supply"], [first, second]) == [(["stiffness", "known"], [first]), (["supply"], [second])]
    assert parts(["stiffness", "known"], []) == [(["stiffness", "known"], [])]


def test_the_page_has_each_picture_between_rows_with_links_both_ways(tmp_path: Path) -> None:
    page = html_report([validated(tmp_path)], FILES)
    places = [page.index(f'id="{name}"') for name in ("small.stiffness", "small.known", "small_beside.png", "small.supply")]
    assert places == sorted(places)
    assert 'alt="Fig. 1: bands: The thesis says that it is soft"' in page
    assert page.count('<a href="#small_beside.png">picture</a>') == 2
    anchors, links = set(re.findall(r'id="([^"]+)"', page)), set(re.findall(r'href="#([^"]+)"', page))
    assert links <= anchors
    assert {"small.stiffness", "small.known", "small.supply"} <= links


def test_markdown_has_each_picture_between_rows(tmp_path: Path) -> None:
    text = markdown_report([validated(tmp_path)], {"small": list(FILES["small"])})
    places = [text.index(words) for words in ("| known |", "![Fig. 1: bands](figures/small_beside.png)", "| supply |")]
    assert places == sorted(places)
    assert "*Fig. 1: bands. The thesis says that it is soft. Here: reproduced: stiffness; outside: known.*" in text


def test_a_picture_that_was_not_drawn_has_no_place(tmp_path: Path) -> None:
    page = html_report([validated(tmp_path)], {"small": {"small_last.png": b"second"}})
    assert "small_beside" not in page
    assert page.count("<figure") == 1


def test_the_places_are_in_the_record(tmp_path: Path) -> None:
    table = json.loads(json_report([validated(tmp_path)]))["groups"][tmp_path.name]["tables"]["small"]
    assert [(each["name"], each["below"]) for each in table["pictures"]] == [
        ("small_beside.png", "known"),
        ("small_last.png", "supply"),
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rows: [supply]", "rows: [suply]", "the figure last belongs to rows that are not there: suply"),
        ("    says: The thesis draws nothing\n", "", "figures.last.says: missing"),
        ("rows: [supply]", "rows: []", "figures.last.rows"),
    ],
)
def test_a_picture_without_claim_or_row_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(CaseError, match=re.escape(message)):
        validated(tmp_path, TABLE + PICTURES.replace(old, new))


def test_the_overview_has_the_chapters_in_order(tmp_path: Path) -> None:
    rows = list(outcome(tmp_path).rows[:2]) * 2
    rows[3] = replace(rows[3], held=False)
    figure = overview_figure(rows, ["10", "published", "2", "10"], {"reproduced": "b", "outside": "r", "left": "k"})
    _, lower = figure.axes
    assert [label.get_text() for label in lower.get_xticklabels()] == ["chapter 2", "chapter 10", "published"]
    reproduced, outside = figure.axes[0].lines[0], figure.axes[0].lines[1]
    assert [round(x) for x in reproduced.get_xdata()] == [1, 0]  # rows of chapters 10 and 2
    assert [round(x) for x in outside.get_xdata()] == [2]
