"""Resistance of a piezoresistive film under any history of force: tunnelling, contact at the electrodes, and creep.

The creep law is that of errata E29, whose coefficients depend on the force. Strain and delayed strain follow

    eps = sigma / E0(F) + eps1,    mu1(F) eps1' + E1(F) eps1 = sigma,    sigma = F / A

which under a constant force gives the strain of eq. 2.3.1 exactly. The force is linear between samples; each interval is
integrated with the coefficients of its middle (exponential midpoint rule, second order, exact for a constant force).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.interfaces import SensorFilm
from tactsim.interfaces.film_report import FilmReport
from tactsim.results.quantity import Quantity
from tactsim.sensors.films.composite import CREEP_COEFFICIENTS, Composite
from tactsim.sensors.films.composite_library import AnyComposite, named_composite
from tactsim.sensors.films.force_history import beyond_measured, checked_forces, checked_signal, checked_times
from tactsim.sensors.films.thermogravimetry import Thermogravimetry
from tactsim.sensors.films.tunnelling import relative_resistance, tunnelling_decay
from tactsim.units import Area, Positive, format_quantity

HOLM = 100.0
"""Largest force in N of Holm's contact resistance (thesis, before eq. 2.1.12)."""
INVERSION = 1e-12
"""Relative accuracy of a force computed from its conductance."""
ITERATIONS = 60
COMPLEX_STEP = 1e-30
"""Imaginary part of the logarithm of the force, with which a slope is exact to round-off."""


@dataclass(frozen=True)
class FilmState:
    """Where a film stands after its last sample: time in s, ``force`` in N, ``delayed_strain``, of the shape of the channels."""

    time: float
    force: Array
    delayed_strain: Array


class Film(SensorFilm):
    """A film of composite between two electrodes, pressed by a total force in N; any number of equal films at once.

    A film of another area than the composite's reference is strained by its pressure, and its unstrained resistance is inverse
    to its area; the contact resistance depends on the force alone (2.1.12).
    """

    signal: ClassVar[Literal["conductance", "capacitance"]] = "conductance"
    unit: ClassVar[Literal["S", "F"]] = "S"
    kind: Literal["film"] = "film"
    composite: AnyComposite = named_composite("lingstat_identified")
    """Name of a shipped composite, or its numbers."""
    active_area: Positive[Area] | None = None
    """Area that carries the force; null is the composite's reference area."""

    @classmethod
    def example(cls) -> Self:
        """Lingstat, identified to the measured line."""
        return cls()

    @property
    def _magnification(self) -> float:
        return self.composite.magnification(self.active_area)

    @property
    def largest_force(self) -> float:
        """Force in N up to which the creep was measured."""
        return self.composite.largest_force / self._magnification

    def conductance(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Conductance in S of the whole film with its contacts, 0 without force.

        Parameters
        ----------
        time : (n,) array
            Strictly increasing, in s. The film is at rest before the first sample, at which the first force jumps on.
        force : (n, ...) array
            Compressive force in N, 0 <= F <= 100; linear between samples.

        Raises
        ------
        InvalidQuantity
            If times do not increase, or a force is negative, too large, not finite or would strain the film by 1 or more.
        """
        return self.advance(None, time, force)[0]

    def advance(self, state: FilmState | None, time: ArrayLike, force: ArrayLike) -> tuple[Array, FilmState]:
        """Conductance (n, ...) in S under forces (n, ...) in N at times (n,) in s, and the state after; None is one at rest.

        Raises
        ------
        InvalidQuantity
            If times do not increase, or a force is negative, above 100 N, not finite or would strain the film by 1 or more.
        """
        times = checked_times(time, after=None if state is None else state.time)
        forces = checked_forces(force, len(times), HOLM)
        strains = self._delayed_strains(state, times, forces)
        self._check(forces, strains)
        return self._conductance(forces, strains), FilmState(float(times[-1]), forces[-1], strains[-1])

    def strain(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Compressive strain, of the shape of ``force``; the arguments are those of ``conductance``.

        Raises
        ------
        InvalidQuantity
            If times do not increase, or a force is negative, above 100 N or not finite.
        """
        times = checked_times(time)
        forces = checked_forces(force, len(times), HOLM)
        return self._strain(forces, self._delayed_strains(None, times, forces))

    def sensitivity(self, time: ArrayLike, force: ArrayLike) -> Array:
        """Immediate change of the conductance with the force in S/N, of the shape of ``force``; infinite without force.

        Raises
        ------
        InvalidQuantity
            If times do not increase, or a force is negative, above 100 N or not finite.
        """
        times = checked_times(time)
        forces = checked_forces(force, len(times), HOLM)
        delayed = self._delayed_strains(None, times, forces)
        loaded = forces > 0
        slope = self._conductance(forces * (1 + 1j * COMPLEX_STEP), delayed).imag / COMPLEX_STEP
        return np.divide(slope, forces, where=loaded, out=np.full(forces.shape, np.inf))

    def retreat(self, state: FilmState | None, time: ArrayLike, signal: ArrayLike) -> tuple[Array, FilmState]:
        """Force (n, ...) in N of the next samples of conductance (n, ...) in S, creep included, and the state after them.

        Raises
        ------
        InvalidQuantity
            If times do not increase, or a conductance is negative, not finite or that of more than 100 N.
        ConvergenceError
            If a force is not found to 1e-12.
        """
        times = checked_times(time, after=None if state is None else state.time)
        values = checked_signal(signal, len(times), "conductance", "S")
        forces = np.empty_like(values)
        for n, (moment, value) in enumerate(zip(times, values, strict=True)):
            forces[n], state = self._force(state, float(moment), value)
        assert state is not None  # there is at least one sample
        return forces, state

    def report(self, force: Array, signal: Array) -> FilmReport:
        """Constants of the tunnelling and the resistances, the coefficients of creep, and the resistance without the contacts.

        The latter two are those under forces (n,) in N that give signals (n,) in S.
        """
        alone = 1 / signal - self.composite.contact_resistance / np.sqrt(force)
        words = "the same without the contacts at the electrodes"
        felt = force * self._magnification
        coefficients = {name: getattr(self.composite, name).at(felt).tolist() for name in CREEP_COEFFICIENTS}
        readings = {"reading_film_resistance": Quantity(alone.tolist(), "ohm", words)}
        return FilmReport(self._constants(), readings, coefficients)

    def _constants(self) -> dict[str, Quantity]:
        composite = self.composite
        initial = composite.initial_resistance * self._magnification
        return _weighed(composite) | {
            "tunnelling_decay": Quantity(tunnelling_decay(composite.barrier), "1/m", "gamma of eq. 2.1.4"),
            "particle_separation": Quantity(composite.separation, "m", "s0 of eq. 2.1.8"),
            "resistance_exponent": Quantity(composite.exponent, "1", "gamma s0: fall of the resistance with strain"),
            "initial_resistance": Quantity(initial, "ohm", "R0 of the unstrained film of this area"),
            "contact_resistance": Quantity(composite.contact_resistance, "ohm", "of both contacts at 1 N"),
        }

    def assumptions(self) -> tuple[str, ...]:
        """Source of the composite, law of the creep, what another area changes."""
        composite = self.composite
        stated = (
            f"film: {composite.source}",
            "creep with coefficients that follow the force (errata E29), which gives eq. 2.3.1 under a constant force",
            f"the coefficients of creep depend on the pressure; they were measured on {composite.reference_area * 1e6:.4g} mm²",
        )
        other = "the unstrained resistance is inverse to the active area, the contact resistance depends on the force alone"
        return stated if self._magnification == 1 else (*stated, other)

    def warnings(self, largest: float) -> tuple[str, ...]:
        """Whether forces up to ``largest`` in N go beyond those of the creep tests."""
        words = "its creep was measured up to {}, beyond that lines are prolonged"
        return beyond_measured(largest, self.largest_force, words)

    def _strain(self, force: Array, delayed: Array) -> Array:
        felt = force * self._magnification
        return felt / (self.composite.reference_area * self.composite.instantaneous.at(felt)) + delayed

    def _check(self, force: Array, delayed: Array) -> None:
        """Whether the film still has a thickness, and with it a resistance above zero."""
        strain = self._strain(force, delayed)
        if strain.size and strain.max() >= 1:
            felt = format_quantity(float(force.flat[int(strain.argmax())]), "N")
            most = format_quantity(self.largest_force, "N")
            raise InvalidQuantity(
                f"a force of {felt} strains the film by {strain.max():.3g}; allowed: below 1; its creep is known up to {most}: "
                "press less, or take a larger active_area or a stiffer composite"
            )

    def _conductance(self, force: Array, delayed: Array) -> Array:
        composite, root = self.composite, np.sqrt(force)
        relative = relative_resistance(self._strain(force, delayed), composite.exponent)
        film = composite.initial_resistance * self._magnification * relative
        return root / (composite.contact_resistance + root * film)

    def _decay(self, force: Array, duration: Array) -> tuple[Array, Array]:
        """Factor of the delayed strain and what is added to it while a force in N acts for a duration in s."""
        felt, composite = force * self._magnification, self.composite
        modulus = composite.delayed.at(felt)
        exponent = -duration * modulus / composite.viscosity.at(felt)
        return np.exp(exponent), -np.expm1(exponent) * felt / (composite.reference_area * modulus)

    def _delayed_strains(self, state: FilmState | None, times: Array, forces: Array) -> Array:
        start = np.zeros(forces.shape[1:]) if state is None else state.delayed_strain
        before_time = times[:1] if state is None else [state.time]
        before_force = forces[:1] if state is None else state.force[None]
        steps = np.diff(times, prepend=before_time).reshape(-1, *[1] * (forces.ndim - 1))
        factors, gains = self._decay((forces + np.concatenate([before_force, forces[:-1]])) / 2, steps)
        strains, last = np.empty_like(forces), start
        for n in range(len(times)):
            last = strains[n] = factors[n] * last + gains[n]
        return strains

    def _force(self, state: FilmState | None, time: float, conductance: Array) -> tuple[Array, FilmState]:
        """Force in N at the next sample and the state there: Newton's method in the logarithms of force and conductance."""
        step = np.asarray(0.0 if state is None else time - state.time)
        before = None if state is None else state.force
        delayed = np.zeros(conductance.shape) if state is None else state.delayed_strain
        loaded = conductance > 0
        wanted = np.log(conductance, where=loaded, out=np.zeros_like(conductance))
        force = np.where(loaded, np.clip(0.0 if before is None else before, 1e-3, HOLM), 0.0)

        def delayed_strain(force: Array) -> Array:
            factor, gain = self._decay((force + (force if before is None else before)) / 2, step)
            return factor * delayed + gain

        for _ in range(ITERATIONS):
            # One complex evaluation gives value and slope: every function here is analytic.
            nearby = force * np.exp(1j * COMPLEX_STEP)
            logarithm = np.log(self._conductance(nearby, delayed_strain(nearby)), where=loaded, out=np.ones_like(nearby))
            slope = np.where(loaded, logarithm.imag / COMPLEX_STEP, 1.0)
            change = np.where(loaded, np.clip((wanted - logarithm.real) / slope, -2.0, 2.0), 0.0)
            force = force * np.exp(change)
            if np.any(force > 10 * HOLM) or np.all(np.abs(change) <= INVERSION):
                break
        else:
            raise ConvergenceError(
                f"no force was found for the conductance at {time:g} s: last change {np.abs(change).max():.1e}"
            )
        if np.any(force > HOLM):
            raise InvalidQuantity(
                f"the conductance at {time:g} s is that of more than {HOLM:g} N, up to which the film is known; "
                "lower the noise, the offset or the force"
            )
        return force, FilmState(time, force, delayed_strain(force))


def _weighed(composite: Composite) -> dict[str, Quantity]:
    """The filler's fraction with its uncertainty, if it comes from masses."""
    given = composite.volume_fraction
    if not isinstance(given, Thermogravimetry):
        return {}
    return {
        "volume_fraction": Quantity(given.volume_fraction, "1", "of the filler, from the masses and densities"),
        "volume_fraction_deviation": Quantity(given.volume_fraction_deviation, "1", "its standard uncertainty"),
    }
