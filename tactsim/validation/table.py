"""A table of the thesis, or of published problems, as data: rows with place, number and ending. Closed and frozen."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from tactsim.model import FrozenModel
from tactsim.units import parse_quantity
from tactsim.validation.calls import AnyCall, Call
from tactsim.validation.endings import (
    REPEATED,
    Ending,
    NotTestable,
    Origin,
    Regression,
    RegressionBound,
    Reproduced,
    Transcribed,
    label_of,
)
from tactsim.validation.inputs import Inputs
from tactsim.validation.limits import Bound, in_si
from tactsim.validation.study import Study


class Row(FrozenModel):
    """One number of a table."""

    id: str = Field(pattern=r"^[a-z0-9_.]+$")
    """Name within the table."""
    quantity: str = Field(min_length=1)
    """What the number is."""
    place: str = Field(min_length=1)
    """Where it stands, or from which printed numbers the errata derive it."""
    numbers: tuple[Annotated[str, Field(pattern=r"^T[0-9]{3}$")], ...] = ()
    """Numbers of the manifest's list that it answers."""
    expected: str | float | None = None
    """The number with its unit, dimensionless without; a claim that is no number goes without."""
    origin: Origin = Field(alias="from")
    """Where the expected number or the claim comes from."""
    evaluate: Annotated[Call, AnyCall("quantity")] | None = None
    """How it is computed here; what is not testable goes without."""
    ends: Ending
    """How the row is known to end."""
    repeats: str | None = None
    """Row of the same table from which this one follows, so that it is held and shown, but not counted beside it."""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if isinstance(self.ends, NotTestable):
            if self.evaluate is not None:
                raise ValueError("what is evaluated is testable; it ends otherwise")
            return self
        if self.evaluate is None:
            raise ValueError("only what is not testable may lack how it is evaluated")
        if isinstance(self.ends, Bound):
            self.ends.judge(0.0, None, self.unit)
        elif self.expected is None:
            raise ValueError(f"a row that ends as {self.ends.label} needs what is expected")
        _ = self.expected_si, self.allowed
        if self.allowed == 0 and isinstance(self.ends, Reproduced | Regression) and self.ends.within.relative:
            raise ValueError("a relative tolerance of zero is none; give an absolute one")
        if (self.origin == "own") != isinstance(self.ends, Regression | RegressionBound):
            raise ValueError("a number of this program (from: own) ends as a regression, and a regression has no other origin")
        return self

    @property
    def label(self) -> str:
        """The class in which it is counted if it ends as recorded."""
        return REPEATED if self.repeats else label_of(self.ends)

    @property
    def unit(self) -> str:
        """SI unit of what is evaluated; ``1`` if nothing is."""
        return self.evaluate.result_unit if self.evaluate else "1"

    @property
    def shown_unit(self) -> str:
        """The unit in which the row is shown: that of what is expected, else that of its limit, else SI."""
        limit = (self.ends.above if self.ends.above is not None else self.ends.below) if isinstance(self.ends, Bound) else None
        given = self.expected if isinstance(self.expected, str) else limit
        return given.strip().partition(" ")[2].strip() if isinstance(given, str) else self.unit

    @property
    def expected_si(self) -> float | None:
        """The expected number in SI."""
        return None if self.expected is None or self.evaluate is None else in_si(self.expected, self.unit)

    @property
    def allowed(self) -> float | None:
        """Largest difference in SI of a number that must come out."""
        if not isinstance(self.ends, Reproduced | Regression | Transcribed) or self.expected_si is None:
            return None
        within = self.ends.allowance if isinstance(self.ends, Transcribed) else self.ends.within
        return within.allowed(self.expected_si, self.unit)

    def shown(self, value: float) -> float:
        """A number in SI in `shown_unit`."""
        return value if self.unit == "1" else value / parse_quantity(f"1 {self.shown_unit}", self.unit)


class Picture(FrozenModel):
    """A figure of a table, and what it belongs to."""

    says: str = Field(min_length=1)
    """What the source says of it, or what it adds to the rows; a sentence without its full stop."""
    rows: tuple[str, ...] = Field(min_length=1)
    """Rows that it belongs to, below the last of which it stands; ``*`` stands for any part of a name."""
    draw: Annotated[Call, AnyCall("drawing")]
    """How it is drawn."""

    @property
    def title(self) -> str:
        """What is drawn."""
        return str(getattr(self.draw, "title", self.draw.kind))

    def shows(self, row: str) -> bool:
        """Whether it belongs to the row of this name."""
        return any(fnmatchcase(row, pattern) for pattern in self.rows)

    def __call__(self, inputs: Inputs) -> Any:
        """Its plain data.

        Raises
        ------
        TactsimError
            If it cannot be computed.
        """
        return self.draw(inputs)


class Table(FrozenModel):
    """A table or figure of the thesis."""

    schema_version: Literal["tactsim/thesis-table/2"] = Field(alias="schema")
    """Version of the format."""
    title: str = Field(min_length=1)
    """What the table shows."""
    chapter: int | str
    """Chapter of the thesis, or the group of tables that it belongs to."""
    source: str = Field(min_length=1)
    """Where the table stands."""
    studies: tuple[Study, ...] = ()
    """Simulations that its rows rest on."""
    rows: tuple[Row, ...] = Field(min_length=1)
    """The numbers."""
    figures: dict[str, Picture] = {}
    """File name without suffix -> figure."""

    @model_validator(mode="after")
    def _named_once(self) -> Self:
        for what, names in (("rows", [row.id for row in self.rows]), ("studies", [study.name for study in self.studies])):
            repeated = {name for name in names if names.count(name) > 1}
            if repeated:
                raise ValueError(f"{what} with the same name: {', '.join(sorted(repeated))}")
        return self

    @model_validator(mode="after")
    def _repeated_once(self) -> Self:
        counted = {row.id for row in self.rows if row.repeats is None}
        for row in self.rows:
            if row.repeats is not None and row.repeats not in counted:
                raise ValueError(f"the row {row.id} repeats {row.repeats}, which is no row that counts")
        return self

    @model_validator(mode="after")
    def _beside_rows(self) -> Self:
        for name, picture in self.figures.items():
            if strange := [each for each in picture.rows if not any(fnmatchcase(row.id, each) for row in self.rows)]:
                raise ValueError(f"the figure {name} belongs to rows that are not there: {', '.join(strange)}")
        return self


class Manifest(FrozenModel):
    """How many rows each table must have, so that none passes by being absent, and which numbers need one."""

    schema_version: Literal["tactsim/thesis-manifest/2"] = Field(alias="schema")
    """Version of the format."""
    chapters: dict[str, dict[str, int]]
    """Chapter -> table -> number of rows."""
    numbers: dict[str, str] = {}
    """Number of the thesis, like T001 -> what it is; each needs a row that names it."""
    errata: dict[str, str] = {}
    """Erratum, like E1 -> what is printed and what it should be."""

    @property
    def tables(self) -> dict[str, tuple[str, int]]:
        """Table -> its chapter and number of rows."""
        return {name: (chapter, rows) for chapter, tables in self.chapters.items() for name, rows in tables.items()}
