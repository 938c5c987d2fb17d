"""The pages that are made from the code, and the check of a built site's links."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

import tactsim as ts
from tactsim.cli.entry import COMMANDS
from tactsim.interfaces import Experiment
from tactsim.registry import kinds

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture
def made(monkeypatch):
    """A module of the documentation's extensions by its name."""
    monkeypatch.syspath_prepend(DOCS / "extensions")
    monkeypatch.syspath_prepend(DOCS.parent / "scripts")
    return importlib.import_module


def test_every_kind_of_experiment_has_a_page_with_keys_units_and_defaults(made):
    pages = made("case_pages").case_pages()
    assert set(kinds(Experiment)) <= {Path(place).stem for place in pages}
    assert "| `displacement` | `m` | required |" in pages["case/indentation.md"]
    assert '| `inner_radius` | `m`, > 0 | `"1.5 mm"` | Radius of the hole. |' in pages["case/bodies.md"]


def test_the_page_of_case_files_lists_every_kind_once(made):
    shown = re.sub(r"(?s)```{toctree}\n[^`]*:hidden:.*?```", "", made("case_pages").case_pages()["case/index.md"])
    lines = [line for line in shown.splitlines() if "indentation_3d" in line]
    assert len(lines) == 1, "in the table; the list beside the page has it, too"
    assert "materials" in shown


def test_every_command_has_a_page_with_its_options(made):
    pages = made("command_pages").command_pages()
    assert {f"commands/{command.NAME}.md" for command in COMMANDS} < set(pages)
    assert "`--time-limit TIME`" in pages["commands/run.md"]


def test_every_room_has_a_page(made):
    module_pages = made("module_pages")
    inside = [path for path in (DOCS.parent / "tactsim").iterdir() if not path.name.startswith("_")]
    rooms = {path.stem for path in inside if path.is_dir() or path.suffix == ".py"}
    assert set(module_pages.rooms_upwards()) == rooms
    assert module_pages.rooms_upwards()[-1] == "cli"


def test_every_public_name_has_its_line_and_its_docstring_in_one_group(made):
    pages = made("name_pages")
    text = pages.name_pages()["python.rst"]
    for name in ts.__all__:
        assert len(re.findall(rf"^   \* - :ref:`{name} <\w+-{name}>`$", text, re.M)) == 1
        assert len(re.findall(rf"^\.\. auto(?:class|exception|function):: tactsim\.{name}$", text, re.M)) == 1
        assert f"\n{name}\n{'~' * len(name)}\n" in text
    of_groups = {
        "load_data": "Data sets",
        "Grasp": "Experiments",
        "Block": "Parts of an experiment",
        "kinds": "Kinds of your own",
    }
    assert {name: pages.group_of(name) for name in of_groups} == of_groups


def test_every_row_of_a_thesis_table_is_on_its_page(made):
    text = made("validation_pages").validation_pages()["validation.inc"]
    assert "Young's modulus of B1-A at small strain" in text
    assert "reproduced after [E4](/theory/errata.md#e4), [E18](/theory/errata.md#e18)" in text


def test_short_entries_of_a_docstring_become_descriptions(made):
    pytest.importorskip("sphinx", reason="the documentation's packages are not installed")
    docstrings = made("docstrings")
    lines = ["Parameters", "----------", "radius : of the ball in m", "ratio : float", "    b / a", "", "Source: Hertz 1881."]
    docstrings._prepare(None, "function", "f", None, None, lines)
    assert lines[2:6] == ["radius", "    of the ball in m", "ratio : float", "    b / a"]
    assert lines[-3:] == ["", "", "Source: Hertz 1881."]


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ("10.1016/0045-7825(85)90033-7.", "10.1016/0045-7825(85)90033-7"),
        ("10.1137/060671061).", "10.1137/060671061"),
        ("10.1098/rsta.1948.0024", "10.1098/rsta.1948.0024"),
    ],
)
def test_an_identifier_ends_before_the_sentence_does(made, found, expected):
    pytest.importorskip("sphinx", reason="the documentation's packages are not installed")
    assert made("doi_links").identifier(found) == expected


SITE = {
    "index.html": '<a href="other.html#place">there</a> <a href="https://example.org/">outside</a>',
    "other.html": '<p id="place"></p><img src="_static/a.png">',
    "_static/a.png": "",
}


@pytest.mark.parametrize(
    ("place", "text", "told"),
    [
        ("index.html", '<a href="gone.html">x</a>', "gone.html does not exist"),
        ("index.html", '<a href="other.html#gone">x</a>', "has no such anchor"),
        ("index.html", '<script src="https://cdn.example.org/a.js"></script>', "from elsewhere"),
        ("other.html", '<p id="place"></p><img src="gone.png">', "gone.png does not exist"),
    ],
)
def test_a_broken_link_is_found(made, tmp_path, place, text, told):
    (tmp_path / "_static").mkdir()
    for name, content in SITE.items():
        (tmp_path / name).write_text(content)
    faults = made("check_links").faults
    assert list(faults(tmp_path)) == []
    (tmp_path / place).write_text(text)
    found = list(faults(tmp_path))
    assert len(found) == 1
    assert told in found[0]
