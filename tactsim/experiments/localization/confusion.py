"""Nothing, a lump, two lumps, an artery or two: how often each is taken for which, in grasps that were run before."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InputError, InvalidQuantity
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.experiments.localization.response_store import stored_response
from tactsim.experiments.localization.scene import ConfusionScene, JudgedGrasp
from tactsim.experiments.localization.source import (
    folder_words,
    jaw_notes,
    readings_of,
    reference_notes,
    stored_grasp,
    unfinished_notes,
    with_reference,
)
from tactsim.interfaces import Experiment, Inclusion
from tactsim.interfaces.both_jaws import TAXEL_FORCE, Source
from tactsim.interfaces.estimate import Estimate
from tactsim.interfaces.readings import ROUNDING_NOISE, Readings
from tactsim.interfaces.run import Course, Findings
from tactsim.localization.checked_estimate import estimate_of
from tactsim.localization.estimators.any_estimator import AnyEstimator
from tactsim.localization.estimators.hypotheses import CLASSES, HypothesesEstimator
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.outside.input_path import InputPath
from tactsim.registry import kinds
from tactsim.results.quantity import Quantity
from tactsim.results.result import Result, StepRecord
from tactsim.units import Force, NonNegative, format_quantity


class Confusion(Experiment):
    """Estimates of many stored grasps of one tissue, counted by their true and their estimated class.

    Each grasp is read ``draws`` times with seeded Gaussian noise on it and on the reference. For a data set use
    ``tactsim data confusion``. A grasp whose inclusion has the material of the tissue counts by its shape: leave it out.
    """

    kind: Literal["confusion"] = "confusion"
    grasps: Annotated[tuple[InputPath, ...], Field(min_length=1)]
    """Folders of results of grasps, beside the case or in the working folder; the shapes of their inclusions are the truth."""
    reference: InputPath
    """Folder of the same grasp of plain tissue at the same closing."""
    readings: Source = TAXEL_FORCE
    """Forces of the solution, or what was read through film, electronics and calibration (a grasp with a ``readout``)."""
    noise: NonNegative[Force] = ROUNDING_NOISE
    """Standard deviation of a reading; the default is what rounding to the sensor's resolution of 0.1 N (thesis 6.2) does."""
    draws: Annotated[int, Field(ge=1, le=1000)] = 5
    """How often the noise is drawn for each grasp."""
    seed: NonNegative[int] = 1
    """Of the noise."""
    estimator: AnyEstimator = HypothesesEstimator()
    """What distinguishes the classes."""

    history_units: ClassVar[dict[str, str]] = {"right": "1"}

    @classmethod
    def example(cls) -> Self:
        """The shipped results of a grasp with and without a lump, by the estimator that needs no model of the tissue."""
        plain, estimator = "cases/stored/grasp_plain", ThesisEstimator(background="reference")
        return cls(grasps=(plain, "cases/stored/grasp_lump"), reference=plain, noise=1e-3, estimator=estimator)

    def begin(self) -> Course:
        """One step per grasp, with the share of its draws whose class was estimated right.

        Raises
        ------
        StorageError
            If a result is missing or cannot be read.
        InputError
            If one is not that of a grasp with taxels, or has inclusions of no class.
        """
        plain, counted = stored_grasp(self.reference), _Counted()
        stored = [stored_grasp(folder) for folder in self.grasps]
        reference = plain.scene_as(GraspScene)
        doubts = [*unfinished_notes(plain, self.reference), *reference_notes(reference.true_inclusions)]
        for folder, grasp in zip(self.grasps, stored, strict=True):
            doubts += unfinished_notes(grasp, folder)
            doubts += [f"{folder_words(folder)}: {note}" for note in jaw_notes(grasp.scene_as(GraspScene), reference)]
        readings = self._readings(plain, stored)
        return Course(self._estimated(readings, counted), lambda: self._findings(counted, tuple(dict.fromkeys(doubts))))

    def _estimated(self, readings: Sequence[NamedReadings], counted: _Counted) -> Iterator[StepRecord]:
        for number, grasp in enumerate(readings):
            estimates = [estimate_of(self.estimator, self._noisy(grasp.readings, number, draw)) for draw in range(self.draws)]
            alone = ConfusionTable()
            for estimate in estimates:
                for table in (counted.table, alone):
                    table.add(grasp.true, estimated_class(estimate))
            counted.judged.append(JudgedGrasp(grasp=grasp.name, true=grasp.true, classes=tuple(one.classes for one in estimates)))
            counted.steps.append(StepRecord(number + 1, 0, 0.0, {"right": float(alone.share_right or 0.0)}))
            yield counted.steps[-1]

    def _findings(self, counted: _Counted, doubts: tuple[str, ...]) -> Findings:
        table = counted.table
        return Findings(
            f"{int(np.trace(table.counts))} of {table.total} estimates named the right class",
            counted.steps,
            quantities=table_quantities(table),
            assumptions=(f"noise of a reading {format_quantity(self.noise, 'N')} (one standard deviation), seed {self.seed}",),
            warnings=doubts,
            scene=ConfusionScene(classes=CLASSES, grasps=tuple(counted.judged), estimator=self.estimator.kind),
        )

    def _readings(self, reference: Result, grasps: Sequence[Result]) -> list[NamedReadings]:
        """Those of every grasp, with reference and response."""
        plain = readings_of(reference, self.readings, noise=self.noise)
        response = stored_response(self.reference) if self.estimator.needs_response else None
        readings = []
        for folder, stored in zip(self.grasps, grasps, strict=True):
            shapes = [shape.kind for shape in stored.scene_as(GraspScene).true_inclusions]
            true = class_of(shapes)
            if true is None:
                raise InputError(
                    f"grasps: {folder_words(folder)} has {', '.join(shapes)}; allowed: at most two lumps, or at most two tubes"
                )
            one = with_reference(readings_of(stored, self.readings, noise=self.noise), plain)
            readings.append(NamedReadings(folder_words(folder), true, replace(one, response=response)))
        return readings

    def _noisy(self, readings: Readings, number: int, draw: int) -> Readings:
        noise = self.noise * np.random.default_rng([self.seed, number, draw]).standard_normal((2, *readings.forces.shape))
        reference = readings.reference
        return replace(readings, forces=readings.forces + noise[0], reference=None if reference is None else reference + noise[1])


def table_quantities(table: ConfusionTable) -> dict[str, Quantity]:
    """The counts, and the shares that were right."""
    order = ", ".join(CLASSES)
    quantities = {"confusion": Quantity(table.counts.tolist(), "1", f"estimates by [true class][estimated class]: {order}")}
    if table.share_right is not None:
        quantities["share_right"] = Quantity(table.share_right, "1", "share of all estimates that named the right class")
        recalls = Quantity(table.recalls, "1", f"share that was named right [true class]: {order}; null if there is none")
        quantities["recalls"] = recalls
    return quantities


def class_of(shapes: Sequence[str]) -> str | None:
    """Class of inclusions by the kinds of their shapes: a hollow one is an artery, any other a lump.

    None for a lump beside an artery and for more than two.
    """
    known = kinds(Inclusion)
    arteries = sum(shape in known and known[shape].hollow for shape in shapes)
    names = {(0, 0): "none", (1, 0): "lump", (2, 0): "two_lumps", (1, 1): "artery", (2, 2): "two_arteries"}
    return names.get((len(shapes), arteries))


def estimated_class(estimate: Estimate) -> str:
    """The likeliest class; of an estimator without classes, that of what it located, which then counts as a lump."""
    if estimate.classes is not None:
        classes = estimate.classes
        return max(classes, key=lambda name: classes[name])
    return class_of([inclusion.kind for inclusion in estimate.inclusions]) or "lump"


@dataclass
class ConfusionTable:
    """Counts (true, estimated) in the order of ``CLASSES``."""

    counts: Array = field(default_factory=lambda: np.zeros((len(CLASSES),) * 2, int))

    def add(self, true: str, estimated: str) -> None:
        """Count one.

        Raises
        ------
        InvalidQuantity
            If there is no such class.
        """
        for name in (true, estimated):
            if name not in CLASSES:
                raise InvalidQuantity(f"there is no class {name!r}; allowed: {', '.join(CLASSES)}")
        self.counts[CLASSES.index(true), CLASSES.index(estimated)] += 1

    @property
    def total(self) -> int:
        """Number of estimates."""
        return int(self.counts.sum())

    @property
    def share_right(self) -> float | None:
        """Share on the diagonal; None if nothing was counted."""
        return float(np.trace(self.counts) / self.total) if self.total else None

    @property
    def recalls(self) -> list[float | None]:
        """Share of each true class that was named as such; None for a class that does not occur."""
        return [float(row[k] / row.sum()) if row.sum() else None for k, row in enumerate(self.counts)]


@dataclass(frozen=True)
class NamedReadings:
    """Readings of a grasp, its name and the class that it truly is of."""

    name: str
    true: str
    readings: Readings


@dataclass
class _Counted:
    """What was counted of the grasps estimated so far."""

    table: ConfusionTable = field(default_factory=ConfusionTable)
    steps: list[StepRecord] = field(default_factory=list)
    judged: list[JudgedGrasp] = field(default_factory=list)
