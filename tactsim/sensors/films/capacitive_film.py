"""A capacitive film: two plates on a soft dielectric that a force brings nearer to each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import SensorFilm
from tactsim.interfaces.film_report import FilmReport
from tactsim.results.quantity import Quantity
from tactsim.sensors.films.force_history import beyond_measured, checked_forces, checked_signal, checked_times
from tactsim.units import Area, Length, Positive, Pressure, format_quantity

VACUUM_PERMITTIVITY = 8.8541878128e-12
"""In F/m: CODATA 2018, doi:10.1103/RevModPhys.93.025010."""
MEASURED_STRETCH, MEASURED_STRESS = 1.5, 16e3
"""Nominal stress in Pa of Ecoflex 00-30 at that stretch in uniaxial tension, measured by Marechal et al. 2020."""
REFERENCE_AREA = 15e-3 * 15e-3
"""In m^2: that of the piezoresistive film of the thesis, so that both can be compared."""
LARGEST = 100.0
"""Largest force in N that is taken."""
ITERATIONS = 40
"""Of Newton's method for a stretch: down to round-off at any force."""


@dataclass(frozen=True)
class CapacitorState:
    """The time in s of the last sample: the dielectric is elastic and remembers nothing else."""

    time: float


class CapacitiveFilm(SensorFilm):
    r"""A parallel plate capacitor whose dielectric is compressed between plates that it slides on.

    .. math:: C = \frac{\epsilon_0 \epsilon_r A}{t_0 \lambda}, \qquad p = \frac{F}{A} = \mu (\lambda^{-2} - \lambda)

    with :math:`t_0 \lambda = t_0 - u` and the pressure p of an incompressible neo-Hookean dielectric under uniaxial compression.
    Fringes of the field are left out.

    Measured, by Marechal et al. 2020, doi:10.1089/soro.2019.0115 (ASTM D412, 450 mm/min): the nominal stress of Ecoflex 00-30 at
    a tensile strain of 50 %, 16 kPa, which fixes :math:`\mu`. Not measured: that the same law holds in compression, that it does
    not creep, the relative permittivity (usual for silicones) and the thickness; these are assumptions.
    """

    signal: ClassVar[Literal["conductance", "capacitance"]] = "capacitance"
    unit: ClassVar[Literal["S", "F"]] = "F"
    kind: Literal["capacitive_film"] = "capacitive_film"
    active_area: Positive[Area] | None = None
    """Area of the plates; null is 15 mm x 15 mm."""
    thickness: Positive[Length] = 0.5e-3
    """Distance of the plates without force."""
    relative_permittivity: Annotated[float, Field(ge=1, le=1e5)] = 2.8
    """Of the dielectric."""
    shear_modulus: Positive[Pressure] = MEASURED_STRESS / (MEASURED_STRETCH - MEASURED_STRETCH**-2)
    """Of the dielectric."""

    @classmethod
    def example(cls) -> Self:
        """Ecoflex 00-30."""
        return cls()

    @property
    def area(self) -> float:
        """Area of the plates in m^2."""
        return self.active_area or REFERENCE_AREA

    @property
    def _rest_capacitance(self) -> float:
        """Capacitance in F without force."""
        return VACUUM_PERMITTIVITY * self.relative_permittivity * self.area / self.thickness

    @property
    def largest_force(self) -> float:
        """Force in N at the reciprocal of the stretch at which the stress was measured."""
        return float(self._force(np.array(1 / MEASURED_STRETCH)))

    def advance(self, state: CapacitorState | None, time: ArrayLike, force: ArrayLike) -> tuple[Array, CapacitorState]:
        """Capacitance (n, ...) in F under the next forces (n, ...) in N at times (n,) in s, and the state after; None is at rest.

        Raises
        ------
        InvalidQuantity
            If times do not increase, or a force is negative, not finite or above 100 N.
        """
        times = checked_times(time, after=None if state is None else state.time)
        stretch = self._stretch(checked_forces(force, len(times), LARGEST))
        return self._rest_capacitance / stretch, CapacitorState(float(times[-1]))

    def retreat(self, state: CapacitorState | None, time: ArrayLike, signal: ArrayLike) -> tuple[Array, CapacitorState]:
        """Force (n, ...) in N of the next samples of capacitance (n, ...) in F at times (n,) in s, and the state after them.

        Raises
        ------
        InvalidQuantity
            If times do not increase, or a capacitance is not finite, below that without force or that of more than 100 N.
        """
        times = checked_times(time, after=None if state is None else state.time)
        values = checked_signal(signal, len(times), self.signal, self.unit)
        rest, most = self._rest_capacitance, self._rest_capacitance / float(self._stretch(np.array(LARGEST)))
        outside = ~((values >= rest * (1 - 1e-12)) & (values <= most * (1 + 1e-12)))
        if outside.any():
            raise InvalidQuantity(
                f"capacitance {values[outside][0]:g} F; allowed: from {rest:g} F without force to {most:g} F at {LARGEST:g} N"
            )
        return self._force(np.minimum(rest / values, 1.0)), CapacitorState(float(times[-1]))

    def strain(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Compressive strain u / t0, of the shape of ``force``; raises as ``advance`` does."""
        return 1 - self._stretch(checked_forces(force, len(checked_times(time)), LARGEST))

    def sensitivity(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Change of the capacitance with the force in F/N, of the shape of ``force``; raises as ``advance`` does."""
        stretch = self._stretch(checked_forces(force, len(checked_times(time)), LARGEST))
        return self._rest_capacitance / (self.shear_modulus * self.area * (2 / stretch + stretch**2))

    def report(self, force: Array, signal: Array) -> FilmReport:
        """Capacitance without force and its first rise; signals (n,) in F under forces (n,) in N show nothing else of it."""
        slope = float(self.sensitivity([0.0], [0.0])[0])
        return FilmReport(
            {
                "rest_capacitance": Quantity(self._rest_capacitance, "F", "without force"),
                "initial_sensitivity": Quantity(slope, "F/N", "rise of the capacitance with the first force"),
                "dielectric_shear_modulus": Quantity(self.shear_modulus, "Pa", "small-strain shear modulus of the dielectric"),
            }
        )

    def assumptions(self) -> tuple[str, ...]:
        """What was measured and what was not."""
        return (
            "film: parallel plates on a neo-Hookean dielectric; the default modulus is that of Ecoflex 00-30 in tension, "
            "measured by Marechal et al. 2020, doi:10.1089/soro.2019.0115",
            "the dielectric slides on its plates, is compressed as it is stretched, and does not creep; fringes are left out",
            f"relative permittivity {self.relative_permittivity:g} and thickness {format_quantity(self.thickness, 'm')}",
        )

    def warnings(self, largest: float) -> tuple[str, ...]:
        """Whether forces up to ``largest`` in N compress the dielectric beyond the reciprocal of the measured stretch."""
        return beyond_measured(largest, self.largest_force, "its dielectric is known up to {}")

    def _force(self, stretch: Array) -> Array:
        return self.shear_modulus * self.area * (stretch**-2 - stretch)

    def _stretch(self, force: Array) -> Array:
        """The root in (0, 1] of lambda^3 + q lambda^2 = 1 with q = p / mu, by Newton's method from above."""
        load = np.asarray(force) / (self.shear_modulus * self.area)
        stretch = np.ones_like(load)
        for _ in range(ITERATIONS):
            stretch = stretch - (stretch**3 + load * stretch**2 - 1) / (3 * stretch**2 + 2 * load * stretch)
        return stretch
