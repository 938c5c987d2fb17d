"""Every code block of the documentation is executed: a page's blocks in order, those of Python as one program."""

from __future__ import annotations

import ast
import json
import re
import shutil
import tomllib
from itertools import groupby
from pathlib import Path

import pytest
from text_blocks import blocks_of, execute, file_names, provide_command, without_missing

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
MADE = ("_build", "generated", "auto_gallery")
EXECUTED = {"sh", "yaml", "python"}
SHOWN = {"text", "json"}
"""Languages of blocks that show something and cannot be run."""


def pages() -> list[Path]:
    """The written pages; those that are made from the code hold no blocks to be run."""
    return [path for path in sorted(DOCS.rglob("*.md")) if path.relative_to(DOCS).parts[0] not in MADE]


PAGES = [
    path.relative_to(DOCS).as_posix() for path in pages() if EXECUTED & {language for language, _ in blocks_of(path.read_text())}
]


LONG = (
    "start/index.md",
    "start/design.md",
    "guide/run.md",
    "guide/time.md",
    "guide/grasp.md",
    "guide/sensors.md",
    "guide/data_sets.md",
    "start/data.md",
)
"""Pages whose cases take long; `guide/python.md` makes a smaller data set than `start/data.md`, and the first run of
`start/index.md` is that of the README."""


def test_every_block_is_executed_or_shown():
    languages = {language for path in pages() for language, _ in blocks_of(path.read_text(encoding="utf-8"))}
    assert languages <= EXECUTED | SHOWN, "a block is run, or it is marked `text`"
    assert len(PAGES) >= 5


COMMANDS_OR_CASE = re.compile(r"^\s*(?:(?:tactsim|pytest|python|pip|scripts/\w+|\.) |scripts/\w+$|\w+: )", re.M)
"""A line of what a reader might run: a command, or a key of a case."""


def test_what_could_be_run_and_is_not_says_why():
    block = re.compile(r"^(<!-- not run: \S[^\n]* -->\n)?```text\n(.*?)^```", re.M | re.S)
    texts = {path: block.findall(path.read_text(encoding="utf-8")) for path in pages()}
    assert sum(bool(why) for found in texts.values() for why, _ in found) >= 6
    silent = [path.name for path, found in texts.items() for why, text in found if COMMANDS_OR_CASE.search(text) and not why]
    assert silent == []


def test_the_page_of_installation_lists_every_extra_with_its_packages():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    table = dict(re.findall(r"^\| `(\w+)` \| ([^|]+) \|", (DOCS / "start" / "index.md").read_text(encoding="utf-8"), re.M))
    assert set(table) == set(declared)
    for extra, needed in declared.items():
        if extra not in ("all", "docs", "dev"):
            assert table[extra] == ", ".join(re.match(r"[\w.-]+", package)[0] for package in needed)


def test_a_block_that_needs_an_absent_package_is_left_out():
    text = (
        "a\n<!-- needs no_such_package -->\n```python\nimport no_such_package\n```\nb\n<!-- needs json -->\n```python\n1\n```\n"
    )
    assert blocks_of(text) == [("python", "import no_such_package\n"), ("python", "1\n")]
    assert blocks_of(without_missing(text)) == [("python", "1\n")]


@pytest.mark.parametrize("page", [pytest.param(one, marks=pytest.mark.slow) if one in LONG else one for one in PAGES])
def test_blocks_of_a_page(page, tmp_path):
    text = without_missing((DOCS / page).read_text(encoding="utf-8"))
    blocks = blocks_of(text)
    names = file_names(text, blocks)
    if any(language == "sh" for language, _ in blocks):
        shutil.copytree(ROOT / "cases", tmp_path / "cases")
        provide_command(tmp_path)
    shown = [(language, (name, code)) for (language, code), name in zip(blocks, names, strict=True) if language in EXECUTED]
    for language, together in groupby(shown, key=lambda one: one[0]):
        found = [content for _, content in together]
        if language == "yaml":
            for name, code in found:
                (tmp_path / name).write_text(code, encoding="utf-8")
        else:
            execute(language, "\n".join(code for _, code in found), tmp_path)


def test_a_record_names_tests_that_exist():
    records = json.loads((DOCS / "verification" / "records.json").read_text(encoding="utf-8"))["records"]
    assert len(records) > 30
    for row in records:
        place, _, name = row["test"].partition("::")
        assert re.search(rf"^def {name}\(", (ROOT / place).read_text(encoding="utf-8"), re.M), f"{row['test']} is gone"
        assert row["error"] is not None or abs(row["order"] - row["theory"]) <= row["tolerance"]
        assert row["error"] is None or row["tolerance"] is None or row["error"] <= row["tolerance"] * (1 + 1e-9)


ANSWERS_YES_OR_NO = re.compile(r"_(seen|refused|would|not|no)(_|$)")
"""Names of verification tests without a record: a wrong model is seen, something is refused, would fail, or is not so."""


def test_a_verification_test_records_what_it_found_or_says_in_its_name_that_it_answers_yes_or_no():
    silent = []
    for path in sorted((ROOT / "tests" / "verification").glob("test_*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_") and not ANSWERS_YES_OR_NO.search(node.name):
                asked = {argument.arg for argument in [*node.args.args, *node.args.kwonlyargs]}
                silent += [] if "verification_record" in asked else [f"{path.name}: {node.name}"]
    assert not silent, "these record no row: " + ", ".join(silent)
