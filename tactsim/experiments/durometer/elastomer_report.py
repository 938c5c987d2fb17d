"""What a ranking of elastomers reports: moduli, predicted readings, rank correlations and the sizes of the disagreements."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy

from tactsim.analytic.atrial import table_4_1
from tactsim.analytic.durometer import DurometerScale, hertz_modulus, hertz_reading
from tactsim.errors import InputError, InvalidQuantity
from tactsim.experiments.durometer.elastomers import Elastomer, Shape
from tactsim.experiments.durometer.force_depth_curve import ForceDepthCurve
from tactsim.experiments.durometer.scene import ElastomerRankingScene
from tactsim.interfaces.run import Findings
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord

TIMES = (1e-6, 1e6)
"""Times in s between which the one is sought at which the modulus of the atrium is that of the reading."""


@dataclass(frozen=True)
class ShapeFinding:
    """Results of the two simulations of a shape."""

    shape: Shape
    youngs_modulus: float
    """Small-strain Young's modulus in Pa that was simulated."""
    threshold_pressure: float
    """In Pa, at that modulus."""
    threshold_displacement: float
    """In m, at any modulus."""
    curve: ForceDepthCurve
    """Force over depth of the durometer."""
    cut_short: str
    """Why the durometer ended before its whole travel, if it did."""

    def modulus_of_threshold(self, pressure: float) -> float:
        """Young's modulus in Pa whose threshold pressure in Pa this is."""
        return self.youngs_modulus * pressure / self.threshold_pressure

    def modulus_of_reading(self, reading: float, scale: DurometerScale) -> float | None:
        """Young's modulus in Pa that the reading means; None where the curve does not go so deep."""
        try:
            return self.curve.modulus(reading, scale)
        except InvalidQuantity:
            return None

    def reading(self, youngs_modulus: float, scale: DurometerScale) -> float | None:
        """Predicted reading at a Young's modulus in Pa, 0 where the indentor bottoms out; None where the curve was cut short."""
        try:
            return self.curve.reading(youngs_modulus, scale) or 0.0
        except InputError:
            return None


class RankingReport:
    """Collects the findings of the shapes and turns them into a result."""

    UNITS: ClassVar[dict[str, str]] = {
        "shape": "1",
        "elastomer": "1",
        "printed_reading": "1",
        "predicted_reading": "1",
        "bottoms_out": "1",
        "modulus_of_threshold": "Pa",
        "modulus_of_reading": "Pa",
        "modulus_by_hertz": "Pa",
        "modulus_ratio": "1",
        "threshold_pressure": "Pa",
        "threshold_of_reading": "Pa",
    }

    def __init__(self, elastomers: Sequence[Elastomer], scale: DurometerScale, radius: float):
        self._elastomers, self._scale, self._radius = tuple(elastomers), scale, radius
        self._finished: list[ShapeFinding] = []
        self._steps: list[StepRecord] = []
        self._atrium: dict[str, Quantity] = {}

    def add(self, finding: ShapeFinding) -> Iterator[StepRecord]:
        """One step for every elastomer with this shape, numbered from 1; a value that cannot be had is absent.

        All are kept before the first is yielded, so that an interruption leaves no half of a shape.
        """
        self._finished.append(finding)
        before = len(self._steps)
        for number, elastomer in enumerate(self._elastomers, 1):
            values: dict[str, float | None] = {"shape": float(len(self._finished)), "elastomer": float(number)}
            values |= self._compared(finding, elastomer)
            known = {name: value for name, value in values.items() if value is not None}
            self._steps.append(StepRecord(before + number, 0, 0.0, known))
        yield from self._steps[before:]

    def _compared(self, finding: ShapeFinding, elastomer: Elastomer) -> dict[str, float | None]:
        """What sensor and durometer say of an elastomer, in SI."""
        by_sensor = finding.modulus_of_threshold(elastomer.threshold_pressure)
        predicted = finding.reading(by_sensor, self._scale)
        by_durometer = finding.modulus_of_reading(elastomer.durometer, self._scale)
        ratio = None if by_durometer is None else by_durometer / by_sensor
        return {
            "printed_reading": elastomer.durometer,
            "predicted_reading": predicted,
            "bottoms_out": float(predicted == 0.0),
            "modulus_of_threshold": by_sensor,
            "modulus_of_reading": by_durometer,
            "modulus_by_hertz": hertz_modulus(elastomer.durometer, self._scale, self._radius),
            "modulus_ratio": ratio,
            "threshold_pressure": elastomer.threshold_pressure,
            "threshold_of_reading": None if ratio is None else ratio * elastomer.threshold_pressure,
        }

    def add_atrium(self, reading: float, times: Sequence[float], shape: int) -> None:
        """What a reading on porcine atrium means under a shape, counted from 0, and what Table 4.1 reads at times in s.

        Raises
        ------
        InvalidQuantity
            If the reading is not in [0, 100).
        """
        compliance, finding = table_4_1(), self._finished[shape]
        moduli = {
            "instantaneous": 1 / compliance.glassy_compliance,
            **{f"{time:g} s": 1 / float(compliance.creep(time)) for time in times},
            "relaxed": 1 / compliance.equilibrium_compliance,
        }
        meant, hertz = finding.modulus_of_reading(reading, self._scale), hertz_modulus(reading, self._scale, self._radius)
        predicted = [finding.reading(modulus, self._scale) for modulus in moduli.values()]
        by_hertz = [hertz_reading(modulus, self._scale, self._radius) or 0.0 for modulus in moduli.values()]
        at, name = ", ".join(moduli), finding.shape.name
        self._atrium = {
            "atrium_modulus": Quantity(meant, "Pa", f"Young's modulus that {reading:g} means, {name}"),
            "atrium_modulus_by_hertz": Quantity(hertz, "Pa", f"Young's modulus that {reading:g} means by Hertz"),
            "atrium_time": Quantity(None if meant is None else _moment(meant), "s", "time at which Table 4.1 has that modulus"),
            "atrium_time_by_hertz": Quantity(_moment(hertz), "s", "time at which Table 4.1 has the modulus by Hertz"),
            "atrium_reading_instantaneous": Quantity(predicted[0], "1", "reading of the instantaneous modulus of Table 4.1"),
            "atrium_reading_relaxed": Quantity(
                predicted[-1], "1", "reading of the relaxed modulus of Table 4.1; 0 is off the scale"
            ),
            "atrium_table_modulus": Quantity([*moduli.values()], "Pa", f"Young's modulus of Table 4.1 [time]: {at}"),
            "atrium_reading": Quantity(predicted, "1", f"reading of Table 4.1, {name} [time]: {at}; 0 is off the scale"),
            "atrium_reading_by_hertz": Quantity(by_hertz, "1", f"reading of Table 4.1 by Hertz [time]: {at}; 0 is off the scale"),
        }

    def _column(self, shape: int, name: str) -> list[float | None]:
        """A history value of every elastomer under one shape, counted from 0."""
        count = len(self._elastomers)
        return [step.values.get(name) for step in self._steps[shape * count : (shape + 1) * count]]

    def _rank_correlations(self) -> dict[str, Quantity]:
        """Spearman's coefficients between the measurements, and between each prediction and the durometer."""
        measured = {
            "durometer": [one.durometer for one in self._elastomers],
            "hand": [one.hand for one in self._elastomers],
            "sensor": [one.threshold_pressure for one in self._elastomers],
        }
        correlations = {}
        for first, second in (("durometer", "hand"), ("durometer", "sensor"), ("hand", "sensor")):
            words = f"Spearman's rank correlation of {first} and {second}, as printed"
            correlations[f"spearman_{first}_{second}"] = Quantity(_spearman(measured[first], measured[second]), "1", words)
        for name, values in measured.items():
            words = f"Spearman's rank correlation of the predicted reading and the {name}"
            coefficients = [_spearman(self._readings(shape), values) for shape in range(len(self._finished))]
            correlations[f"spearman_predicted_{name}"] = Quantity(coefficients, "1", f"{words} [shape]")
            known = [value for value in coefficients if value is not None]
            if known:
                correlations[f"smallest_spearman_predicted_{name}"] = Quantity(
                    min(known), "1", f"{words}, the smallest of all shapes"
                )
        return correlations

    def _readings(self, shape: int) -> list[float]:
        """Predicted readings, 0 for those that are not known."""
        return [value or 0.0 for value in self._column(shape, "predicted_reading")]

    def _quantities(self) -> dict[str, Quantity]:
        shapes = range(len(self._finished))
        printed = np.array([one.durometer for one in self._elastomers])
        differences = [(np.array(self._readings(shape)) - printed).tolist() for shape in shapes]
        columns = {
            "predicted_reading": ("1", "predicted reading [shape, elastomer]; 0 is off the scale"),
            "modulus_of_threshold": ("Pa", "Young's modulus from the threshold pressure [shape, elastomer]"),
            "modulus_of_reading": ("Pa", "Young's modulus from the printed reading [shape, elastomer]"),
            "modulus_ratio": ("1", "modulus from the printed reading over that from the threshold [shape, elastomer]"),
        }
        quantities = self._rank_correlations()
        quantities |= {name: Quantity([self._column(s, name) for s in shapes], *words) for name, words in columns.items()}
        words = "predicted minus printed reading [shape, elastomer]"
        quantities["reading_difference"] = Quantity(differences, "1", words)
        pressures = [one.threshold_pressure for one in self._finished]
        readings = [one.reading(one.youngs_modulus, self._scale) for one in self._finished]
        words = "threshold pressure by the constants of each [shape]"
        quantities["own_threshold_pressure"] = Quantity(pressures, "Pa", words)
        words = "reading by the constants of each [shape]; 0 is off the scale"
        quantities["own_reading"] = Quantity(readings, "1", words)
        return quantities | self._atrium

    def _warnings(self) -> list[str]:
        warnings = [f"{one.shape.name}: the durometer ended early, {one.cut_short}" for one in self._finished if one.cut_short]
        for shape, finding in enumerate(self._finished):
            off = self._column(shape, "bottoms_out")
            lost = [one.name for one, value in zip(self._elastomers, off, strict=True) if value]
            if lost:
                warnings.append(f"{finding.shape.name}: the durometer bottoms out on {', '.join(lost)}; they share the rank of 0")
        return warnings

    def findings(self, assumptions: Sequence[str]) -> Findings:
        """What every shape that was finished says."""
        return Findings(
            f"{len(self._elastomers)} elastomers by {len(self._finished)} shapes of energy",
            self._steps,
            quantities=self._quantities() if self._finished else {},
            assumptions=assumptions,
            warnings=self._warnings(),
            units=self.UNITS,
            scene=self._scene(),
        )

    def _scene(self) -> ElastomerRankingScene:
        return ElastomerRankingScene(
            elastomers=tuple(self._elastomers),
            shapes=tuple(one.shape for one in self._finished),
            threshold_displacement=tuple(one.threshold_displacement for one in self._finished),
        )


def _spearman(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Spearman's rank correlation; None if one of them ranks nothing."""
    if len(set(first)) < 2 or len(set(second)) < 2:
        return None
    return float(scipy.stats.spearmanr(first, second).statistic)


def _moment(modulus: float) -> float | None:
    """Time in s at which the creep modulus of Table 4.1 has fallen to a modulus in Pa; None if it never is that."""
    compliance = table_4_1()

    def surplus(logarithm: float) -> float:
        return float(compliance.creep(10.0**logarithm)) * modulus - 1

    low, high = (float(np.log10(time)) for time in TIMES)
    return float(10.0 ** scipy.optimize.brentq(surplus, low, high, xtol=1e-12)) if surplus(low) < 0 < surplus(high) else None
