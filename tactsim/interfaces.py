"""The extension points on one page: subclass one of these in a new file of its package and it is registered by its ``kind``."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

import numpy as np

from tactsim.relaxation import Relaxation
from tactsim.units import FrozenModel

if TYPE_CHECKING:
    from tactsim.results.result import Result, StepRecord

Array = np.ndarray
Progress = Callable[["StepRecord"], None]


class Kind(FrozenModel, ABC):
    """A registered thing that a case file names by its ``kind``."""

    kind: str

    @classmethod
    @abstractmethod
    def example(cls) -> Self:
        """A valid instance with values from its source; the contract tests start from it."""


class Material(Kind):
    """A constitutive law at a point: isochoric stress plus a pressure that answers the volume change.

    Fields carry components first: ``F`` has shape ``(3, 3, ...)``, ``pressure`` the trailing shape. The volume constraint is
    ``volume_change(F) - pressure / bulk_modulus = 0``, tension positive; a bulk modulus of None means exactly incompressible.
    """

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


class RigidBody(Kind):
    """A rigid body as a signed distance in its own frame: the reference point at the origin, ``d`` coordinates."""

    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    """Numbers of coordinates it is defined for; 2 means the section of a body of revolution."""

    @abstractmethod
    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance in m (positive outside), unit outward normal and Hessian of the distance at points ``x`` of shape (d, n).

        Shapes ``(n,)``, ``(d, n)`` and ``(d, d, n)``.
        """


class ContactLaw(Kind):
    """Tangential traction between tissue and a rigid body."""

    @abstractmethod
    def traction_limit(self, pressure: Array) -> Array:
        """Largest tangential traction in Pa that the contact pressure in Pa sustains."""

    @abstractmethod
    def traction_limit_slope(self, pressure: Array) -> Array:
        """Derivative of the limit with respect to the pressure, dimensionless."""


class Sensor(Kind):
    """Turns a history of forces into readings."""

    @abstractmethod
    def read(self, time: Array, force: Array) -> Array:
        """Readings at the times in s for forces in N of shape ``(time, ...)``."""


class Experiment(Kind):
    """What a case can ask for: receives its parts, returns a result."""

    history_units: ClassVar[dict[str, str]]
    """Unit of every value that an accepted step records."""

    @abstractmethod
    def run(self, progress: Progress) -> Result:
        """Run to the end, calling ``progress`` after each accepted step.

        A run that does not converge or is interrupted returns a result with that status, the reason, and what was accepted.
        """


Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class MarkedFunction:
    """A function that the tables of the thesis call by its name, with arguments that are read from its signature."""

    family: str
    """``quantity`` for the number of a row, ``drawing`` for the data of a figure."""
    function: Callable[..., Any]
    unit: str | Callable[..., str] = "1"
    """SI unit of the number, or a function that returns it from those of the arguments that it names."""
    check: Callable[..., None] | None = None
    """Raises a ValueError if the arguments that it names do not go together; called when a table is read."""

    @property
    def name(self) -> str:
        """What a table writes as ``kind``."""
        return self.function.__name__

    @property
    def module(self) -> str:
        """Where it is defined."""
        return self.function.__module__


MARKED: dict[tuple[str, str, str], MarkedFunction] = {}
"""Every marked function by family, name and module; to define it again in its module replaces it."""


def quantity(*, unit: str | Callable[..., str], check: Callable[..., None] | None = None) -> Callable[[Function], Function]:
    """Marks a function as a number that rows of a thesis table compare, wherever it is defined.

    ::

        @quantity(unit="Pa")
        def initial_modulus(material: str) -> float: ...

    A row asks for it with ``evaluate: {kind: initial_modulus, material: icf_printed}``. The type of an argument sets its unit and
    bounds; its description stands there or under ``Parameters``. A parameter ``inputs: Inputs`` receives the outcomes of the
    table's studies. ``unit`` and ``check`` are those of `MarkedFunction`.
    """

    def mark(function: Function) -> Function:
        return _marked(MarkedFunction("quantity", function, unit, check))

    return mark


def drawing(function: Function) -> Function:
    """Marks a function, as `quantity` does, as one that returns the plain data of a figure of a thesis table."""
    return _marked(MarkedFunction("drawing", function))


def _marked(marked: MarkedFunction) -> Any:
    MARKED[marked.family, marked.name, marked.module] = marked
    return marked.function
