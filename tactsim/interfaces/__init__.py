"""The extension points on one page: a concrete subclass is registered by its ``kind``, wherever it is defined."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, Self, TypeVar, final

import numpy as np

from tactsim.interfaces.run import Course, Progress, run_experiment
from tactsim.interfaces.seeds import seeds_in
from tactsim.kind import Kind as Kind
from tactsim.registry import MarkedFunction, mark
from tactsim.relaxation import Relaxation
from tactsim.results.result import Result

Array = np.ndarray
Function = TypeVar("Function", bound=Callable[..., Any])


class CaseKind(Kind):
    """What a case file names by its ``kind``."""

    @classmethod
    @abstractmethod
    def example(cls) -> Self:
        """A valid instance with values from its source; the contract tests start from it."""


class Material(CaseKind):
    """A constitutive law at a point: isochoric stress plus a pressure that answers the volume change.

    Fields carry components first: ``F`` has shape ``(3, 3, ...)``, ``pressure`` the trailing shape. The volume constraint is
    ``volume_change(F) - pressure / bulk_modulus = 0``, tension positive; a bulk modulus of None means exactly incompressible.
    """

    package: ClassVar[str] = "tactsim.materials"
    bulk_modulus: float | None
    relaxation: Relaxation | None = None
    """Relaxation of the isochoric stress; null means elastic."""

    @property
    @abstractmethod
    def shear_modulus(self) -> float:
        """Small-strain shear modulus in Pa."""

    @abstractmethod
    def first_piola_kirchhoff(self, F: Array, pressure: Array) -> Array:
        """First Piola-Kirchhoff stress in Pa, shape ``(3, 3, ...)``."""

    @abstractmethod
    def tangent(self, F: Array, pressure: Array) -> Array:
        """dP/dF at fixed pressure in Pa, shape ``(3, 3, 3, 3, ...)``."""

    @abstractmethod
    def volume_change(self, F: Array) -> Array:
        """Relative change of volume, dimensionless: J - 1 or its linear part."""

    @abstractmethod
    def volume_change_gradient(self, F: Array) -> Array:
        """Derivative of the volume change with respect to F, shape ``(3, 3, ...)``."""


class RigidBody(CaseKind):
    """A rigid body as a signed distance in its own frame: the reference point at the origin, ``d`` coordinates."""

    package: ClassVar[str] = "tactsim.contact"

    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    """Numbers of coordinates it is defined for; 2 means the section of a body of revolution."""

    @abstractmethod
    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance in m (positive outside), unit outward normal and Hessian of the distance at points ``x`` of shape (d, n).

        Shapes ``(n,)``, ``(d, n)`` and ``(d, d, n)``.
        """


class ContactLaw(CaseKind):
    """Tangential traction between tissue and a rigid body."""

    package: ClassVar[str] = "tactsim.contact"

    @abstractmethod
    def traction_limit(self, pressure: Array) -> Array:
        """Largest tangential traction in Pa that the contact pressure in Pa sustains."""

    @abstractmethod
    def traction_limit_slope(self, pressure: Array) -> Array:
        """Derivative of the limit with respect to the pressure, dimensionless."""


class Sensor(CaseKind):
    """Turns a history of forces into readings."""

    package: ClassVar[str] = "tactsim.sensors"

    @abstractmethod
    def read(self, time: Array, force: Array) -> Array:
        """Readings at the times in s for forces in N of shape ``(time, ...)``."""


class Experiment(CaseKind):
    """What a case can ask for: receives its parts, computes step by step, says what it found.

    A kind gives `begin`; how a run is timed, limited, ended and made a result is decided here, once for all kinds::

        class Squeeze(Experiment):
            kind: Literal["squeeze"] = "squeeze"
            closings: tuple[Length, ...]
            history_units: ClassVar[dict[str, str]] = {"closing": "m", "force": "N"}

            def begin(self) -> Course:
                record = SqueezeRecord(self)
                return Course((record.accept(closing) for closing in self.closings), record.findings)

    ``accept`` computes a step and returns its `StepRecord`; ``findings`` returns the `Findings` of all steps accepted until then.
    """

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.(?!figures$|recorder$|scene$)\w+"

    history_units: ClassVar[dict[str, str]] = {}
    """Unit of every value that an accepted step records."""

    def seeds(self) -> dict[str, int]:
        """Every seed of random numbers by its key path, such as ``readout.seed``; empty if nothing is random."""
        return dict(seeds_in(self))

    @abstractmethod
    def begin(self) -> Course:
        """What computes the steps and knows what they found; what is made before the first step, such as a mesh, is made here.

        Raises
        ------
        InputError
            If something that the experiment names, such as a file, cannot be used.
        Unfinished
            If it cannot begin: there is nothing to keep yet.
        """

    @final
    def run(self, progress: Progress | None = None, *, time_limit: float | None = None) -> Result:
        """Run to the end, calling ``progress`` after each accepted step.

        A run that does not converge, lacks memory, takes longer than ``time_limit`` in s (None: as long as it needs) or is
        interrupted returns a result with that status, the reason, and what was accepted.

        Raises
        ------
        InputError
            If something that the experiment names, such as a file, cannot be used.
        Unfinished
            If it ended before its first step was begun: there is nothing to keep.
        """
        return run_experiment(self, progress, time_limit)


def quantity(*, unit: str | Callable[..., str], check: Callable[..., None] | None = None) -> Callable[[Function], Function]:
    """Marks a function as a number that rows of a thesis table compare, wherever it is defined.

    ::

        @quantity(unit="Pa")
        def initial_modulus(material: str) -> float: ...

    A row asks for it with ``evaluate: {kind: initial_modulus, material: icf_printed}``. The type of an argument sets its unit and
    bounds; its description stands there or under ``Parameters``. A parameter ``inputs: Inputs`` receives the outcomes of the
    table's studies. ``unit`` and ``check`` are those of `MarkedFunction`.
    """

    def marked(function: Function) -> Function:
        mark(MarkedFunction("quantity", function, unit, check))
        return function

    return marked


def drawing(function: Function) -> Function:
    """Marks a function, as `quantity` does, as one that returns the plain data of a figure of a thesis table."""
    mark(MarkedFunction("drawing", function))
    return function
