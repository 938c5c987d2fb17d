"""A table of the thesis as data: rows with their place, number, tolerance and recorded state. Closed and frozen."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Literal, Self

from pydantic import Field, SerializeAsAny, create_model, model_validator

from tactsim.model import FrozenModel
from tactsim.registry import MarkedFunction
from tactsim.units import parse_quantity
from tactsim.validation.calls import Call, any_call, callable_now
from tactsim.validation.study import Study


class Tolerance(FrozenModel):
    """How far the computed number may be from the expected one, and why."""

    relative: float | None = Field(default=None, ge=0, lt=1)
    """Part of the expected number."""
    absolute: str | float | None = None
    """In the unit of the number."""
    reason: str = Field(min_length=1)
    """Why this much and not less."""

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.relative is None) == (self.absolute is None):
            raise ValueError("a tolerance is either relative or absolute")
        return self


class Reproduced(FrozenModel):
    """The number comes out as printed."""

    reproduced: Literal[True]
    """Always true; a number that does not come out has another state."""


class ReproducedAfter(FrozenModel):
    """The number comes out once an erratum is corrected."""

    reproduced_after: str = Field(pattern=r"^E[0-9]+(, E[0-9]+)*$")
    """Number of the erratum, like E4."""


class OutsideBy(FrozenModel):
    """A known deviation: what is computed over what is printed, and the presumed cause."""

    outside_by: float = Field(gt=0)
    """Computed over printed."""
    tolerance: float = Field(gt=0, lt=1)
    """Part of the factor by which it may change before the row counts as left."""
    reason: str = Field(min_length=1)
    """Presumed cause."""

    @model_validator(mode="after")
    def _outside(self) -> Self:
        if abs(self.outside_by - 1) <= self.tolerance * self.outside_by:
            raise ValueError(f"a factor of {self.outside_by:g} within {self.tolerance:g} of itself is no deviation")
        return self


class Bound(FrozenModel):
    """A finding that is no number: which side of a limit the computed number lies on."""

    above: str | float | None = None
    """What it exceeds, in its unit."""
    below: str | float | None = None
    """What it stays under, in its unit."""
    finding: str = Field(min_length=1)
    """What that means, and why the limit is where it is."""

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.above is None) == (self.below is None):
            raise ValueError("a finding lies either above or below a limit")
        return self

    def margin(self, computed: float, unit: str) -> float:
        """How far the computed number, in SI, lies on the right side; negative on the wrong one."""
        if self.above is not None:
            return computed - in_si(self.above, unit)
        return in_si(self.below or 0.0, unit) - computed


class Assumption(FrozenModel):
    """Nothing to compare: the thesis leaves the number out or contradicts itself."""

    assumption: str = Field(min_length=1)
    """What is assumed and why."""


State = Reproduced | ReproducedAfter | OutsideBy | Bound | Assumption


class Row(FrozenModel):
    """One number of a table."""

    id: str = Field(pattern=r"^[a-z0-9_.]+$")
    """Name within the table."""
    quantity: str = Field(min_length=1)
    """What the number is."""
    place: str = Field(min_length=1)
    """Where it stands, or from which printed numbers the errata derive it."""
    printed: str | float | None = None
    """The number with its unit; a plain number is dimensionless. Only an assumption or a finding may do without."""
    evaluate: SerializeAsAny[Call] | None = None
    """How it is computed here. Only an assumption may do without."""
    tolerance: Tolerance | None = None
    """How near it must come; for a row that is reproduced."""
    state: State
    """How the row is known to end."""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if isinstance(self.state, Bound):
            if self.evaluate is None:
                raise ValueError("a finding needs to be evaluated")
            self.state.margin(0.0, self.unit)
        elif not isinstance(self.state, Assumption) and (self.printed is None or self.evaluate is None):
            raise ValueError("only an assumption may lack what is printed or how it is evaluated")
        if isinstance(self.state, Reproduced | ReproducedAfter) != (self.tolerance is not None):
            raise ValueError("a row that is reproduced has a tolerance, any other has none")
        if self.evaluate is not None:
            _ = self.expected, self.allowed
            if self.allowed == 0 and self.tolerance is not None and self.tolerance.relative:
                raise ValueError("a relative tolerance of zero is none; give an absolute one")
        return self

    @property
    def unit(self) -> str:
        """SI unit of what is evaluated; ``1`` if nothing is."""
        return self.evaluate.result_unit if self.evaluate else "1"

    @property
    def expected(self) -> float | None:
        """The printed number in SI."""
        return None if self.printed is None else in_si(self.printed, self.unit)

    @property
    def allowed(self) -> float | None:
        """Largest difference in SI."""
        if self.tolerance is None or self.expected is None:
            return None
        if self.tolerance.relative is not None:
            return self.tolerance.relative * abs(self.expected)
        return in_si(self.tolerance.absolute or 0.0, self.unit)


class Table(FrozenModel):
    """A table or figure of the thesis."""

    schema_version: Literal["tactsim/thesis-table/1"] = Field(alias="schema")
    """Version of the format."""
    title: str = Field(min_length=1)
    """What the table shows."""
    chapter: int = Field(ge=1)
    """Chapter of the thesis."""
    source: str = Field(min_length=1)
    """Where the table stands."""
    studies: tuple[Study, ...] = ()
    """Simulations that its rows rest on."""
    rows: tuple[Row, ...] = Field(min_length=1)
    """The numbers."""
    figures: dict[str, SerializeAsAny[Call]] = {}
    """File name without suffix -> figure."""

    @model_validator(mode="after")
    def _named_once(self) -> Self:
        for what, names in (("rows", [row.id for row in self.rows]), ("studies", [study.name for study in self.studies])):
            repeated = {name for name in names if names.count(name) > 1}
            if repeated:
                raise ValueError(f"{what} with the same name: {', '.join(sorted(repeated))}")
        return self


class Manifest(FrozenModel):
    """How many rows each table must have, so that none passes by being absent."""

    schema_version: Literal["tactsim/thesis-manifest/1"] = Field(alias="schema")
    """Version of the format."""
    chapters: dict[str, dict[str, int]]
    """Chapter -> table -> number of rows."""

    @property
    def tables(self) -> dict[str, tuple[int, int]]:
        """Table -> its chapter and number of rows."""
        return {name: (int(chapter), rows) for chapter, tables in self.chapters.items() for name, rows in tables.items()}


def in_si(value: str | float, unit: str) -> float:
    """A number as a table writes it in SI: text with a unit, or a plain number for what has none.

    Raises
    ------
    ValueError
        If a plain number stands for what has a unit.
    InvalidQuantity
        If the text is no quantity of this unit.
    """
    if isinstance(value, str):
        return parse_quantity(value, unit)
    if unit != "1":
        raise ValueError(f"{value:g} has no unit; expected text such as '{value:g} {unit}'")
    return float(value)


def table_class() -> type[Table]:
    """The table whose rows and figures call any of the functions that are marked now.

    Raises
    ------
    InputError
        If two functions have the same name, or a signature does not say what a table may write.
    """
    return _table_of(callable_now("quantity"), callable_now("drawing"))


@lru_cache(maxsize=2)
def _table_of(quantities: tuple[MarkedFunction, ...], drawings: tuple[MarkedFunction, ...]) -> type[Table]:
    row = create_model("Row", __base__=Row, evaluate=(any_call(quantities) | None, None))
    rows: Any = (tuple[row, ...], Field(min_length=1))
    figures: Any = (dict[str, any_call(drawings)], {})  # type: ignore[misc]
    return create_model("Table", __base__=Table, rows=rows, figures=figures)
