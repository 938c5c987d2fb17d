"""Constant forces on a piezoresistive film: strain, resistance and conductance over force and time."""

from __future__ import annotations

import itertools
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.experiments.film.scene import FilmTestScene
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.results.result import Quantity, StepRecord
from tactsim.sensors.film import HOLM, Film
from tactsim.sensors.film_calibration import least_squares_line
from tactsim.sensors.film_report import film_assumptions, film_quantities, film_warnings
from tactsim.units import Force, Time, check_increasing

Array = np.ndarray
LEAST_FORCE, LONGEST = 1e-9, 1e12
"""Range in N and s that is far wider than any test and in which no quotient or product leaves the floats."""
PositiveForce = Annotated[Force, Field(ge=LEAST_FORCE, le=HOLM)]
PositiveTime = Annotated[Time, Field(gt=0, le=LONGEST)]


class FilmTest(Experiment):
    """A force suddenly put on a film and held, for each of several forces.

    Source: thesis, sections 2.2 and 2.3, Fig. 2.5, 2.6b, 2.9 and 2.10.
    """

    kind: Literal["film_test"] = "film_test"
    film: Film = Film()
    """What is pressed."""
    forces: Annotated[tuple[PositiveForce, ...], Field(min_length=3, max_length=1000)] = tuple(float(n) / 4 for n in range(2, 21))
    """Forces, increasing; by default 0.5 to 5 N."""
    times: Annotated[tuple[PositiveTime, ...], Field(min_length=1, max_length=1000)] = (
        *(0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0),
    )
    """Times since the force began, increasing; the immediate answer at 0 s is always told."""
    reading_time: PositiveTime = 1.0
    """Time since the force began at which the force is plotted against the conductance and a line is laid through."""

    history_units: ClassVar[dict[str, str]] = {"force": "N", "time": "s", "strain": "1", "resistance": "ohm", "conductance": "S"}

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        check_increasing(forces=self.forces, times=self.times)
        return self

    @classmethod
    def example(cls) -> Self:
        """The identified Lingstat at three forces."""
        return cls(forces=(1.0, 2.0, 4.0), times=(1.0, 10.0))

    def begin(self) -> Course:
        """One step for every force and time, all times of a force together."""
        times = np.concatenate([[0.0], self.times])
        forces = np.array(self.forces)
        held = np.tile(forces, (len(times), 1))
        conductance, strain = self.film.conductance(times, held), self.film.strain(times, held)
        steps = []
        for number, (j, i) in enumerate(itertools.product(range(len(forces)), range(len(times))), start=1):
            reached = (forces[j], times[i], strain[i, j], 1 / conductance[i, j], conductance[i, j])
            steps.append(StepRecord(number, 0, 0.0, dict(zip(self.history_units, map(float, reached), strict=True))))
        read = self.film.conductance([0.0, self.reading_time], np.tile(forces, (2, 1)))[-1]
        return Course.computed(
            Findings(
                "all forces held",
                steps,
                quantities=film_quantities(self.film) | self._readings(times, conductance) | self._line(forces, read),
                assumptions=film_assumptions(self.film),
                warnings=film_warnings(self.film, float(forces.max())),
                scene=self._scene(forces),
            )
        )

    def _readings(self, times: Array, conductance: Array) -> dict[str, Quantity]:
        drift = conductance[-1] / conductance[0] - 1
        return {
            "forces": Quantity(list(self.forces), "N", "forces that were held"),
            "times": Quantity(times.tolist(), "s", "times since the force began"),
            "resistance": Quantity((1 / conductance).tolist(), "ohm", "resistance [time][force]"),
            "drift": Quantity(drift.tolist(), "1", "growth of the conductance from 0 s to the last time, for each force"),
        }

    def _line(self, forces: Array, read: Array) -> dict[str, Quantity]:
        line = least_squares_line(forces, read)
        errors = line.force(read) - forces
        found = {
            "reading_resistance": Quantity((1 / read).tolist(), "ohm", "resistance at the reading time, for each force"),
            "reading_film_resistance": Quantity(
                (1 / read - self.film.composite.contact_resistance / np.sqrt(forces)).tolist(),
                "ohm",
                "the same without the contacts at the electrodes",
            ),
            "line_slope": Quantity(line.slope, "S/N", "m of the least-squares line C = m F + n at the reading time"),
            "line_intercept": Quantity(line.intercept, "S", "n of that line"),
        }
        for sign, error in (("positive", errors.max()), ("negative", errors.min())):
            words = f"largest {sign} error of the force that the line reads, over the largest force"
            found[f"linearity_{sign}"] = Quantity(float(error / forces[-1]), "1", words)
        return found

    def _scene(self, forces: Array) -> FilmTestScene:
        composite = self.film.composite
        felt = forces * self.film.magnification
        return FilmTestScene(
            reading_time=self.reading_time,
            coefficients={
                "instantaneous": composite.instantaneous.at(felt).tolist(),
                "delayed": composite.delayed.at(felt).tolist(),
                "viscosity": composite.viscosity.at(felt).tolist(),
            },
        )
