"""Response of linear viscoelastic models to histories, exact, from segment to segment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.histories import History, Pieces
from tactsim.analytic.small_ratio import SERIES, SERIES_END
from tactsim.analytic.spectrum import real_array
from tactsim.array import Array
from tactsim.errors import InvalidQuantity

INTERPRETED = 100_000
"""Most pieces of a history that numpy carries one by one, 2.5 us each; loading the compiled loop takes 0.3 s."""


def response(model: GeneralizedKelvin | GeneralizedMaxwell, history: History, times: ArrayLike) -> Array:
    r"""Strain of a Kelvin model under a history of stress, or stress in Pa of a Maxwell model under a history of strain.

    .. math::
        \varepsilon = J_0 \sigma + \sum_i J_i q_i + \varphi \int_0^t \sigma\, ds, \quad \tau_i \dot q_i + q_i = \sigma; \qquad
        \sigma = G_\infty \varepsilon + \sum_k G_k r_k, \quad \tau_k \dot r_k + r_k = \tau_k \dot \varepsilon

    The unit equations are solved in closed form over each segment. ``times`` in s may have any order and shape, which the result
    has too; it is 0 before t = 0 and, at a jump, the value after it.

    Raises
    ------
    InvalidQuantity
        If a time is not finite.

    Source: Tschoegl 1989, The Phenomenological Theory of Linear Viscoelastic Behavior, chapter 3, for the units.
    """
    instants = real_array("times", times)
    if not np.isfinite(instants).all():
        raise InvalidQuantity("times hold NaN or infinity; allowed: finite times in s")
    if instants.size == 0:
        return instants
    piece, elapsed = history.located(instants)
    passed = slice(0, piece.max())
    durations = np.diff(history.starts)[passed]
    whole = _Spans(history.pieces.taken(passed), durations)
    partial = _Spans(history.pieces.taken(piece), elapsed)
    if isinstance(model, GeneralizedKelvin):
        output = _strain(model, whole, partial, piece)
    else:
        output = _stress(model, history, whole, partial, piece)
    return np.where(instants < 0, 0.0, output.reshape(instants.shape))


@dataclass(frozen=True)
class _Spans:
    """Pieces of a history, each from its start over ``elapsed`` (m,) in s."""

    pieces: Pieces
    elapsed: Array


def _strain(model: GeneralizedKelvin, whole: _Spans, partial: _Spans, index: Array) -> Array:
    """Strain from the whole pieces before, and from the begun piece of each time, with its ``index`` (m,) in the history."""
    states = np.zeros((len(whole.elapsed) + 1, model.times.size))
    _carry(whole.elapsed[:, None] / model.times, filtered_input(model.times, whole.pieces, whole.elapsed), states)
    decay = np.exp(-partial.elapsed[:, None] / model.times)
    inner = decay * states[index] + filtered_input(model.times, partial.pieces, partial.elapsed)
    strain = model.glassy_compliance * partial.pieces.at(partial.elapsed) + inner @ model.compliances
    if model.fluidity:
        areas = np.append(0.0, np.cumsum(integral(whole.pieces, whole.elapsed)))
        strain += model.fluidity * (areas[index] + integral(partial.pieces, partial.elapsed))
    return strain


def _stress(model: GeneralizedMaxwell, history: History, whole: _Spans, partial: _Spans, index: Array) -> Array:
    """Stress from the whole pieces before, and from the begun piece of each time, with its ``index`` (m,) in the history."""
    count = len(whole.elapsed)
    values = history.pieces.taken(slice(0, count + 1)).at(np.zeros(count + 1))
    jumps = np.diff(values, prepend=0.0)
    jumps[1:] = values[1:] - whole.pieces.at(whole.elapsed)
    states = np.empty((count + 1, model.times.size))
    states[0] = jumps[0]
    gains = filtered_rate(model.times, whole.pieces, whole.elapsed) + jumps[1:, None]
    _carry(whole.elapsed[:, None] / model.times, gains, states)
    decay = np.exp(-partial.elapsed[:, None] / model.times)
    inner = decay * states[index] + filtered_rate(model.times, partial.pieces, partial.elapsed)
    return model.equilibrium_modulus * partial.pieces.at(partial.elapsed) + inner @ model.moduli


def _carry(ratios: Array, gains: Array, states: Array) -> None:
    """As the compiled `carry`, which is loaded where it pays."""
    if len(ratios) > INTERPRETED:
        from tactsim.analytic.stepping import carry

        carry(ratios, gains, states)
        return
    small = ratios < SERIES_END
    whole, factor = small.astype(float), np.where(small, np.expm1(-ratios), np.exp(-ratios))
    for k in range(len(ratios)):
        states[k + 1] = whole[k] * states[k] + factor[k] * states[k] + gains[k]


def filtered_input(times: Array, pieces: Pieces, elapsed: Array) -> Array:
    r"""Solution of tau q' + q = f from q = 0, shape (m, n), at ``elapsed`` (m,) in s since the start of each of m pieces f.

    .. math::
        q = v (1 - e^{-h}) + b \tau (h - 1 + e^{-h}) + \sum A (\sin\theta\, c + \cos\theta\, s), \quad h = t / \tau

    with value v, slope b, and the responses c and s of ``wave_lags``.

    Source: derived here by variation of constants.
    """
    ratio = elapsed[:, None] / times
    solution = -pieces.values[:, None] * np.expm1(-ratio) + pieces.slopes[:, None] * times * ramp_lag(ratio)
    for amplitude, frequency, phase in _waves(pieces):
        cosine, sine = wave_lags(ratio, frequency * elapsed[:, None], frequency * times)
        solution += amplitude * (np.sin(phase) * cosine + np.cos(phase) * sine)
    return solution


def filtered_rate(times: Array, pieces: Pieces, elapsed: Array) -> Array:
    r"""Solution of tau r' + r = tau f' from r = 0, shape (m, n), at ``elapsed`` (m,) in s since the start of each of m pieces f.

    .. math:: r = b \tau (1 - e^{-h}) + \sum A \omega \tau (\cos\theta\, c - \sin\theta\, s)

    with slope b, and the responses c and s of ``wave_lags``.

    Source: derived here by variation of constants.
    """
    ratio = elapsed[:, None] / times
    solution = -pieces.slopes[:, None] * times * np.expm1(-ratio)
    for amplitude, frequency, phase in _waves(pieces):
        cosine, sine = wave_lags(ratio, frequency * elapsed[:, None], frequency * times)
        solution += amplitude * frequency * times * (np.cos(phase) * cosine - np.sin(phase) * sine)
    return solution


def integral(pieces: Pieces, elapsed: Array) -> Array:
    """Integral of each piece over ``elapsed`` in s since its start, shape (m,)."""
    half = pieces.angular_frequencies * elapsed / 2
    mean = pieces.amplitudes * np.sin(half + pieces.phases) * _cardinal_sine(half)
    return elapsed * (pieces.values + pieces.slopes * elapsed / 2 + mean.sum(axis=0))


def ramp_lag(ratio: Array) -> Array:
    """h - 1 + exp(-h) to round-off for h >= 0, of its shape."""
    small = np.minimum(ratio, SERIES_END)
    return np.where(ratio < SERIES_END, small**2 * np.polyval(SERIES, small), ratio + np.expm1(-ratio))


def wave_lags(ratio: Array, angle: Array, lag: Array) -> tuple[Array, Array]:
    r"""Solutions c and s of tau q' + q = cos(w t) and = sin(w t) from q = 0, at h = t / tau, with p = w t and r = w tau.

    .. math::
        c = \frac{\cos p - e^{-h} + r \sin p}{1 + r^2}, \quad s = \frac{r}{1 + r^2}
        \left[ h \frac{\sin p}{p} - \cos p + e^{-h} \right]

    For h < 1 the bracket is formed as (h - 1 + exp(-h)) + 2 sin(p/2)^2 - h (1 - sin(p) / p), the parts of which do not cancel.
    ``ratio`` h, ``angle`` p and ``lag`` r are dimensionless arrays that broadcast to the shape of c and s.

    Source: derived here by variation of constants.
    """
    bow = 2 * np.sin(angle / 2) ** 2
    early = ramp_lag(np.minimum(ratio, 1.0)) + bow - np.minimum(ratio, 1.0) * _sine_deficit(angle)
    late = ratio * _cardinal_sine(angle) - np.cos(angle) + np.exp(-ratio)
    divisor = 1 + lag**2
    return (-bow - np.expm1(-ratio) + lag * np.sin(angle)) / divisor, lag / divisor * np.where(ratio < 1, early, late)


def _waves(pieces: Pieces) -> list[tuple[Array, Array, Array]]:
    """Amplitude, angular frequency and phase of each set of harmonics, as columns (m, 1)."""
    sets = zip(pieces.amplitudes, pieces.angular_frequencies, pieces.phases, strict=True)
    return [(amplitude[:, None], frequency[:, None], phase[:, None]) for amplitude, frequency, phase in sets]


def _cardinal_sine(angle: Array) -> Array:
    """sin(p) / p."""
    return np.sinc(angle / np.pi)


def _sine_deficit(angle: Array) -> Array:
    """1 - sin(p) / p to round-off for p >= 0."""
    square = np.minimum(angle, 1.0) ** 2
    total = np.zeros_like(square)
    for k in range(9, 0, -1):  # the next term is below 1e-18 of the sum at p = 1
        total = square / (2 * k * (2 * k + 1)) * (1 - total)
    return np.where(angle < 1, total, 1 - _cardinal_sine(angle))
