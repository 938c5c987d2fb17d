"""Nothing, a lump, two lumps, an artery or two: how often each is taken for which, in grasps that were run before."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.experiments.localization.response_store import stored_response
from tactsim.experiments.localization.source import (
    Source,
    folder_words,
    readings_of,
    stored_grasp,
    true_inclusions,
    with_reference,
)
from tactsim.interfaces import Experiment, Progress
from tactsim.interfaces.readings import ROUNDING_NOISE, Readings
from tactsim.localization.confusion import ConfusionTable, class_of, estimated_class
from tactsim.localization.estimators.any_estimator import AnyEstimator
from tactsim.localization.estimators.hypotheses import CLASSES, HypothesesEstimator
from tactsim.outside.input_path import InputPath
from tactsim.results.result import Quantity, Result, Status, StepRecord
from tactsim.units import Force, format_quantity


class Confusion(Experiment):
    """Estimates of many stored grasps of one tissue, counted by their true and their estimated class.

    Each grasp is read ``draws`` times with seeded Gaussian noise on it and on the reference. For a data set use
    ``tactsim.dataset.confusion``. A grasp whose inclusion has the material of the tissue counts by its shape: leave it out.
    """

    kind: Literal["confusion"] = "confusion"
    grasps: Annotated[tuple[InputPath, ...], Field(min_length=1)]
    """Folders of results of grasps, beside the case or in the working folder; the shapes of their inclusions are the truth."""
    reference: InputPath
    """Folder of the same grasp of plain tissue at the same closing."""
    readings: Source = "taxel_force"
    """Forces of the solution, or what was read through film, electronics and calibration (a grasp with a ``readout``)."""
    noise: Annotated[Force, Field(ge=0)] = ROUNDING_NOISE
    """Standard deviation of a reading; the default is what rounding to the sensor's resolution of 0.1 N (thesis 6.2) does."""
    draws: Annotated[int, Field(ge=1, le=1000)] = 5
    """How often the noise is drawn for each grasp."""
    seed: Annotated[int, Field(ge=0)] = 1
    """Of the noise."""
    estimator: AnyEstimator = HypothesesEstimator()
    """What tells the classes apart."""

    history_units: ClassVar[dict[str, str]] = {"right": "1"}

    @classmethod
    def example(cls) -> Self:
        """One lump and two, wherever they were written."""
        return cls(grasps=("results/grasp_lump_icf", "results/grasp_two_lumps"), reference="results/grasp_plain")

    def run(self, progress: Progress) -> Result:
        """One step per grasp, with the share of its draws that were told right."""
        begin = time.perf_counter()
        readings = self._readings()
        table, steps, probabilities = ConfusionTable(), [], []
        for number, (name, true, one) in enumerate(readings):
            sub, told = ConfusionTable(), []
            for draw in range(self.draws):
                estimate = self.estimator.estimate(self._noisy(one, number, draw))
                for counted in (table, sub):
                    counted.add(true, estimated_class(estimate))
                told.append(estimate.classes)
            probabilities.append({"grasp": name, "true": true, "classes": told})
            steps.append(StepRecord(number + 1, 0, 0.0, {"right": float(sub.share_right or 0.0)}))
            progress(steps[-1])
        return Result(
            kind=self.kind,
            status=Status.CONVERGED,
            reason=f"{int(np.trace(table.counts))} of {table.total} estimates told the class right",
            quantities=table_quantities(table),
            assumptions=(f"noise of a reading {format_quantity(self.noise, 'N')} (one standard deviation), seed {self.seed}",),
            timing={"total": time.perf_counter() - begin},
            steps=tuple(steps),
            units=self.history_units,
            details={"classes": list(CLASSES), "grasps": probabilities, "estimator": self.estimator.kind},
        )

    def _readings(self) -> list[tuple[str, str, Readings]]:
        """Name, true class, and readings with reference and response of every grasp."""
        plain = readings_of(stored_grasp(self.reference), self.readings, noise=self.noise)
        response = stored_response(self.reference) if self.estimator.needs_response else None
        found = []
        for folder in self.grasps:
            stored = stored_grasp(folder)
            kinds = [shape.kind for shape in true_inclusions(stored.details)]
            true = class_of(kinds)
            if true is None:
                raise InputError(
                    f"grasps: {folder_words(folder)} has {', '.join(kinds)}; allowed: at most two lumps, or at most two tubes"
                )
            one = with_reference(readings_of(stored, self.readings, noise=self.noise), plain)
            found.append((folder_words(folder), true, replace(one, response=response)))
        return found

    def _noisy(self, readings: Readings, number: int, draw: int) -> Readings:
        noise = self.noise * np.random.default_rng([self.seed, number, draw]).standard_normal((2, *readings.forces.shape))
        reference = readings.reference
        return replace(readings, forces=readings.forces + noise[0], reference=None if reference is None else reference + noise[1])


def table_quantities(table: ConfusionTable) -> dict[str, Quantity]:
    """The counts, and the shares that were told right."""
    order = ", ".join(CLASSES)
    found = {"confusion": Quantity(table.counts.tolist(), "1", f"estimates by [true class][estimated class]: {order}")}
    if table.share_right is not None:
        found["share_right"] = Quantity(table.share_right, "1", "share of all estimates that told the class right")
        recalls = Quantity(table.recalls, "1", f"share of each true class told right: {order}; null if there is none")
        found["recalls"] = recalls
    return found
