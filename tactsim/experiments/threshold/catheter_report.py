"""What the sensors of a tip report: thresholds, the hardest one, and how often it is the wrong one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from tactsim.analytic.viscoelastic_annulus import SMALL_DISPLACEMENT
from tactsim.array import Array
from tactsim.experiments.threshold.catheter_case import CatheterCase
from tactsim.experiments.threshold.sampling import Trials, valid_deviation, valid_mean
from tactsim.experiments.threshold.scene import CatheterTipScene
from tactsim.experiments.threshold.tip_contact import TipContact
from tactsim.interfaces.readings import RESOLUTION
from tactsim.interfaces.run import Findings
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.outcome.plausibility import oddities
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord
from tactsim.units import format_quantity

SENSOR_UNITS = {
    "sensor": "1",
    "angle": "rad",
    "x": "m",
    "y": "m",
    "lag": "m",
    "threshold_force": "N",
    "threshold_pressure": "Pa",
    "threshold_lowest": "Pa",
    "threshold_highest": "Pa",
    "reported_force": "N",
    "reported_pressure": "Pa",
    "reported_deviation": "Pa",
    "valid_rate": "1",
}
SAME = 1e-9
"""Relative difference below which two tissues are equally hard."""
ASKED = 4
"""Sensors that the thesis asks for at least."""


@dataclass(frozen=True)
class Reading:
    """What one sensor reported in every trial, arrays (trials,)."""

    lag: float
    """Displacement of the tip in m at which its face touches."""
    state: str
    """``no contact``, ``threshold not reached`` or ``measured``."""
    force: Array
    """Reported threshold force (trials,) in N; meaningless where not ``valid`` (trials,)."""
    valid: Array

    @classmethod
    def nothing(cls, lag: float, trials: int) -> Self:
        """A sensor that does not touch."""
        return cls(lag, "no contact", np.zeros(trials), np.zeros(trials, bool))

    @classmethod
    def of_trials(cls, lag: float, sampled: Trials, *, reached: bool, trials: int) -> Self:
        """From its trials and the ``lag`` in m; without noise those of the sampling phases are repeated."""
        force = np.resize(sampled.true_force + sampled.error, trials)
        state = "measured" if reached else "threshold not reached"
        return cls(lag, state, force, np.resize(sampled.valid, trials))

    @property
    def mean(self) -> float | None:
        """Mean reported force in N, None without a valid one."""
        return valid_mean(self.force, self.valid)

    @property
    def deviation(self) -> float | None:
        """Standard deviation of the reported force in N, None for fewer than two valid ones."""
        return valid_deviation(self.force, self.valid)


class CatheterReport:
    """Collects the sensors in their order around the tip."""

    def __init__(self, experiment: CatheterCase):
        self._experiment = experiment
        ring = experiment.ring
        self._area = ring.area
        self._shares = experiment.surface.shares(ring, experiment.place)
        self._readings: list[Reading] = []
        self._met: list[TipContact] = []
        self._steps: list[StepRecord] = []

    def add(self, reading: Reading, met: TipContact) -> StepRecord:
        """The next sensor, with what it would measure without errors."""
        index, contact = len(self._readings), met.contact
        self._met.append(met)
        self._readings.append(reading)
        ring, mean, deviation = self._experiment.ring, reading.mean, reading.deviation
        x, y = ring.positions[index] + np.array(self._experiment.place)
        values = {
            "sensor": float(index + 1),
            "angle": float(ring.angles[index]),
            "x": float(x),
            "y": float(y),
            "lag": reading.lag,
            "threshold_force": contact.force,
            "threshold_pressure": contact.force / self._area,
            "threshold_lowest": contact.force / self._area * (1 + met.low),
            "threshold_highest": contact.force / self._area * (1 + met.high),
            "valid_rate": float(reading.valid.mean()),
        }
        if mean is not None:
            values |= {"reported_force": mean, "reported_pressure": mean / self._area}
        if deviation is not None:
            values["reported_deviation"] = deviation / self._area
        self._steps.append(StepRecord(index + 1, 0, 0.0, values))
        return self._steps[-1]

    def findings(self) -> Findings:
        """What the sensors read so far say; the hardest only if all are."""
        complete = len(self._readings) == self._experiment.ring.count
        return Findings(
            f"touched {self._experiment.trials} times",
            self._steps,
            quantities={**self._sensors(), **(self._hardest() if complete else {})},
            assumptions=self._assumptions(),
            warnings=(*self._warnings(), *(self._undecided() if complete else ())),
            units=SENSOR_UNITS,
            scene=self._scene(),
        )

    def _sensors(self) -> dict[str, Quantity]:
        """Arrays over the sensors."""
        columns = {
            "threshold_force": ("N", "true threshold force of the tissue below [sensor]"),
            "threshold_pressure": ("Pa", "true threshold pressure of the tissue below [sensor]"),
            "threshold_lowest": ("Pa", "least threshold pressure within the error of the model [sensor]"),
            "threshold_highest": ("Pa", "largest threshold pressure within the error of the model [sensor]"),
            "reported_force": ("N", "mean reported threshold force [sensor]; null where none"),
            "reported_pressure": ("Pa", "mean reported threshold pressure [sensor]; null where none"),
            "reported_deviation": ("Pa", "standard deviation of the reported threshold pressure [sensor]"),
            "valid_rate": ("1", "part of the trials with a valid threshold [sensor]"),
            "angle": ("rad", "angle of the sensor around the tip [sensor]"),
        }
        quantities = {
            name: Quantity([step.values.get(name) for step in self._steps], unit, words)
            for name, (unit, words) in columns.items()
        }
        shares = self._shares.tolist()
        return quantities | {
            "tissue_share": Quantity(shares, "1", "part of the disc below that each tissue has [sensor, tissue]")
        }

    def _hardest(self) -> dict[str, Quantity]:
        """The hardest sensor by the mean reports, its margin, and the chances over the trials."""
        means = self._means
        wrong, elsewhere, undecided = self._chances()
        quantities = {
            "chance_of_wrong": Quantity(wrong, "1", "part of the trials in which another sensor than the hardest is found"),
            "chance_of_wrong_tissue": Quantity(elsewhere, "1", "part of the trials in which it lies mostly on another tissue"),
            "chance_of_no_answer": Quantity(undecided, "1", "part of the trials without any threshold"),
        }
        if not np.isfinite(means).any():
            return quantities
        best = int(means.argmax())
        others = np.delete(means, best)
        second = float(others.max())
        angle = float(self._experiment.ring.angles[best])
        quantities["hardest_sensor"] = Quantity(best + 1, "1", "sensor with the highest mean reported threshold, counted from 1")
        quantities["hardest_angle"] = Quantity(angle, "rad", "its angle around the tip")
        candidates = self._candidates(means, best)
        quantities["possible_hardest"] = Quantity(
            candidates, "1", "sensors that may be the hardest within the noise and the errors that they do not share"
        )
        if np.isfinite(second):
            margin = float(means[best]) - second
            quantities["margin"] = Quantity(margin, "Pa", "its threshold pressure above that of the second")
            quantities["margin_relative"] = Quantity(margin / float(means[best]), "1", "margin over its threshold pressure")
        return quantities

    @property
    def _means(self) -> Array:
        """Mean reported pressure in Pa of each sensor, minus infinity without any."""
        return np.array([-np.inf if r.mean is None else r.mean for r in self._readings]) / self._area

    def _candidates(self, means: Array, best: int) -> list[int]:
        """Numbers of the sensors whose mean report may be the highest: within the model's own errors and twice the noise's."""
        own = np.array([met.own for met in self._met])
        deviations = np.array([reading.deviation or 0.0 for reading in self._readings]) / self._area
        width = own * np.where(np.isfinite(means), means, 0.0) + 2 * deviations
        return [k + 1 for k in range(len(means)) if means[k] + width[k] >= means[best] - width[best]]

    def _undecided(self) -> Iterator[str]:
        """A warning if more than one sensor may be the hardest."""
        means = self._means
        if np.isfinite(means).any() and len(candidates := self._candidates(means, int(means.argmax()))) > 1:
            finer = ", or set model: {kind: fem}" if self._experiment.model.kind == "closed_form" else ""
            yield (
                f"within noise and the errors that they do not share any of the sensors {', '.join(map(str, candidates))} may be "
                f"the hardest; move the tip or lower the noise{finer}"
            )

    def _chances(self) -> tuple[float, float, float]:
        """Part of the trials with a wrong sensor, with one mostly on a wrong tissue, and with no answer."""
        true = np.array([met.contact.force for met in self._met])
        right = true >= true.max() * (1 - SAME)
        force = np.array([np.where(r.valid, r.force, -np.inf) for r in self._readings])
        answered = np.isfinite(force).any(axis=0)
        hardest, tissue = force.argmax(axis=0), self._shares.argmax(axis=1)
        wrong = answered & ~right[hardest]
        elsewhere = answered & ~np.isin(tissue[hardest], tissue[right])
        return float(wrong.mean()), float(elsewhere.mean()), float((~answered).mean())

    def _scene(self) -> CatheterTipScene:
        experiment = self._experiment
        return CatheterTipScene(
            tissues=tuple(tissue.name for tissue in experiment.surface.tissues),
            borders=experiment.surface.borders,
            ring=experiment.ring,
            place=experiment.place,
            state=tuple(reading.state for reading in self._readings),
            straddles=tuple(bool(share.max() < 1) for share in self._shares),
            area=self._area,
        )

    def _assumptions(self) -> Iterator[str]:
        tissues = (
            f"{t.name}: {format_quantity(t.shear_modulus, 'Pa')} in shear, {format_quantity(t.thickness, 'm')} thick, {t.base}"
            for t in self._experiment.surface.tissues
        )
        yield f"tissues declared in the case, not in the thesis: {'; '.join(tissues)}"
        yield "sizes of tip and sensors declared; 7.3 prints none"
        experiment = self._experiment
        yield from experiment.model.assumptions(experiment.ring.recess / experiment.ring.outer_radius)
        yield "the face of a tilted sensor is taken as flat on the tissue: the tilt only delays its touch"

    def _oddities(self) -> Iterator[str]:
        """What looks like a wrong unit, and a tip that stands on one tissue alone."""
        experiment, ring = self._experiment, self._experiment.ring
        tissues = experiment.surface.tissues
        materials = {f"tissue {one.name}": NeoHookean(c10=one.shear_modulus / 2) for one in tissues}
        lengths = {"ring.outer_radius": ring.outer_radius, "ring.inner_radius": ring.inner_radius}
        yield from oddities(materials, tissue={f"tissue {one.name}": one.thickness for one in tissues}, bodies=lengths)
        alone = np.flatnonzero((self._shares == 1).all(axis=0))
        for tissue in alone.tolist():
            yield f"every sensor stands on the {tissues[tissue].name}: no other tissue can be found; move place, or see borders"

    def _warnings(self) -> Iterator[str]:
        for index, reading in enumerate(self._readings, 1):
            if reading.state != "measured":
                yield f"sensor {index}: {reading.state}"
            elif not reading.valid.all():
                count = np.count_nonzero(~reading.valid)
                yield (
                    f"sensor {index}: {count} of {reading.valid.size} touches report no usable threshold: "
                    "no trigger, one before the touch, or a saturated converter; change trigger, noise or range"
                )
        straddling = [str(index + 1) for index, share in enumerate(self._shares) if share.max() < 1]
        if straddling:
            yield f"sensors over two tissues: {', '.join(straddling)}; their thresholds are mixed"
        low = [met.contact.force for met in self._met if met.contact.force < RESOLUTION]
        if low:
            least, resolved = format_quantity(min(low), "N"), format_quantity(RESOLUTION, "N")
            yield f"{len(low)} thresholds, {least} at least, are below the resolution of {resolved} of 3.1.2 (erratum E27)"
        if self._experiment.ring.count < ASKED:
            yield f"{self._experiment.ring.count} sensors around the tip; the thesis asks for at least {ASKED} (7.3)"
        yield from self._oddities()
        if self._experiment.model.kind != "closed_form":
            return
        deepest = max((met.contact.displacement for met in self._met), default=0.0) / self._experiment.ring.outer_radius
        if deepest > SMALL_DISPLACEMENT:
            limit = f"linear theory is meant for up to {SMALL_DISPLACEMENT:g}"
            yield f"a threshold lies at a displacement of up to {deepest:.3g} of the outer radius; {limit}"
