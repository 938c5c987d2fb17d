"""All extension points on one page.

To add a kind, subclass its point with a literal ``kind`` that has a default, in a new module of the point's ``package`` or
anywhere else, such as a notebook. It is registered as it is defined; no list names it. `registry.kinds` lists the kinds of a
point, `registry.forget` removes one, and two classes with one ``kind`` are an error that names both. A number or a figure of a
thesis table is a function that `quantity` or `drawing` marks. `Recorder` and these two stand in modules beside this one,
`Scene`, what later stages read of a result, among the results.
"""

from __future__ import annotations

import hashlib
from abc import abstractmethod
from typing import Any, ClassVar, Literal, Self

from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.interfaces.contact_shape import ContactShape
from tactsim.interfaces.drawing import Drawing as Drawing
from tactsim.interfaces.estimate import Estimate
from tactsim.interfaces.film_report import FilmReport
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.recorder import Recorder as Recorder
from tactsim.interfaces.run import Runnable
from tactsim.interfaces.solid import Measures, Solid, check_bounds
from tactsim.interfaces.table_functions import drawing as drawing
from tactsim.interfaces.table_functions import quantity as quantity
from tactsim.kind import CaseKind, Kind
from tactsim.relaxation import Relaxation
from tactsim.results.result import Result
from tactsim.results.scene import Scene as Scene
from tactsim.units import Area, Positive, Pressure


class Material(CaseKind):
    """A constitutive law at a point: isochoric stress plus a pressure that answers the volume change.

    Fields carry components first: ``F`` has shape ``(3, 3, ...)``, ``pressure`` the trailing shape. The volume constraint is
    ``volume_change(F) - pressure / bulk_modulus = 0``, tension positive; a bulk modulus of None means exactly incompressible.
    A body uses the stress and tangent given here; one without a compiled form is assembled by numpy, several times slower.
    The axes of ``F`` are x, y, z; in a section of revolution r, z and the hoop. A law with a direction may thus be used wherever
    the planes that a model mirrors or leaves out of account mirror the law, too; elsewhere it is refused.

    >>> import tactsim as ts
    >>> tissue = ts.material("icf_stable")
    >>> isinstance(tissue, ts.Material), f"{tissue.shear_modulus:.1f} Pa"
    (True, '3553.6 Pa')
    """

    package: ClassVar[str] = "tactsim.materials"
    compiled_form: ClassVar[Literal["invariants", "small_strain"] | None] = None
    """Compiled loops that equal the methods below: of an energy of the isochoric invariants, of linear elasticity, or none."""
    small_strain: ClassVar[bool] = False
    """Whether it holds for small strain and rotation only: stress per reference area, volumes that may turn over."""
    bulk_modulus: Positive[Pressure] | None
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
        """Relative change of volume, dimensionless: J - 1 or its linear part, of the trailing shape of ``F`` (3, 3, ...)."""

    @abstractmethod
    def volume_change_gradient(self, F: Array) -> Array:
        """Derivative of the volume change with respect to F, shape ``(3, 3, ...)``."""


class RigidBody(CaseKind):
    """A rigid body as a signed distance in its own frame: the reference point at the origin, ``d`` coordinates.

    A case file names it as ``body``. One that mirror planes of the tissue do not mirror is computed with the whole tissue.

    >>> import tactsim as ts
    >>> import numpy as np
    >>> ball = ts.kinds("body")["sphere"](radius="5 mm")
    >>> distance, normal, _ = ball.signed_distance(np.array([[0.0], [0.0], [-0.002]]))  # 2 mm below it
    >>> distance.round(6).tolist(), normal.ravel().tolist()
    ([0.002], [0.0, 0.0, -1.0])
    """

    package: ClassVar[str] = "tactsim.contact"
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    """Numbers of coordinates it is defined for; 2 means the section of a body of revolution."""

    @abstractmethod
    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance in m (positive outside), unit outward normal and Hessian of the distance at points ``x`` of shape (d, n).

        Shapes ``(n,)``, ``(d, n)`` and ``(d, d, n)``.
        """

    @property
    def contact_shape(self) -> ContactShape:
        """What the specimen and its mesh must know of the part that touches; by default it reaches beyond any specimen."""
        return ContactShape()


class ContactLaw(CaseKind):
    """Tangential traction between tissue and a rigid body; a case file names it as ``contact``."""

    package: ClassVar[str] = "tactsim.contact"

    @abstractmethod
    def traction_limit(self, pressure: Array) -> Array:
        """Largest tangential traction in Pa that the contact pressure (n,) in Pa sustains, (n,)."""

    @abstractmethod
    def traction_limit_slope(self, pressure: Array) -> Array:
        """Derivative (n,) of the limit with respect to the pressure, dimensionless."""


class Inclusion(CaseKind):
    """A body in the block, or a hollow one; a case file names it as ``shape`` among the ``inclusions``.

    >>> import tactsim as ts
    >>> ball = ts.kinds("inclusion")["sphere"](center=("20 mm", "20 mm", "12 mm"), radius="4 mm")
    >>> ball.measures((0.04, 0.04, 0.02)).top  # m, in a block of this size
    0.016
    """

    package: ClassVar[str] = "tactsim.mesh.inclusions"
    data_set_number: ClassVar[int | None] = None
    """Number that stands for the kind in data sets, never to be changed; None comes behind all numbers, by the alphabet."""
    hollow: ClassVar[bool] = False
    """Whether there is an empty space in it."""

    @abstractmethod
    def solids(self, size: Array) -> tuple[Solid, ...]:
        """The body in a block of size (3,) in m, and the empty space in it if it is hollow."""

    def measures(self, size: Array) -> Measures:
        """Centre, size and height in a block of size (3,) in m, as data sets label it."""
        return self.solids(size)[0].measures()

    def places(self, size: Array) -> Array:
        """Points (n, 3) in m that stand for it where an estimate is judged."""
        return self.measures(size).center[None]

    def refine(self, wanted: float) -> float:
        """Element size in m near the body if ``wanted`` is what a thick body gets."""
        return wanted

    def identity(self) -> str:
        """Text that changes with the geometry."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()

    def file_content(self) -> str | None:
        """Hash of what the file holds that the body is read from; None if it is given without one."""
        return None

    def check_in_block(self, size: Array, gap: float, name: str) -> None:
        """Refuse a body nearer to a face of the block, (3,) in m, than ``gap`` in m or outside; an InvalidQuantity names both."""
        check_bounds(self.solids(size)[0].bounds(), size, gap, name)


class SensorFilm(CaseKind):
    """What turns a force into an electrical quantity, its signal; a case file names it as ``film``.

    Methods that take samples raise InvalidQuantity if times do not increase, or a value is negative, not finite or beyond what
    the film can bear or give. Forces and signals are arrays (n, ...) at times (n,) in s.

    >>> import tactsim as ts
    >>> film = ts.kinds("film")["film"].example()
    >>> conductance = film.read([0.0, 1.0], [0.0, 1.0])  # S, at times in s under forces in N
    >>> film.force([0.0, 1.0], conductance).round(6).tolist()
    [0.0, 1.0]
    """

    package: ClassVar[str] = "tactsim.sensors"
    modules: ClassVar[str] = r"films\.(\w+_)?film"
    signal: ClassVar[Literal["conductance", "capacitance"]]
    """What electronics measure of it, increasing with the force."""
    unit: ClassVar[Literal["S", "F"]]
    """Unit of the signal."""
    active_area: Positive[Area] | None = None
    """Area that carries the force; null is the area for which the film's numbers hold."""

    @property
    @abstractmethod
    def largest_force(self) -> float:
        """Force in N up to which the film was measured."""

    @abstractmethod
    def advance(self, state: Any, time: ArrayLike, force: ArrayLike) -> tuple[Array, Any]:
        """Signal (n, ...) of the next forces (n, ...) in N at times (n,) in s, and the state after them, None at rest."""

    @abstractmethod
    def retreat(self, state: Any, time: ArrayLike, signal: ArrayLike) -> tuple[Array, Any]:
        """Force (n, ...) in N of the next samples of the signal, and the state after them: the inverse of ``advance``."""

    @abstractmethod
    def strain(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Compressive strain, of the shape of ``force``."""

    @abstractmethod
    def sensitivity(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Immediate change of the signal with the force, in its unit per N, of the shape of ``force``."""

    @abstractmethod
    def report(self, force: Array, signal: Array) -> FilmReport:
        """Numbers of the film for the result, and under constant forces (n,) in N that give these signals (n,)."""

    @abstractmethod
    def assumptions(self) -> tuple[str, ...]:
        """What is assumed of the film."""

    @abstractmethod
    def warnings(self, largest: float) -> tuple[str, ...]:
        """What goes beyond the measurements when forces reach ``largest`` newton."""

    def read(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Signal of a film that is at rest before the first sample, of the shape of ``force``."""
        return self.advance(None, time, force)[0]

    def force(self, time: ArrayLike, signal: ArrayLike) -> Array:
        """Force in N whose history gives this signal, of its shape."""
        return self.retreat(None, time, signal)[0]


class Experiment(Runnable):
    """What a case can ask for, as ``experiment``: a kind gives `begin`; `Runnable` times, limits and ends its run.

    >>> import tactsim as ts
    >>> result = ts.kinds("experiment")["film_test"].example().run()
    >>> str(result.status)
    'converged'
    """

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.(?!figures$|recorder$|scene$)\w+"


class Estimator(CaseKind):
    """Finds inclusions from readings; a case file names it as ``estimator``, the page and the ranking offer its variants.

    >>> import tactsim as ts
    >>> import numpy as np
    >>> from tactsim.interfaces.readings import Readings
    >>> forces = np.full((2, 3, 3), 0.2)  # N on the taxels of both jaws
    >>> forces[:, 1, 2] = 0.5
    >>> readings = Readings(forces, ts.TaxelLayout(), (0.04, 0.04, 0.02))
    >>> ts.kinds("estimator")["thesis"]().estimate(readings).present
    True
    """

    package: ClassVar[str] = "tactsim.localization.estimators"
    needs_response: ClassVar[bool] = False
    """Whether it needs the fast forward model of the tissue."""
    gives_classes: ClassVar[bool] = False
    """Whether it gives a probability for each class of what may be there."""

    @property
    def title(self) -> str:
        """What the page calls it."""
        return self.kind

    @property
    def needs_reference(self) -> bool:
        """Whether it needs what the tissue reads without a lump."""
        return self.needs_response

    @classmethod
    def variants(cls) -> dict[str, Self]:
        """Name -> what is offered without settings of a user; empty if it needs what only a user has, such as a file."""
        return {cls.example().kind: cls.example()}

    @abstractmethod
    def estimate(self, readings: Readings) -> Estimate:
        """What is there, and where.

        Raises
        ------
        InputError
            If the readings lack what this estimator needs, such as a reference.
        """


class ResultFigures(Kind):
    """The figures of a kind of experiment, in a module ``figures`` of its folder: its ``kind`` is that of the experiment."""

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.figures(\.\w+)?"

    @abstractmethod
    def drawings(self, result: Result) -> dict[str, Drawing]:
        """File name -> drawing, the main figure first; only what the result has the data for."""
