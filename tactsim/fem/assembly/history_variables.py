r"""History variables of a body of relaxing materials, advanced exactly for a stress history that is linear over each step.

With :math:`S_e` the isochoric second Piola-Kirchhoff stress of the energy and one overstress per relaxation time,

.. math::
    Q_i(t) = \int_0^t g_i e^{-(t - s) / \tau_i}\, \dot S_e(s)\, ds, \qquad
    Q_i^{n+1} = e^{-h} Q_i^n + g_i \frac{1 - e^{-h}}{h} (S_e^{n+1} - S_e^n) + g_i \psi(h)\, \Delta t^2\, \ddot S_e, \qquad
    h = \Delta t / \tau_i

The last term is that of the parabola through three states, :math:`\psi = (1 + e^{-h}) / 2h - (1 - e^{-h}) / h^2`; it is zero
while the history is linear, and left out after a jump of its slope. Without it a step much longer than a relaxation time would be
of first order only. A step of zero duration is elastic.

Source: Simo & Hughes 1998, Computational Inelasticity, section 10.3; Taylor, Pister & Goudreau 1970,
doi:10.1002/nme.1620020106 (recursion); Holzapfel 2000, Nonlinear Solid Mechanics, section 6.10.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly import history_kernels
from tactsim.fem.assembly.body import Body, Kinematics, RelaxationStep
from tactsim.fem.assembly.symmetric import MULTIPLICITY, ROWS_AND_COLUMNS

ROUND_OFF = 128 * np.finfo(float).eps
"""Round-off of a stress over the shear modulus, and of the forces that it makes: F is one plus small numbers."""
NOISE_GROWTH = 8
"""Sum of the coefficients of the differences, on even steps."""
MEAN_OF_CUBIC = 0.25
"""Bound of the mean error of the parabola, over the slope of the error at its end times the step."""
LARGEST_GROWTH = 2.4
"""Ratio of two steps beyond which no parabola is fitted: 1 + sqrt 2 is the limit of stability of such formulas."""
ALL_BUT_GONE = 0.01
"""Part of the lasting stress below which the whole stress is no measure of an error."""
SMALL = 1e-2
"""Step over a relaxation time below which psi is taken from its series."""
MOST_EARLIER = 3
"""States that the error of a step needs."""
IN_SECTION = 4
"""Components 11, 22, 33 and 12, which alone are not zero in a section."""


@dataclass(frozen=True)
class Series:
    """The Prony series of a body: ``equilibrium`` (E,), ``amplitudes`` and ``times`` (n, E) in s, of each element's material."""

    equilibrium: Array
    amplitudes: Array
    times: Array

    def faded(self, time_step: float) -> tuple[Array, Array, Array]:
        """exp(-h), g (1 - exp(-h)) / h and g psi(h) with h the step over each time, all (n, E)."""
        h = time_step / self.times
        mean = np.where(h > 0, -np.expm1(-h) / np.where(h > 0, h, 1.0), 1.0)
        return np.exp(-h), self.amplitudes * mean, self.amplitudes * _bend_weight(h)


def series_of(body: Body) -> Series | None:
    """The series of a body's materials; None if none of them relaxes."""
    relaxing = [material.relaxation for material in body.materials]
    most = max((len(relaxation.times) for relaxation in relaxing if relaxation is not None), default=0)
    if most == 0:
        return None
    equilibrium, amplitudes, times = np.ones(len(relaxing)), np.zeros((most, len(relaxing))), np.ones((most, len(relaxing)))
    for index, relaxation in enumerate(relaxing):
        if relaxation is not None:
            equilibrium[index], parts, rates = relaxation.amplitudes
            amplitudes[: len(parts), index], times[: len(rates), index] = parts, rates
    return Series(equilibrium[body.regions], amplitudes[:, body.regions], times[:, body.regions])


@dataclass(frozen=True)
class HistoryVariables:
    """The elastic stress ``elastic`` (6, E, Q) of the last accepted state and the ``overstress`` (n, 6, E, Q), in Pa.

    ``earlier`` are the elastic stresses before it, latest first, each with the length in s of the step that began there, as far
    as the history has been smooth.
    """

    series: Series
    elastic: Array
    overstress: Array
    components: int = len(MULTIPLICITY)
    """How many of the components, the first ones, may differ from zero: 4 in a section."""
    earlier: tuple[tuple[Array, float], ...] = ()

    @classmethod
    def at_rest(cls, body: Body, series: Series) -> HistoryVariables:
        """The stress-free state at the beginning."""
        shape = (6, *body.points.weights.shape)
        components = IN_SECTION if body.space.dim == 2 else shape[0]
        return cls(series, np.zeros(shape), np.zeros((len(series.times), *shape)), components)

    @property
    def stress(self) -> Array:
        """Isochoric part of the present stress (6, E, Q) in Pa, with what is left of the resistance to changes of volume."""
        return self.series.equilibrium[:, None] * self.elastic + self.overstress.sum(axis=0)

    def at_slope_change(self) -> HistoryVariables:
        """The same variables where the slope of the history jumps."""
        return replace(self, earlier=())

    def relaxation_step(self, time_step: float) -> RelaxationStep:
        """Coefficients of a step of this length in s from here."""
        kept, mean, bend = self.series.faded(time_step)
        share, rest = self._bend(time_step)
        weight = (mean + share * bend).sum(axis=0)
        stress = np.zeros_like(self.elastic)
        history_kernels.history_stress((kept, mean, bend), self.overstress, self.elastic, rest, self.components, stress)
        return RelaxationStep(self.series.equilibrium + weight, stress)

    def advanced(self, elastic: Array, time_step: float) -> HistoryVariables:
        """The variables after a step of this length in s to the elastic stress (6, E, Q) in Pa."""
        overstress, stresses = np.zeros_like(self.overstress), (self.elastic, elastic)
        factors, bend = self.series.faded(time_step), self._bend(time_step)
        history_kernels.advanced(factors, self.overstress, stresses, bend, self.components, overstress)
        earlier = ((self.elastic, time_step), *self.earlier[: MOST_EARLIER - 1]) if time_step > 0 else ()
        return replace(self, elastic=elastic, overstress=overstress, earlier=earlier)

    def _bend(self, time_step: float) -> tuple[float, Array]:
        """The bend of the parabola times the step squared: ``share`` times the new elastic stress plus the rest (6, E, Q)."""
        if not self.earlier or time_step == 0 or time_step > LARGEST_GROWTH * self.earlier[0][1]:
            return 0.0, np.zeros_like(self.elastic)
        before, length = self.earlier[0]
        share = 2 * time_step / (time_step + length)
        return share, -share * (self.elastic + time_step / length * (self.elastic - before))


def elastic_stress(body: Body, state: Kinematics, unknowns: Array | None = None) -> Array:
    """Isochoric second Piola-Kirchhoff stress (6, E, Q) in Pa of the energies; the deviatoric stress if linear elastic.

    With the ``unknowns`` also what resists a change of volume that their pressure does not ask for. Compiled but for materials
    without a compiled form; in numpy it was a sixth of a timed indentation.
    """
    tension = np.zeros_like(state.J)
    if unknowns is not None and body.volume_stiffness.any():
        tension = body.volume_stiffness[:, None] * body.volume_error(unknowns, state)
    stress = body.compiled_elastic_stress(state, tension)
    for index, material in enumerate(body.materials):
        if body.forms[index] is None:
            mine = body.regions == index
            F = state.F[:, :, mine]
            P = material.first_piola_kirchhoff(F, tension[mine])
            stress[:, mine] = (P if body.linear[mine].all() else _solved(F, P))[ROWS_AND_COLUMNS]
    return stress


def mean_stress(body: Body, state: Kinematics, stress: Array) -> Array:
    """Mean Cauchy stress (E, Q) in Pa of a second Piola-Kirchhoff stress (6, E, Q) in Pa: its hydrostatic part."""
    if not stress.any():
        return np.zeros(state.J.shape)
    C = np.einsum("iJeq,iKeq->JKeq", state.F, state.F)[ROWS_AND_COLUMNS]
    spatial = np.einsum("c,ceq,ceq->eq", MULTIPLICITY, C, stress) / (3 * state.J)
    return np.where(body.linear[:, None], stress[:3].sum(axis=0) / 3, spatial)


def _solved(F: Array, P: Array) -> Array:
    """F^-1 P, shape (3, 3, ...)."""
    last = np.linalg.solve(np.moveaxis(F, (0, 1), (-2, -1)), np.moveaxis(P, (0, 1), (-2, -1)))
    return np.moveaxis(last, (-2, -1), (0, 1))


def size_of(body: Body, stress: Array) -> float:
    """Root mean square of a symmetric stress (6, E, Q) over the volume, in Pa."""
    weights = body.points.weights
    return float(np.sqrt(MULTIPLICITY @ np.einsum("ceq,ceq->c", weights * stress, stress) / weights.sum()))


def step_error(body: Body, variables: HistoryVariables, least: float = 0.0) -> float:
    r"""Estimated error of the stress over its size after the last step, when steps like it go on; zero for the first of a piece.

    The error of the parabola is :math:`s (s - \Delta t)(s + \Delta t_0) \dddot S_e / 6` in the elastic stress at the time s
    after the beginning of the step, :math:`\Delta t_0` being the length of the step before. A short relaxation
    time responds to its slope at the end of a step, a long one to its mean, which fading memory keeps from accumulating. For the
    second step of a piece the whole curvature counts as the error. Differences within the round-off of F = 1 + ... do not count.
    A stress below ``least`` in Pa counts as large as that, and one that is all but gone as a hundredth of its part that does not
    relax: in a body that was unloaded the parts cancel, and nothing would be exact enough beside their sum.
    """
    if len(variables.earlier) < 2:
        return 0.0
    (middle, last), (before, first) = variables.earlier[:2]
    slopes = ((variables.elastic - middle) / last, (middle - before) / first)
    bend = 2 * (slopes[0] - slopes[1]) / (first + last)
    h = last / variables.series.times
    if len(variables.earlier) == 2 or last > LARGEST_GROWTH * first:
        missed, weight = last**2 * bend, _bend_weight(h) / -np.expm1(-h)
    else:
        oldest, length = variables.earlier[2]
        earlier_bend = 2 * (slopes[1] - (before - oldest) / length) / (first + length)
        third = 3 * (bend - earlier_bend) / (first + last + length)
        missed, weight = last**2 * (last + first) / 6 * third, np.minimum(1 / h, MEAN_OF_CUBIC)
    noise = NOISE_GROWTH * ROUND_OFF * max(last / length for _, length in variables.earlier) ** 2 * body.shear_moduli[:, None]
    missed = np.where(np.abs(missed) > noise, missed, 0.0)
    lasting = size_of(body, variables.series.equilibrium[:, None] * variables.elastic)
    size = max(size_of(body, variables.stress), ALL_BUT_GONE * lasting, least)
    total = (variables.series.amplitudes * weight).sum(axis=0)
    return size_of(body, total[:, None] * missed) / size if size > 0 else 0.0


def _bend_weight(h: Array) -> Array:
    r"""psi, by its series :math:`\sum_{k \ge 1} (-1)^{k+1} k h^k / (2 (k + 2)!)` where the formula cancels: at ``SMALL``
    the round-off of the formula is some 1e-11 of it, and what the series leaves out 1e-13."""
    small = h < SMALL
    safe = np.where(small, 1.0, h)
    series = h * (1 / 12 - h * (1 / 24 - h * (1 / 80 - h * (1 / 360 - h / 2016))))
    return np.where(small, series, (1 + np.exp(-safe)) / (2 * safe) + np.expm1(-safe) / safe**2)
