"""Coefficients of a film's creep from tests under constant forces, and their lines over the force."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import evenly_spaced
from tactsim.experiments.film.scene import CreepCurve, FilmCreepScene
from tactsim.identification.film_creep import (
    CoefficientLine,
    CreepFit,
    CreepTest,
    coefficient_lines,
    fit_creep,
    read_creep,
    synthetic_creep,
)
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.model import FrozenModel
from tactsim.outside.input_path import InputPath
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord
from tactsim.sensors.films.composite import CREEP_COEFFICIENTS
from tactsim.sensors.films.composite_library import AnyComposite, named_composite
from tactsim.sensors.response_errors import root_mean_square
from tactsim.units import Area, Force, NonNegative, Positive, Time

MOST_DRAWN = 400
"""Samples of a test that its figure shows."""
UNITS = {"instantaneous": "Pa", "delayed": "Pa", "viscosity": "Pa*s"}


class SyntheticCreep(FrozenModel):
    """Creep made from a composite, as the data of Fig. 2.6a are not printed."""

    kind: Literal["synthetic"] = "synthetic"
    composite: AnyComposite = named_composite("lingstat_literal")
    """Name of a shipped composite, or its numbers."""
    forces: Annotated[tuple[Positive[Force], ...], Field(min_length=3)] = (2.0, 4.0, 6.0, 8.0)
    """Forces of the tests; by default those of the thesis."""
    duration: Positive[Time] = 30.0
    """Length of each test."""
    samples: Annotated[int, Field(ge=6, le=1_000_000)] = 300
    """Number of samples of each test."""
    noise: Annotated[float, Field(ge=0, le=0.2)] = 0.002
    """Standard deviation of the strain over the last strain of the test."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    @property
    def area(self) -> float:
        """Area in m^2 that carries the force."""
        return self.composite.reference_area

    def tests(self) -> list[CreepTest]:
        """The tests."""
        times = np.linspace(0, self.duration, self.samples)
        generator = np.random.default_rng(self.seed)
        return synthetic_creep(self.composite, self.forces, times, noise=self.noise, generator=generator)


class MeasuredCreep(FrozenModel):
    """Creep read from a file."""

    kind: Literal["file"] = "file"
    path: InputPath
    """CSV file, beside the case or in the working folder, with the columns ``time [s], force [N], strain [1]``."""
    area: Positive[Area]
    """Area of the sample that carries the force."""

    def tests(self) -> list[CreepTest]:
        """The tests.

        Raises
        ------
        StorageError
            If the file cannot be read.
        InvalidQuantity
            If a column is missing, a row is wrong or no creep can be fitted to a test, with the file.
        """
        return read_creep(self.path)


class FilmCreep(Experiment):
    """E0, E1 and mu1 of the standard linear solid for each force, and straight lines through them.

    Source: thesis, section 2.3, eq. 2.1.15, Fig. 2.6.
    """

    kind: Literal["film_creep"] = "film_creep"
    data: Annotated[SyntheticCreep | MeasuredCreep, Field(discriminator="kind")] = SyntheticCreep()
    """Where the creep comes from."""
    confidence: Annotated[float, Field(ge=0.5, le=0.999)] = 0.95
    """Of the intervals."""

    history_units: ClassVar[dict[str, str]] = (
        {"force": "N"}
        | {name + suffix: unit for name, unit in UNITS.items() for suffix in ("", "_half_width")}
        | {"strain_rms_error": "1"}
    )

    @classmethod
    def example(cls) -> Self:
        """The forces of the thesis."""
        return cls()

    def begin(self) -> Course:
        """Fit each test, one step each, then the lines."""
        tests, fits = self.data.tests(), list[CreepFit]()
        kept = "the fits made before are kept, the run is incomplete"
        return Course(self._fitted(tests, fits), lambda: self._findings(tests, fits), kept)

    def _fitted(self, tests: list[CreepTest], fits: list[CreepFit]) -> Iterator[StepRecord]:
        """A step for each test, its fit added to ``fits``."""
        for test in tests:
            fits.append(fit_creep(test, self.data.area, confidence=self.confidence))
            yield _step(len(fits), fits[-1])

    def _findings(self, tests: list[CreepTest], fits: list[CreepFit]) -> Findings:
        lines = coefficient_lines(fits, confidence=self.confidence) if len(fits) == len(tests) else {}
        return Findings(
            f"fitted creep at {len(tests)} forces",
            [_step(number, fit) for number, fit in enumerate(fits, 1)],
            quantities=_quantities(lines),
            assumptions=self._assumptions(),
            warnings=self._warnings(fits),
            scene=FilmCreepScene(tests=tuple(map(_curve, tests)), area=self.data.area),
        )

    def _assumptions(self) -> tuple[str, ...]:
        assumptions = [
            "independent errors of the strain of equal size in a test; intervals by linearisation and Student's distribution"
        ]
        if isinstance(self.data, SyntheticCreep):
            assumptions.append(
                f"synthetic creep with {self.data.noise:.3g} relative noise: the data of Fig. 2.6a are not printed"
            )
        return tuple(assumptions)

    def _warnings(self, fits: list[CreepFit]) -> tuple[str, ...]:
        return tuple(
            f"the creep at {fit.force:g} N determines {name} only to {100 * width / value:.0f} %; "
            "record longer or with less noise, and leave out samples from before the load"
            for fit in fits
            for name, value, width in zip(CREEP_COEFFICIENTS, fit.coefficients, fit.half_widths, strict=True)
            if width > 0.2 * value
        )


def _step(number: int, fit: CreepFit) -> StepRecord:
    values: dict[str, float] = {"force": fit.force}
    for k, name in enumerate(CREEP_COEFFICIENTS):
        values |= {name: float(fit.coefficients[k]), f"{name}_half_width": float(fit.half_widths[k])}
    return StepRecord(number, 0, 0.0, values | {"strain_rms_error": root_mean_square(fit.residuals)})


def _quantities(lines: dict[str, CoefficientLine]) -> dict[str, Quantity]:
    quantities = {}
    for name, line in lines.items():
        unit = UNITS[name]
        quantities[f"{name}_slope"] = Quantity(line.slope, f"{unit}/N", f"slope of {name} over the force")
        quantities[f"{name}_intercept"] = Quantity(line.intercept, unit, f"{name} without force")
        quantities[f"{name}_slope_half_width"] = Quantity(
            line.slope_half_width, f"{unit}/N", "half-width of the slope's interval"
        )
        quantities[f"{name}_intercept_half_width"] = Quantity(line.intercept_half_width, unit, "half-width of its interval")
    return quantities


def _curve(test: CreepTest) -> CreepCurve:
    """A test thinned for the figure."""
    kept = evenly_spaced(len(test.time), MOST_DRAWN)
    return CreepCurve(force=test.force, time=test.time[kept].tolist(), strain=test.strain[kept].tolist())
