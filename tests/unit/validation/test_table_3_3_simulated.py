"""The numbers of Table 3.3, measured and simulated, and that a wrong one leaves its row."""

from __future__ import annotations

import pytest

from tactsim.errors import InputError, InvalidQuantity, UnknownName
from tactsim.shipped import CASES
from tactsim.validation import compare, load_tables
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.elastomers import elastomer_value, hertz_durometer_modulus, ranking_agreement
from tactsim.validation.study import RunOutcome

SHIPPED = CASES / "thesis"
HISTORY = {"shape": (1.0, 1.0, 2.0, 2.0), "elastomer": (1.0, 2.0, 1.0, 2.0), "predicted_reading": (28.7, 17.5, 22.9, 12.7)}


def inputs(status="converged"):
    run = RunOutcome(id="a", case_id="a", status=status, reason="it gave up", quantities={}, history=HISTORY, seconds=1)
    return Inputs(studies={"s": (run,)})


def value(shape=2, elastomer=1, status="converged", **changes):
    return elastomer_value(inputs(status), "s", "a", shape, elastomer, **changes)


def test_the_value_of_a_shape_and_an_elastomer():
    assert value() == 22.9
    assert value(1, 2) == 17.5


def test_what_is_not_there_is_reported():
    with pytest.raises(InputError, match="no elastomer 3 with a shape 2"):
        value(elastomer=3)
    with pytest.raises(UnknownName, match="did you mean 'predicted_reading'"):
        value(quantity="predicted_readings")
    with pytest.raises(InputError, match="did not converge: it gave up"):
        value(status="failed")
    with pytest.raises(InvalidQuantity, match="Shore reading 100"):
        hertz_durometer_modulus(100)


def test_the_rows_of_hertz_hold_and_a_wrong_reading_leaves_them():
    table = load_tables(SHIPPED, ["table_3_3_simulated"]).tables["table_3_3_simulated"]
    rows = tuple(row for row in table.rows if row.id.startswith("hertz."))
    held = compare("a", table.model_copy(update={"rows": rows}), SHIPPED, {}).rows
    assert [row.held for row in held] == [True, True]
    wrong = rows[0].model_copy(update={"evaluate": rows[0].evaluate.model_copy(update={"reading": 36.6})})  # 1.8 % in the modulus
    (left,) = compare("a", table.model_copy(update={"rows": (wrong,)}), SHIPPED, {}).rows
    assert not left.held


def test_a_pair_in_another_order_lowers_the_agreement():
    assert ranking_agreement((1, 2, 3), (10, 30, 20)) == pytest.approx(1 / 3, rel=1e-12)  # by hand: 2 of 3 pairs alike
    assert ranking_agreement((1, 2, 2), (10, 30, 20)) == pytest.approx(2 / 3, rel=1e-12)  # a tie counts nothing
    with pytest.raises(InputError, match="2 numbers cannot be ranked against 3"):
        ranking_agreement((1, 2), (1, 2, 3))
