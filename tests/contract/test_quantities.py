"""Every registered number and figure of the thesis tables; a function takes part once it is marked, until it is forgotten."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, get_type_hints

import pytest
from thesis_tables import GROUPS, MANIFEST, TABLE, shipped_tables, write_tables

from tactsim.cli import main
from tactsim.errors import CaseError, InputError, InvalidQuantity
from tactsim.interfaces import drawing, quantity
from tactsim.marked_functions import MarkedFunction, _marked, marked_functions
from tactsim.registry import forget
from tactsim.units import is_unit, parse_quantity
from tactsim.validation import compare, load_tables
from tactsim.validation.calls import INPUTS, PACKAGE, call_class, descriptions
from tactsim.validation.inputs import Inputs
from tactsim.validation.limits import Interval
from tactsim.validation.table import Row, Table

FUNCTIONS = [marked for family in ("quantity", "drawing") for marked in marked_functions(PACKAGE, family).values()]
each = pytest.mark.parametrize("marked", [pytest.param(marked, id=f"{marked.family} {marked.name}") for marked in FUNCTIONS])


@pytest.fixture(scope="module")
def tables() -> list[Table]:
    """All that are shipped."""
    return [table for group in GROUPS for table in shipped_tables(group).tables.values()]


@pytest.fixture(scope="module")
def rows(tables: list[Table]) -> list[Row]:
    """Those that a function computes."""
    return [row for table in tables for row in table.rows if row.evaluate is not None]


@each
def test_the_signature_is_typed_and_every_argument_described(marked: MarkedFunction) -> None:
    types = get_type_hints(marked.function, include_extras=True)
    parameters = inspect.signature(marked.function).parameters
    assert set(types) == {*parameters, "return"}
    assert types["return"] in ((float, Interval) if marked.family == "quantity" else (dict[str, Any],))
    assert types.get(INPUTS, Inputs) is Inputs
    assert (inspect.getdoc(marked.function) or "").partition("\n")[0].strip()
    fields = call_class(marked).model_fields
    assert set(fields) == set(parameters) - {INPUTS} | {"kind"}
    assert [name for name, field in fields.items() if not field.description and name != "kind"] == []
    assert set(descriptions(marked.function)) <= set(fields), "what is described is an argument"


def test_every_function_serves_a_shipped_table(tables: list[Table], rows: list[Row]) -> None:
    used = {row.evaluate.marked for row in rows if row.evaluate}
    used |= {figure.draw.marked for table in tables for figure in table.figures.values()}
    assert [marked.name for marked in FUNCTIONS if marked not in used] == []


def test_units_are_known_and_those_of_the_rows(rows: list[Row]) -> None:
    for row in rows:
        assert row.evaluate is not None
        unit = row.evaluate.result_unit
        assert is_unit(unit), row.id
        if isinstance(row.expected, str):
            assert row.expected_si == parse_quantity(row.expected, unit), row.id
        else:
            assert row.expected is None or unit == "1", f"{row.id}: only a dimensionless number has no unit"


def test_no_function_sees_what_it_is_compared_with() -> None:
    assert [field.name for field in dataclasses.fields(Inputs)] == ["folder", "studies"]


ROW = "kind: stiffness_resolution, force: 0.1 N, displacement: 0.8 mm"
ADDED = '''\
from typing import Any

from tactsim.interfaces import drawing, quantity
from tactsim.units import Length
from tactsim.validation.inputs import Inputs


@quantity(unit="m")
def doubled(length: Length) -> float:
    """Twice a length in m.

    Parameters
    ----------
    length : half of it
    """
    return 2 * length


@drawing
def nothing(inputs: Inputs, title: str) -> dict[str, Any]:
    """A figure without curves.

    Parameters
    ----------
    title : title of the figure
    """
    return {"form": "curves", "title": title, "folder": str(inputs.folder), "panels": []}
'''


def forget_all(module: str) -> None:
    """Takes back every mark of a module and of those below it."""
    for (_, _, place), marked in list(_marked.items()):
        if place.partition(".")[0] == module:
            forget(marked.function)


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., ModuleType]]:
    """Writes a temporary module, or a package of several, and imports it; what it marks is forgotten at the end."""
    monkeypatch.syspath_prepend(tmp_path)
    names: list[str] = []

    def made(name: str, text: str = ADDED, path: str = "") -> ModuleType:
        file = tmp_path / (path or f"{name}.py")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
        names.append(name)
        importlib.invalidate_caches()
        return importlib.import_module(name)

    yield made
    for name in names:
        forget_all(name)
        for loaded in [loaded for loaded in sys.modules if loaded.partition(".")[0] == name]:
            del sys.modules[loaded]


def written(folder: Path, call: str = "kind: doubled, length: 0.5 m", *, figure: str = "") -> Path:
    """A table with a single row of 1 m."""
    text = TABLE.split("  - id: known", maxsplit=1)[0].replace("125 N/m", "1000 mm").replace(ROW, call)
    return write_tables(folder / "tables", text + figure, MANIFEST.replace("small: 3", "small: 1"))


def computed(folder: Path) -> tuple[float | None, bool]:
    (row,) = compare("small", load_tables(folder).tables["small"], folder, {}).rows
    return row.computed, row.held


def test_a_function_of_a_temporary_module_takes_part_until_it_is_forgotten(tmp_path: Path, module: Callable[..., Any]) -> None:
    folder = written(tmp_path, figure='figures:\n  empty: {says: none, rows: ["*"], draw: {kind: nothing, title: none}}\n')
    with pytest.raises(CaseError, match="unknown kind 'doubled'"):
        load_tables(folder)
    added = module("added_numbers")
    assert computed(folder) == (1.0, True)
    figure = load_tables(folder).tables["small"].figures["empty"]
    assert figure(Inputs(folder=folder)) == {"form": "curves", "title": "none", "folder": str(folder), "panels": []}
    assert json.loads(load_tables(folder).tables["small"].rows[0].model_dump_json())["evaluate"] == {
        "kind": "doubled",
        "length": 0.5,
    }
    forget(added.doubled)
    with pytest.raises(CaseError, match=r"small\.yaml:12: rows\.0\.evaluate\.kind: unknown kind 'doubled'"):
        load_tables(folder)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("kind: doubled, lenght: 0.5 m", r"evaluate\.lenght: unknown key \(did you mean 'length'\?\); allowed: kind, length"),
        ("kind: doubled, length: 0.5", r"evaluate\.length: 0\.5 has no unit"),
        ("kind: doubled, length: 5 kg", r"evaluate\.length: '5 kg' has the wrong dimension"),
        ("kind: doubled", r"evaluate\.length: missing; expected a quantity with its unit"),
        ("kind: dubled, length: 0.5 m", r"evaluate\.kind: unknown kind 'dubled' \(did you mean 'doubled'\?\)"),
    ],
)
def test_its_arguments_are_checked_like_any_other(tmp_path: Path, module: Callable[..., Any], call: str, message: str) -> None:
    module("added_numbers")
    with pytest.raises(CaseError, match=rf"small\.yaml:12: rows\.0\.{message}"):
        load_tables(written(tmp_path, call))


def test_a_unit_that_the_row_does_not_have_is_refused(tmp_path: Path, module: Callable[..., Any]) -> None:
    module("added_numbers", ADDED.replace('unit="m"', 'unit="kg"'))
    with pytest.raises(CaseError, match=r"rows\.0: '1000 mm' has the wrong dimension; expected a mass with its unit"):
        load_tables(written(tmp_path))


def test_a_function_of_a_notebook_takes_part_and_may_be_defined_again(tmp_path: Path) -> None:
    folder = written(tmp_path)
    try:
        for factor in (2, 3):

            @quantity(unit="m")
            def doubled(length: float, factor: int = factor) -> float:
                return factor * length

            call = folder / "small.yaml"
            call.write_text(call.read_text().replace("0.5 m", "0.5"))
            assert computed(folder) == (0.5 * factor, factor == 2)
    finally:
        forget(doubled)


def test_two_of_one_name_are_an_error_that_names_both(tmp_path: Path, module: Callable[..., Any], capsys: Any) -> None:
    folder = written(tmp_path)
    module("added_numbers")
    module("more_numbers")
    for family in ("quantity", "drawing"):
        with pytest.raises(InputError, match=rf"mark a {family} '(doubled|nothing)': added_numbers and more_numbers"):
            marked_functions(PACKAGE, family)
    assert main(["validate", "--from", str(folder), "--out", str(tmp_path / "report")]) == InputError.exit_code
    assert "added_numbers and more_numbers" in capsys.readouterr().err
    forget_all("more_numbers")
    assert computed(folder) == (1.0, True)


def test_a_package_is_searched_to_its_depth(module: Callable[..., Any], tmp_path: Path) -> None:
    inner = tmp_path / "numbers_by_topic" / "inner"
    inner.mkdir(parents=True)
    (inner / "__init__.py").touch()
    (inner / "deep.py").write_text(ADDED, encoding="utf-8")
    module("numbers_by_topic", "", "numbers_by_topic/__init__.py")
    assert "numbers_by_topic.inner.deep" not in sys.modules
    assert marked_functions("numbers_by_topic", "quantity")["doubled"].module == "numbers_by_topic.inner.deep"


def test_a_name_serves_one_number_and_one_figure(module: Callable[..., Any]) -> None:
    module("added_numbers")

    @drawing
    def doubled() -> dict[str, Any]:
        return {}

    try:
        assert marked_functions(PACKAGE, "quantity")["doubled"].module == "added_numbers"
        assert marked_functions(PACKAGE, "drawing")["doubled"].function is doubled
    finally:
        forget(doubled)


def test_an_unknown_unit_is_refused_as_the_function_is_marked() -> None:
    with pytest.raises(InvalidQuantity, match="the unit of the quantity doubled: 'parrot' is no unit that is known"):

        @quantity(unit="parrot")
        def doubled(length: float) -> float:
            return 2 * length

    assert "doubled" not in marked_functions(PACKAGE, "quantity")
