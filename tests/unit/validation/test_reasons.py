"""Reasons of rows: a figure in one is the source's, an input, or filled in by the run; an own result that is typed goes stale."""

from __future__ import annotations

import re
from collections.abc import Iterable

import pytest
from thesis_tables import shipped_names, shipped_tables

from tactsim.validation.comparison import compare_row, reason_of
from tactsim.validation.inputs import Inputs
from tactsim.validation.loading import LoadedTables
from tactsim.validation.table import Row, Table

SIZE = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w]|\.\d)")
"""A number that stands alone; ``B1-A`` and ``2.3.1`` are names."""
NAMES = re.compile(
    r"\{[^}]*\}|doi:\S+|[ET]\d+(?:, E\d+)*|\([A-Z][\w ]+ \d{4}.*?\)|\bgiven to [\d.]+|\(\d, ?\d\)"
    r"|(?:Tables?|Figs?\.|sections?|eqs?\.|chapter|Appendix) \.?[\d.]+\w?(?:(?:,| and| to| or) \.?\d[\d.]*\w?)*"
)
"""What holds digits and is no figure: placeholders, errata, places, references, digits of a printed number."""
BY_HAND = ("by hand", "errata")
"""Words with which a reason gives a figure of somebody who did not use this program."""
OWN = ("why", "reason", "by")
"""Keys of an ending that hold what is judged, or an own number."""
NO_FIGURES = {95.0}
"""The usual confidence of an interval, in per cent."""


def sizes(text: str) -> set[float]:
    """Sizes of the figures in a text."""
    return {abs(float(each)) for each in SIZE.findall(NAMES.sub(" ", text))}


def given(row: Row, table: Table, loaded: LoadedTables) -> set[float]:
    """Sizes that the source gives or the program is given: of the row, of the table's other rows and of the cases."""
    texts = [table.source, *map(str, _leaves(row.ends.model_dump(mode="json")))]
    for other in table.rows:
        texts += [other.quantity, other.place, *(loaded.manifest.numbers[number] for number in other.numbers)]
        texts += [str(other.expected)] if other.origin != "own" else []
    texts += [text for number, text in loaded.manifest.errata.items() if re.search(rf"\b{number}\b", reason_of(row))]
    texts += [(loaded.folder / study.case).read_text(encoding="utf-8") for study in table.studies]
    texts += [study.model_dump_json() for study in table.studies]
    inputs = {abs(leaf) for leaf in _leaves(row.evaluate.model_dump(mode="json") if row.evaluate else {}) if _is_number(leaf)}
    plain = {abs(float(each)) for text in texts for each in SIZE.findall(text)}
    return plain | inputs | NO_FIGURES | {100 * each for each in plain} | {100 * (each - 1) for each in plain}


def _leaves(value: object) -> Iterable[object]:
    if isinstance(value, dict):
        value = [each for key, each in value.items() if key not in OWN]
    if isinstance(value, list | tuple):
        for each in value:
            yield from _leaves(each)
    else:
        yield value


def _is_number(leaf: object) -> bool:
    return isinstance(leaf, int | float) and not isinstance(leaf, bool)


def typed(row: Row, table: Table, loaded: LoadedTables) -> list[float]:
    """Figures of a reason that neither the source nor an input gives."""
    reason = reason_of(row)
    if row.evaluate is None or any(words in reason for words in BY_HAND):
        return []
    known = given(row, table, loaded)
    return sorted(each for each in sizes(reason) if not any(abs(each - other) <= 1e-9 * each for other in known))


@pytest.mark.parametrize(("group", "name"), shipped_names())
def test_no_reason_of_a_computed_row_has_an_own_figure_typed_into_it(group: str, name: str) -> None:
    loaded = shipped_tables(group)
    table = loaded.tables[name]
    stale = {row.id: (figures, reason_of(row)) for row in table.rows if (figures := typed(row, table, loaded))}
    assert stale == {}, "let the run fill them in, {computed}, {ratio} or {another_row}, or point to the row that computes them"


def with_reason(row: Row, why: str) -> Row:
    return row.model_copy(update={"ends": row.ends.model_copy(update={"why": why})})


@pytest.mark.parametrize("why", ["E10: 0.08 mm; the tissue does not touch", "a force 9 times as large", "it costs 0.9 %"])
def test_a_typed_figure_is_noticed(why: str) -> None:
    loaded = shipped_tables("thesis")
    table = loaded.tables["section_4_7"]
    row = next(row for row in table.rows if row.id == "rise")
    assert typed(row, table, loaded) == []
    assert typed(with_reason(row, why), table, loaded) != []
    assert typed(with_reason(row, "E10: {computed} of 0.7 mm at 1 N, as in section 4.7 and eq. 4.2.21"), table, loaded) == []


def test_what_is_not_testable_can_name_the_row_with_the_number() -> None:
    row = next(row for row in shipped_tables("thesis").tables["section_6_6"].rows if row.id == "pulse.icf.above_diastole")
    outcome = compare_row(row, Inputs())
    assert outcome.held
    assert "{pulse.icf.above_diastole_change}" in outcome.reason
