"""Constant forces on a sensor film: strain and signal over force and time."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.experiments.film.scene import FilmTestScene
from tactsim.interfaces import Experiment
from tactsim.interfaces.film_report import FilmReport
from tactsim.interfaces.run import Course, Findings
from tactsim.model import check_increasing
from tactsim.results.quantity import Quantity
from tactsim.results.result import rows
from tactsim.sensors.electronics.charge_amplifier import ChargeAmplifier
from tactsim.sensors.electronics.film_calibration import read_under, slope_and_intercept
from tactsim.sensors.films.any_film import AnyFilm
from tactsim.sensors.films.film import HOLM, Film
from tactsim.units import Force, Time

LEAST_FORCE, LONGEST = 1e-9, 1e12
"""Range in N and s that is far wider than any test and in which no quotient or product leaves the floats."""
PositiveForce = Annotated[Force, Field(ge=LEAST_FORCE, le=HOLM)]
PositiveTime = Annotated[Time, Field(gt=0, le=LONGEST)]


class FilmTest(Experiment):
    """A force suddenly put on a film and held, for each of several forces.

    The signal of the film is reported with what electronics make of it: a resistance, or the voltage of a charge amplifier.

    Source: thesis, sections 2.2 and 2.3, Fig. 2.5, 2.6b, 2.9 and 2.10.
    """

    kind: Literal["film_test"] = "film_test"
    film: AnyFilm = Film()
    """What is pressed."""
    forces: Annotated[tuple[PositiveForce, ...], Field(min_length=3, max_length=1000)] = tuple(float(n) / 4 for n in range(2, 21))
    """Forces, increasing; by default 0.5 to 5 N."""
    times: Annotated[tuple[PositiveTime, ...], Field(min_length=1, max_length=1000)] = (
        *(0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0),
    )
    """Times since the force began, increasing; the immediate answer at 0 s is always reported."""
    reading_time: PositiveTime = 1.0
    """Time since the force began at which the signal is plotted against the force and a line is laid through."""

    amplifier: ChargeAmplifier | None = None
    """What turns the capacitance of a capacitive film into a voltage; null reports the capacitance only."""

    history_units: ClassVar[dict[str, str]] = {
        "force": "N",
        "time": "s",
        "strain": "1",
        "resistance": "ohm",
        "conductance": "S",
        "capacitance": "F",
        "voltage": "V",
    }

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        check_increasing(forces=self.forces, times=self.times)
        return self

    @model_validator(mode="after")
    def _amplified(self) -> Self:
        if self.amplifier is not None and self.film.signal != "capacitance":
            raise ValueError(f"amplifier: {self.film.kind} has no capacitance, for an amplifier to read; leave it out")
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
        signal = self.film.read(times, held)
        shown = {"strain": self.film.strain(times, held), **self._shown(signal)}
        units = {name: self.history_units[name] for name in ("force", "time", *shown)}
        by_force = np.repeat(forces, len(times)), np.tile(times, len(forces)), *(values.T.ravel() for values in shown.values())
        read = read_under(self.film, forces, self.reading_time)
        report = self.film.report(forces, read)
        return Course.computed(
            Findings(
                "all forces held",
                rows(units, by_force),
                quantities={**report.constants, **self._readings(times, signal), **self._at_reading(forces, read, report)},
                assumptions=self.film.assumptions(),
                warnings=self.film.warnings(float(forces.max())),
                scene=FilmTestScene(reading_time=self.reading_time, coefficients=report.coefficients),
                units=units,
            )
        )

    def _shown(self, signal: Array) -> dict[str, Array]:
        """Signals of any shape by name, with what electronics make of them."""
        if self.film.signal == "conductance":
            return {"resistance": 1 / signal, "conductance": signal}
        return {"capacitance": signal} | ({} if self.amplifier is None else {"voltage": self.amplifier.voltage(signal)})

    def _readings(self, times: Array, signal: Array) -> dict[str, Quantity]:
        drift = signal[-1] / signal[0] - 1
        quantities = {
            "forces": Quantity(list(self.forces), "N", "forces that were held [force]"),
            "times": Quantity(times.tolist(), "s", "times since the force began [time]"),
            "drift": Quantity(drift.tolist(), "1", f"growth of the {self.film.signal} from 0 s to the last time [force]"),
        }
        shown = {name: values for name, values in self._shown(signal).items() if name != "conductance"}
        readings = {name: Quantity(v.tolist(), self.history_units[name], f"{name} [time][force]") for name, v in shown.items()}
        return quantities | readings

    def _at_reading(self, forces: Array, read: Array, report: FilmReport) -> dict[str, Quantity]:
        """What is read at the reading time, and the line through it."""
        (slope, intercept), symbol = slope_and_intercept(forces, read), self.film.signal
        errors = (read - intercept) / slope - forces
        quantities = {
            f"reading_{name}": Quantity(values.tolist(), self.history_units[name], f"{name} at the reading time [force]")
            for name, values in self._shown(read).items()
            if name != "conductance"
        }
        quantities |= report.readings
        words = f"m of the least-squares line of the {symbol}, C = m F + n, at the reading time"
        quantities["line_slope"] = Quantity(slope, f"{self.film.unit}/N", words)
        quantities["line_intercept"] = Quantity(intercept, self.film.unit, "n of that line")
        for sign, error in (("positive", errors.max()), ("negative", errors.min())):
            words = f"largest {sign} error of the force that the line reads, over the largest force"
            quantities[f"linearity_{sign}"] = Quantity(float(error / forces[-1]), "1", words)
        return quantities
