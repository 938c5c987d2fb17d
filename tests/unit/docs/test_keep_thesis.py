"""What is kept of a validation: the tables of a report are renewed, the others stay."""

from __future__ import annotations

import importlib
import json
from pathlib import Path

import pytest
from PIL import Image

EXTENSIONS = Path(__file__).parents[3] / "docs" / "extensions"


@pytest.fixture
def keep(monkeypatch):
    monkeypatch.syspath_prepend(EXTENSIONS)
    return importlib.import_module("keep_thesis").keep


def row(name, computed):
    shown = {"quantity": "q", "place": "p", "from": "thesis", "unit": "N", "expected": 1.0, "ratio": computed, "allowed": "-"}
    return {"id": name, **shown, "computed": computed, "class": "reproduced", "ended": "reproduced", "why": "w", "held": True}


def report(folder, tables, pictures=()):
    """A report with a row in each of its tables; the pictures are of the last of them."""
    described = [{"name": name, "title": "t", "says": "s", "below": "r", "rows": {"reproduced": ["r"]}} for name in pictures]
    content = {
        name: {"title": name, "source": "s", "chapter": 2, "rows": [row("r", computed)], "pictures": described}
        for name, computed in tables.items()
    }
    (folder / "figures").mkdir(parents=True)
    for name in pictures:
        Image.new("RGB", (4, 4), "red").save(folder / "figures" / name)
    path = folder / "validation.json"
    path.write_text(json.dumps({"tactsim": "0", "groups": {"thesis": {"tables": content}}}))
    return path


def test_named_tables_are_renewed_and_the_others_stay(keep, tmp_path):
    kept = tmp_path / "thesis.json"
    keep(report(tmp_path / "all", {"a": 1.0, "b": 2.0}), kept)
    keep(report(tmp_path / "some", {"b": 3.00000004}), kept)
    content = json.loads(kept.read_text())
    assert {name: table["rows"]["r"]["computed"] for name, table in content["tables"].items()} == {"a": 1.0, "b": 3.0}
    assert content["command"][-1].startswith("python docs/extensions/keep_thesis.py")


def test_pictures_of_a_renewed_table_replace_the_earlier_ones(keep, tmp_path):
    kept = tmp_path / "thesis.json"
    keep(report(tmp_path / "a", {"a": 1.0}, ["a_old.png"]), kept)
    keep(report(tmp_path / "b", {"b": 1.0}, ["b_one.png"]), kept)
    keep(report(tmp_path / "again", {"a": 1.0}, ["a_new.png"]), kept)
    assert sorted(path.name for path in (tmp_path / "pictures").iterdir()) == ["a_new.png", "b_one.png"]
    assert [each["name"] for each in json.loads(kept.read_text())["tables"]["a"]["pictures"]] == ["a_new.png"]


def test_a_picture_that_was_not_drawn_is_not_kept(keep, tmp_path):
    path = report(tmp_path / "a", {"a": 1.0}, ["a_old.png"])
    (tmp_path / "a" / "figures" / "a_old.png").unlink()
    keep(path, tmp_path / "thesis.json")
    assert json.loads((tmp_path / "thesis.json").read_text())["tables"]["a"]["pictures"] == []
