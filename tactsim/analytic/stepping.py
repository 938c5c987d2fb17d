"""Compiled steps of linear viscoelastic models, exact for inputs linear over each step, without allocation.

A step takes ``constants`` of shape (2 + 2 n,) and a ``state`` of shape (2 + n,) that it updates in place. The constants are the
spring, the dashpot, the strengths and the times of the n units; the state is the last input, its integral over time and the
internal variables. Both come from a model by ``step_constants`` and ``rest_state``.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from tactsim.analytic import small_ratio
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.small_ratio import SERIES, SERIES_END
from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.outside.compiled_loops import forget_stale


def step_constants(model: GeneralizedKelvin | GeneralizedMaxwell) -> Array:
    """The numbers of ``model`` as one contiguous array of shape (2 + 2 n,), in SI units."""
    if isinstance(model, GeneralizedKelvin):
        return np.concatenate([[model.glassy_compliance, model.fluidity], model.compliances, model.times])
    return np.concatenate([[model.equilibrium_modulus, 0.0], model.moduli, model.times])


def rest_state(model: GeneralizedKelvin | GeneralizedMaxwell) -> Array:
    """The state of ``model`` before any input: zeros of shape (2 + n,)."""
    return np.zeros(2 + model.times.size)


@numba.njit(cache=True, inline="always")
def _mean_creep(ratio: float) -> float:
    """Mean of 1 - exp(-u) over 0 < u < ratio: (h - 1 + exp(-h)) / h."""
    if ratio >= SERIES_END:
        return 1.0 + math.expm1(-ratio) / ratio
    total = 0.0
    for coefficient in SERIES:
        total = total * ratio + coefficient
    return total * ratio


@numba.njit(cache=True, inline="always")
def _faded(inner: float, ratio: float, fading: float) -> float:
    """inner * exp(-ratio), with ``fading`` = exp(-ratio) - 1, of which many small steps do not add up a bias of round-off."""
    return inner + fading * inner if ratio < SERIES_END else inner * math.exp(-ratio)


@numba.njit(cache=True)
def kelvin_step(constants: Array, state: Array, time_step: float, stress: float) -> float:
    r"""Strain at the end of a step in which the stress in Pa went linearly from its last value to ``stress``.

    .. math::
        q_i \leftarrow q_i + (\sigma_0 - q_i)(1 - e^{-h_i}) + \Delta\sigma\, \frac{h_i - 1 + e^{-h_i}}{h_i}, \quad
        \varepsilon_1 = J_0 \sigma_1 + \sum_i J_i q_i + \varphi \int \sigma\, dt, \quad h_i = \Delta t / \tau_i

    with the stress :math:`\sigma_0` at the beginning of the step and :math:`\sigma_1 = \sigma_0 + \Delta\sigma` at its end. A
    ``time_step`` of zero in s is a jump. ``constants`` (2 + 2 n,) and ``state`` (2 + n,), updated in place, are the module's.

    Raises
    ------
    InvalidQuantity
        If ``time_step`` is negative, infinite or NaN; the state is then as before.

    Source: as of `maxwell_step`, for the equation of a Kelvin unit.
    """
    if not 0.0 <= time_step < math.inf:
        raise InvalidQuantity("time_step is out of range; allowed: finite and >= 0 s")
    units = (constants.size - 2) // 2
    last, change = state[0], stress - state[0]
    state[0] = stress
    state[1] += time_step * (last + 0.5 * change)
    strain = constants[0] * stress + constants[1] * state[1]
    for i in range(units):
        ratio = time_step / constants[2 + units + i]
        fading = math.expm1(-ratio)
        inner = _faded(state[2 + i], ratio, fading) + (change * _mean_creep(ratio) - last * fading)
        state[2 + i] = inner
        strain += constants[2 + i] * inner
    return strain


@numba.njit(cache=True)
def maxwell_step(constants: Array, state: Array, time_step: float, strain: float) -> float:
    r"""Stress in Pa at the end of a step in which the strain went linearly from its last value to ``strain``.

    .. math::
        r_k \leftarrow r_k e^{-h_k} + \Delta\varepsilon\, \frac{1 - e^{-h_k}}{h_k}, \quad
        \sigma = G_\infty \varepsilon + \sum_k G_k r_k, \quad h_k = \Delta t / \tau_k

    with the strain r_k of the spring of each unit. A ``time_step`` of zero in s is a jump. ``constants`` (2 + 2 n,) and ``state``
    (2 + n,), updated in place, are those of the module.

    Raises
    ------
    InvalidQuantity
        If ``time_step`` is negative, infinite or NaN; the state is then as before.

    Source: Taylor, Pister & Goudreau 1970, doi:10.1002/nme.1620020106.
    """
    if not 0.0 <= time_step < math.inf:
        raise InvalidQuantity("time_step is out of range; allowed: finite and >= 0 s")
    units = (constants.size - 2) // 2
    change = strain - state[0]
    state[1] += time_step * (state[0] + 0.5 * change)
    state[0] = strain
    stress = constants[0] * strain
    for i in range(units):
        ratio = time_step / constants[2 + units + i]
        fading = math.expm1(-ratio)
        inner = _faded(state[2 + i], ratio, fading) + change * (-fading / ratio if ratio > 0.0 else 1.0)
        state[2 + i] = inner
        stress += constants[2 + i] * inner
    return stress


@numba.njit(cache=True)
def carry(ratios: Array, gains: Array, states: Array) -> None:
    """Fill ``states`` of shape (m + 1, n) from its first row by states[k + 1] = exp(-ratios[k]) states[k] + gains[k]."""
    for k in range(ratios.shape[0]):
        for i in range(ratios.shape[1]):
            ratio = ratios[k, i]
            states[k + 1, i] = _faded(states[k, i], ratio, math.expm1(-ratio)) + gains[k, i]


forget_stale(carry, small_ratio)
