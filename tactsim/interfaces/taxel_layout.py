"""Where the taxels of a jaw lie."""

from __future__ import annotations

from typing import Annotated, Literal, Self, get_args

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.model import FrozenModel
from tactsim.units import Length, Positive, format_quantity

JawName = Literal["upper", "lower"]
JAWS: tuple[str, ...] = get_args(JawName)
"""Names of the jaws of a grasp, in the order of the first axis of every array of forces or readings."""
OUTWARD = {"upper": 1.0, "lower": -1.0}
"""Direction along z from the tissue to each jaw."""


class TaxelLayout(FrozenModel):
    """A matrix of rectangular force sensors on a jaw, centred on it.

    Row 1 is nearest the front (smallest y), column 1 has the smallest x.

    >>> import tactsim as ts
    >>> layout = ts.TaxelLayout(rows=3, columns=3, pitch="10 mm", size="9 mm")
    >>> f"{1e3 * layout.extent()[0]:.0f} mm"  # from border to border
    '29 mm'

    Source: thesis, section 6.3 and Fig. 6.3: 3 x 3 elements per jaw; pitch and size are not printed, they are assumptions.
    """

    rows: Annotated[int, Field(ge=1, le=256)] = 3
    """Number of taxels along y."""
    columns: Annotated[int, Field(ge=1, le=256)] = 3
    """Number of taxels along x."""
    pitch: Positive[Length] = 10e-3
    """Distance between the centres of neighbours."""
    size: Positive[Length] = 9e-3
    """Side of a taxel; the rest of the pitch is a gap."""

    @model_validator(mode="after")
    def _apart(self) -> Self:
        if self.size > self.pitch * (1 + 1e-12):
            raise ValueError(
                f"taxels of {self.given('size')} overlap at a pitch of {self.given('pitch')}; size must be at most the pitch"
            )
        return self

    def given(self, name: str) -> str:
        """A length in words, and whether it is the default."""
        length = format_quantity(getattr(self, name), "m")
        return length if name in self.model_fields_set else f"{length} (the default)"

    @property
    def in_words(self) -> str:
        """All of it, such as ``3 x 3 taxels of 9 mm at a pitch of 10 mm``: rows, then columns."""
        size, pitch = format_quantity(self.size, "m"), format_quantity(self.pitch, "m")
        return f"{self.rows} x {self.columns} taxels of {size} at a pitch of {pitch}"

    @property
    def area(self) -> float:
        """Area of a taxel in m^2."""
        return self.size**2

    def borders(self, along: str) -> Array:
        """Lower and upper border in m of every column (``along`` "x") or row ("y"), from the middle of the jaw, shape (n, 2)."""
        count = self.columns if along == "x" else self.rows
        edges, half_gap = self.pitch * (np.arange(count + 1) - count / 2), (self.pitch - self.size) / 2
        return np.stack([edges[:-1] + half_gap, edges[1:] - half_gap], axis=1)  # those that touch share it to the last bit

    def extent(self) -> tuple[float, float]:
        """Width along x and depth along y of the whole matrix in m."""
        return tuple(float(self.borders(along).max() - self.borders(along).min()) for along in "xy")  # type: ignore[return-value]
