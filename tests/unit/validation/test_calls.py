"""Calls of marked functions: arguments, units and descriptions are those of the signature."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from pydantic import ValidationError

from tactsim.errors import CaseError, InputError, InvalidQuantity
from tactsim.marked_functions import MarkedFunction
from tactsim.units import Length, Positive
from tactsim.validation.calls import call_class, descriptions
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.elastomers import elastomer_value


def ordered(shorter: Positive[Length], longer: Length = 2e-3) -> float:
    """Longer less shorter in m.

    Parameters
    ----------
    shorter, longer : two lengths,
        in this order

    Raises
    ------
    ValueError
        shorter : never
    """
    return longer - shorter


def called(function: Callable[..., Any], **others: Any) -> type:
    return call_class(MarkedFunction("quantity", function, **{"unit": "m", **others}))


def test_a_call_holds_si_values_and_computes_with_them() -> None:
    call = called(ordered).model_validate({"kind": "ordered", "shorter": "0.5 mm"}, context={"units": "required"})
    assert call.model_dump() == {"kind": "ordered", "shorter": 0.5e-3, "longer": 2e-3}
    assert call(Inputs()) == pytest.approx(1.5e-3, rel=1e-12)  # round-off of a difference


@pytest.mark.parametrize("wrong", [{"shorter": "0 mm"}, {"shorter": "1 kg"}, {}, {"shorter": "1 mm", "length": "1 mm"}])
def test_what_the_signature_does_not_allow_is_refused(wrong: dict[str, str]) -> None:
    with pytest.raises(ValidationError):
        called(ordered).model_validate(wrong)


def test_arguments_are_described_by_the_docstring() -> None:
    assert descriptions(ordered) == {"shorter": "two lengths, in this order", "longer": "two lengths, in this order"}
    assert called(ordered).model_fields["longer"].description == "two lengths, in this order"
    assert called(elastomer_value).model_fields["study"].description == "Study of the table.", "from the type of the argument"


def test_a_unit_may_depend_on_the_arguments() -> None:
    call = called(elastomer_value, unit=lambda quantity: "Pa" if quantity == "modulus" else "1")
    arguments = {"study": "s", "run": "a", "shape": 1, "elastomer": 1}
    assert [call(**arguments, **more).result_unit for more in ({}, {"quantity": "modulus"})] == ["1", "Pa"]


def test_arguments_that_do_not_go_together_are_refused_when_they_are_read() -> None:
    def check(shorter: float, longer: float) -> None:
        if shorter > longer:
            raise InvalidQuantity("shorter is longer")

    call = called(ordered, check=check)
    assert call(shorter=1e-3)(Inputs()) == pytest.approx(1e-3, rel=1e-12)
    with pytest.raises(CaseError, match="shorter is longer"):
        call(shorter=3e-3)


def untyped(length) -> float:
    return length


def positional(length: float, /) -> float:
    return length


def several(*length: float) -> float:
    return len(length)


def reserved(kind: str) -> float:
    return len(kind)


@pytest.mark.parametrize(
    ("function", "name"), [(untyped, "length"), (positional, "length"), (several, "length"), (reserved, "kind")]
)
def test_a_signature_that_no_table_can_write_is_refused(function: Callable[..., float], name: str) -> None:
    with pytest.raises(InputError, match=rf"quantity {function.__name__} of .*test_calls.* the argument {name}; it needs"):
        called(function)
