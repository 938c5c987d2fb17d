"""The extension point of what a data set keeps of a kind of experiment."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from tactsim.interfaces.recording import ComputedSteps, Recording, Values
from tactsim.interfaces.variable import Variable
from tactsim.kind import Kind
from tactsim.results.result import Result


class Recorder(Kind):
    """The labels and readings that a data set keeps of a kind of experiment: its ``kind`` is that of the experiment."""

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.recorder"
    settings: Recording
    most_inclusions: int = 0
    """Largest number of inclusions that the sweep can draw."""
    quantities: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """Name of a number of the result -> unit and description; stored as they are."""
    optional: ClassVar[tuple[str, ...]] = ()
    """Those of them that a result may lack."""
    noise_seed: ClassVar[tuple[str, ...]] = ()
    """Where such an experiment keeps the seed of its noise; one that keeps none is read with noise of the sweep's own."""
    histories: ClassVar[bool] = False
    """Whether `readings` are stored at several times."""
    reads_force: ClassVar[bool] = False
    """Whether a force is read through the sensor of the sweep."""

    def labels_of(self, experiment: Any) -> list[Variable]:
        """What is known before the experiment is run; sizes as those of this experiment."""
        return []

    def readings_of(self, experiment: Any) -> list[Variable]:
        """What its result holds beside ``quantities``; sizes as those of this experiment."""
        return []

    def steps(self, experiment: Any) -> ComputedSteps | None:
        """How far apart the computed moments of a history may lie, as far as it is known before the experiment is run; None if
        what is stored does not rest on them."""
        return None

    def labels(self, experiment: Any) -> Values:
        """Values of `labels_of`."""
        return {}

    def readings(self, experiment: Any, result: Result, generator: np.random.Generator) -> Values:
        """Values of `readings_of`; the generator makes noise."""
        return {}

    @abstractmethod
    def describe(self) -> str:
        """What is simulated, for the card of the data set."""
