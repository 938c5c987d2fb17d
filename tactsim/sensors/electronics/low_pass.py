"""Butterworth low pass on sampled values, with its state: whole records, chunks, and the inverse."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated

import numpy as np
import scipy
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.units import Frequency, Positive, format_quantity

INVERTIBLE = 1
"""Highest order that is inverted: the inverse has as many poles at -1, from the second on round-off grows with the samples."""
SLOWEST, FASTEST = 1e-5, 0.499
"""Range of the cut-off over the sampling rate: beyond it the coefficients lose more than half of their digits."""


class LowPass(FrozenModel):
    """Digital Butterworth filter by the bilinear transform: 3 dB at the cut-off, 1 at 0 Hz, 0 at half the sampling rate.

    Its state is passed in and returned; None means settled at the first sample, as after a long rest there. A record that is
    filtered in chunks with the state handed on equals the record filtered at once.

    Source: thesis, 3.1.2 (first order, 10 Hz) and 6.4 (40 Hz, no order given: first is assumed, errata E27).
    """

    cutoff: Positive[Frequency] = 40.0
    """Frequency at which the gain is 1/sqrt(2)."""
    order: Annotated[int, Field(ge=1, le=8)] = 1
    """Number of poles."""

    def filtered(self, samples: Array, sampling_rate: float, state: Array | None = None) -> tuple[Array, Array]:
        """Filtered samples, of shape ``(time, ...)`` and any unit, and the state (sections, 2, channels) after the last one.

        The sampling rate is in Hz.

        Raises
        ------
        InvalidQuantity
            If there are no samples, one is not finite, the state is that of other channels, or the cut-off is not below half
            the sampling rate.
        """
        sections, settled = self._sections(sampling_rate)
        return _run(sections, settled, samples, state)

    def unfiltered(self, filtered: Array, sampling_rate: float, state: Array | None = None) -> tuple[Array, Array]:
        """Samples that the filter turned into ``filtered``, and the state after the last one; shapes and units as in `filtered`.

        The inverse is exact but marginally stable, as the filter blocks half the sampling rate: an error that is added to
        ``filtered`` is amplified and does not decay. It therefore takes the filter's own output, not a rounded one.

        Raises
        ------
        InvalidQuantity
            As `filtered`; and above the first order.
        """
        if self.order > INVERTIBLE:
            raise InvalidQuantity(f"a low pass of order {self.order} cannot be inverted; allowed: up to {INVERTIBLE}")
        sections, settled = self._sections(sampling_rate)
        first = sections[:, :1]
        inverse = np.hstack([sections[:, 3:], sections[:, :3]]) / first
        return _run(inverse, -settled / first, filtered, state)

    def gain(self, frequency: Array, sampling_rate: float | None = None) -> Array:
        r"""Amplitude out over in at frequencies in Hz, of their shape; of the analog filter if no sampling rate in Hz is given.

        .. math:: |H(f)| = 1 / \sqrt{1 + (f/f_c)^{2 n}}
        """
        frequency = np.asarray(frequency, dtype=float)
        if sampling_rate is None:
            return 1 / np.sqrt(1 + (frequency / self.cutoff) ** (2 * self.order))
        _, response = scipy.signal.sosfreqz(self._sections(sampling_rate)[0], worN=np.atleast_1d(frequency), fs=sampling_rate)
        return np.abs(response).reshape(frequency.shape)

    def check(self, sampling_rate: float) -> None:
        """Whether it can be sampled at this rate in Hz.

        Raises
        ------
        InvalidQuantity
            If the cut-off is not below half the sampling rate, or not above a hundred thousandth of it.
        """
        if SLOWEST * sampling_rate <= self.cutoff <= FASTEST * sampling_rate:
            return
        cutoff, rate = format_quantity(self.cutoff, "Hz"), format_quantity(sampling_rate, "Hz")
        if self.cutoff < SLOWEST * sampling_rate:
            raise InvalidQuantity(
                f"cutoff {cutoff} of the low pass must be at least {SLOWEST:g} of the sampling_rate of {rate}; "
                "raise it or sample slower"
            )
        raise InvalidQuantity(
            f"cutoff {cutoff} of the low pass must be below half the sampling_rate of {rate} (at most {FASTEST:g} of it); "
            "sample faster or lower it"
        )

    def _sections(self, sampling_rate: float) -> tuple[Array, Array]:
        return _design(self, sampling_rate)


@lru_cache(maxsize=64)
def _design(low_pass: LowPass, sampling_rate: float) -> tuple[Array, Array]:
    """Second-order sections, shape (s, 6), and their state settled at 1, shape (s, 2); not to be changed."""
    low_pass.check(sampling_rate)
    sections = scipy.signal.butter(low_pass.order, low_pass.cutoff, fs=sampling_rate, output="sos")
    return sections, scipy.signal.sosfilt_zi(sections)


def _run(sections: Array, settled: Array, samples: Array, state: Array | None) -> tuple[Array, Array]:
    """Output of the sections along the first axis, and the new state of shape (s, 2, channels)."""
    samples = np.asarray(samples, dtype=float)
    if not samples.ndim or not samples.size:
        raise InvalidQuantity("no samples to filter; pass an array of shape (time, ...) with at least one")
    flat = samples.reshape(len(samples), -1)
    if not np.isfinite(flat).all():
        raise InvalidQuantity(f"{np.count_nonzero(~np.isfinite(flat))} of {flat.size} samples to filter are not finite")
    if state is None:
        state = settled[:, :, None] * flat[0]
    if state.shape != (*settled.shape, flat.shape[1]):
        raise InvalidQuantity(f"a state of shape {state.shape} for {flat.shape[1]} channels; pass the state of the same channels")
    after = np.empty_like(state)
    for k, section in enumerate(sections):  # not sosfilt, which takes six times longer for a chunk of ten samples
        flat, after[k] = scipy.signal.lfilter(section[:3], section[3:], flat, axis=0, zi=state[k])
    return flat.reshape(samples.shape), after
