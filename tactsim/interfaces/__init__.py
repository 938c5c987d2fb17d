"""The extension points on one page: a concrete subclass is registered by its ``kind``, wherever it is defined."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from inspect import isabstract
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from tactsim.interfaces.seeds import seeds_in
from tactsim.registry import register
from tactsim.relaxation import Relaxation
from tactsim.units import FrozenModel

if TYPE_CHECKING:
    from tactsim.results.result import Result, StepRecord

Array = np.ndarray
Progress = Callable[["StepRecord"], None]


class Kind(FrozenModel, ABC):
    """A base of what is registered by its ``kind``."""

    package: ClassVar[str]
    """Where the kinds of an extension point stand; a subclass that names it is an extension point."""
    modules: ClassVar[str] = ".*"
    """Pattern of the names, within that package, of the modules that define kinds."""
    kind: str

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        super().__pydantic_init_subclass__(**options)
        if "kind" in vars(cls).get("__annotations__", {}) and not isabstract(cls):
            register(cls)


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
    """What a case can ask for: receives its parts, returns a result."""

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.(?!figures$|recorder$)\w+"

    history_units: ClassVar[dict[str, str]]
    """Unit of every value that an accepted step records."""

    def seeds(self) -> dict[str, int]:
        """Every seed of random numbers by its key path, such as ``readout.seed``; empty if nothing is random."""
        return dict(seeds_in(self))

    @abstractmethod
    def run(self, progress: Progress) -> Result:
        """Run to the end, calling ``progress`` after each accepted step.

        A run that does not converge or is interrupted returns a result with that status, the reason, and what was accepted.
        """
