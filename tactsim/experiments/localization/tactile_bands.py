"""What a user's own arrays of sensors read, drawn as the thesis draws them: bands of grey levels, and the section between two."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.errors import CaseError, InvalidQuantity
from tactsim.experiments.localization.scene import BandsScene
from tactsim.identification.columns import read_columns
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.localization.bands import Form, band_image, band_intensities
from tactsim.localization.section_image import depth_share, section_image
from tactsim.localization.views import SHAPE
from tactsim.model import FrozenModel
from tactsim.outside.input_path import InputPath
from tactsim.results.quantity import Quantity
from tactsim.results.result import rows
from tactsim.units import Force, Positive, format_quantity

MOST_ELEMENTS = 4096
"""Elements of an array: the picture and the result hold each of them."""
Forces = Annotated[tuple[Force, ...], Field(min_length=2, max_length=MOST_ELEMENTS)]


class GivenReadings(FrozenModel):
    """Readings that stand in the case."""

    kind: Literal["given"] = "given"
    upper: Forces
    """Force on each element of the array, or of the upper one, from left to right."""
    lower: Forces | None = None
    """The same of the lower array, which faces the upper; null if there is one array only."""

    @model_validator(mode="after")
    def _facing(self) -> Self:
        if self.lower is not None and len(self.lower) != len(self.upper):
            raise ValueError(f"{len(self.upper)} upper and {len(self.lower)} lower elements; needed: as many of both")
        return self

    def arrays(self) -> tuple[Array, Array | None]:
        """Forces in N on the elements (n,) of the upper, and of the lower array."""
        return np.array(self.upper), None if self.lower is None else np.array(self.lower)


class MeasuredReadings(FrozenModel):
    """Readings of a file, a row for each element from left to right."""

    kind: Literal["file"] = "file"
    path: InputPath
    """CSV file, beside the case or in the working folder, with the columns ``upper [N]`` and, of two arrays, ``lower [N]``."""

    def arrays(self) -> tuple[Array, Array | None]:
        """Forces in N on the elements (n,) of the upper, and of the lower array.

        Raises
        ------
        StorageError
            If the file cannot be read.
        InvalidQuantity
            If a column is unknown, ``upper`` is missing, a row is wrong, or there are too few or too many rows.
        """
        columns = read_columns(self.path, dict.fromkeys(JAWS, "N"))
        if "upper" not in columns:
            raise InvalidQuantity("the readings have no column upper [N]; needed: upper [N] and, of two arrays, lower [N]")
        if not 2 <= columns["upper"].size <= MOST_ELEMENTS:
            raise InvalidQuantity(f"{columns['upper'].size} elements; allowed: from 2 to {MOST_ELEMENTS}")
        return columns["upper"], columns.get("lower")


class TactileBands(Experiment):
    """Bands of the readings of one array, or of two with the section between them; thesis, Appendix .1 and .2.

    ::

        experiment:
          kind: tactile_bands
          readings: {kind: file, path: readings.csv}

    Negative readings count as none, as a sensor reads a pull.
    """

    kind: Literal["tactile_bands"] = "tactile_bands"
    readings: Annotated[GivenReadings | MeasuredReadings, Field(discriminator="kind")]
    """Where the readings come from."""
    pixels: Annotated[int, Field(ge=2, le=MOST_ELEMENTS)] = SHAPE[1]
    """Pixels N along the arrays, at least one for each element."""
    rows: Annotated[int, Field(ge=2, le=MOST_ELEMENTS)] = SHAPE[0]
    """Rows M of the section between two arrays."""
    normalising: Positive[Force] | None = None
    """Signal alpha of the brightest level; null is the largest reading."""
    form: Form = "corrected"
    """Equations corrected by the errata E12, E13 and E25, or as the thesis prints them."""

    history_units: ClassVar[dict[str, str]] = {"element": "1", "upper": "N", "lower": "N"}

    @classmethod
    def example(cls) -> Self:
        """Seven elements in each of two arrays with a lump near the upper one, as in Fig. 3 of Appendix .2."""
        return cls(readings=GivenReadings(upper=(0.1, 0.2, 0.8, 0.3, 0.1, 0.1, 0.1), lower=(0.1, 0.15, 0.3, 0.2, 0.1, 0.1, 0.1)))

    def begin(self) -> Course:
        """One row for each element.

        Raises
        ------
        StorageError
            If a file of readings cannot be read.
        CaseError
            If it is refused, or there are fewer pixels than elements.
        """
        try:
            upper, lower = self.readings.arrays()
        except InvalidQuantity as error:
            raise CaseError(f"experiment.readings: {error}") from None
        if self.pixels < upper.size:
            raise CaseError(f"experiment.pixels is {self.pixels}; needed: at least one for each of the {upper.size} elements")
        arrays = {"upper": upper} if lower is None else {"upper": upper, "lower": lower}
        units = {name: unit for name, unit in self.history_units.items() if name in ("element", *arrays)}
        alpha = self._normalising(arrays)
        return Course.computed(
            Findings(
                "drawn",
                rows(units, (np.arange(1.0, upper.size + 1), *arrays.values())),
                quantities=self._quantities(arrays, alpha),
                warnings=_warnings(arrays, alpha),
                scene=BandsScene(arrays=tuple(arrays), normalising=alpha),
                units=units,
            )
        )

    def _normalising(self, arrays: dict[str, Array]) -> float:
        """alpha in N; that of arrays without any signal is that of a newton, which leaves them black."""
        largest = max(float(forces.max()) for forces in arrays.values())
        return self.normalising or (largest if largest > 0 else 1.0)

    def _quantities(self, arrays: dict[str, Array], alpha: float) -> dict[str, Quantity]:
        quantities = {"normalising_force": Quantity(alpha, "N", "signal alpha of the brightest level")}
        for name, forces in arrays.items():
            level = band_intensities(band_image(forces, self.pixels, self.form), alpha)
            text = f"of the {name} array, of 255" if len(arrays) > 1 else "of the array, of 255"
            quantities[f"levels_{name}"] = Quantity(band_intensities(forces, alpha).tolist(), "1", f"grey level [element] {text}")
            quantities[f"band_{name}"] = Quantity(level.tolist(), "1", f"grey level [pixel] {text}")
        if len(arrays) == 1:
            return quantities
        above, below = (np.maximum(forces, 0.0) for forces in arrays.values())
        section = section_image(above, below, (self.rows, self.pixels), self.form)
        share = depth_share(above, below, self.form)
        return quantities | {
            "section": Quantity(section.tolist(), "N", "intensity H [row][column] between the arrays, row 1 at the upper"),
            "depth_share": Quantity(
                share.tolist(), "1", "depth over thickness [element] at which a lump is drawn, 0 at the upper array"
            ),
        }


def _warnings(arrays: dict[str, Array], alpha: float) -> list[str]:
    """What the picture does not show of the readings."""
    forces = np.concatenate(list(arrays.values()))
    pulls, beyond = int((forces < 0).sum()), int((forces > alpha).sum())
    warnings = [f"{pulls} negative readings are drawn as none"] if pulls else []
    if not (forces > 0).any():
        warnings.append("no element reads a force: the bands are black")
    if beyond:
        warnings.append(f"readings above {format_quantity(alpha, 'N')}, which are drawn as it: {beyond}")
    return warnings
