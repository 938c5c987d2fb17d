"""The evaluators of the simulated Table 3.3, and that a wrong number leaves its row."""

from __future__ import annotations

from pathlib import Path

import pytest

from tactsim.errors import InputError, InvalidQuantity, UnknownName
from tactsim.validation import compare, load_tables
from tactsim.validation.evaluator import Inputs
from tactsim.validation.evaluators.elastomer_value import ElastomerValue
from tactsim.validation.evaluators.hertz_durometer_modulus import HertzDurometerModulus
from tactsim.validation.study import RunOutcome

SHIPPED = Path(__file__).parents[3] / "cases" / "thesis"
HISTORY = {"shape": (1.0, 1.0, 2.0, 2.0), "elastomer": (1.0, 2.0, 1.0, 2.0), "predicted_reading": (28.7, 17.5, 22.9, 12.7)}


def inputs(status="converged"):
    run = RunOutcome(id="a", case_id="a", status=status, reason="it gave up", quantities={}, history=HISTORY, seconds=1)
    return Inputs(studies={"s": (run,)})


def value(shape=2, elastomer=1, **changes):
    return ElastomerValue(**({"study": "s", "run": "a", "shape": shape, "elastomer": elastomer} | changes))


def test_the_value_of_a_shape_and_an_elastomer():
    assert value().found(inputs()) == 22.9
    assert value(1, 2).found(inputs()) == 17.5
    assert value(quantity="modulus_of_reading").found_unit == "Pa"


def test_what_is_not_there_is_told():
    with pytest.raises(InputError, match="no elastomer 3 with a shape 2"):
        value(elastomer=3).found(inputs())
    with pytest.raises(UnknownName, match="did you mean 'predicted_reading'"):
        value(quantity="predicted_readings").found(inputs())
    with pytest.raises(InputError, match="did not converge: it gave up"):
        value().found(inputs("failed"))
    with pytest.raises(InvalidQuantity, match="Shore reading 100"):
        HertzDurometerModulus(reading=100).found(Inputs())


def test_the_rows_of_hertz_hold_and_a_wrong_reading_leaves_them():
    table = load_tables(SHIPPED, ["table_3_3_simulated"]).tables["table_3_3_simulated"]
    rows = tuple(row for row in table.rows if row.id.startswith("hertz."))
    held = compare("a", table.model_copy(update={"rows": rows}), SHIPPED, {}).rows
    assert [row.held for row in held] == [True, True]
    wrong = rows[0].model_copy(update={"evaluate": HertzDurometerModulus(reading=36.6)})  # 1.8 % in the modulus
    (left,) = compare("a", table.model_copy(update={"rows": (wrong,)}), SHIPPED, {}).rows
    assert not left.held
