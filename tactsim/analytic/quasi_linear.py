"""Quasi-linear superposition: what relaxes of a force whose elastic answer is known."""

from __future__ import annotations

import numpy as np

from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.array import Array
from tactsim.errors import InvalidQuantity


def quasi_linear(time: Array, elastic: Array, modulus: GeneralizedMaxwell) -> Array:
    r"""Relaxing answer at times ``time`` (n,) in s to elastic answers ``elastic`` (n, ...) of any unit.

    .. math:: F(t) = \int_{0^-}^t \frac{G(t - s)}{G(0)}\, dF_e(s)

    exact for an elastic answer that is linear between its samples; a first one other than zero is a jump. Each relaxation time
    has its own memory, so the effort grows with the number of samples only.

    Raises
    ------
    InvalidQuantity
        If the times do not increase or the shapes do not belong together.

    Source: Fung 1993, Biomechanics: mechanical properties of living tissues, section 7.6; recursion of Taylor, Pister &
    Goudreau 1970, doi:10.1002/nme.1620020106.
    """
    if time.ndim != 1 or elastic.shape[:1] != time.shape or not len(time) or not (np.diff(time) > 0).all():
        raise InvalidQuantity(f"times {time.shape} with answers {elastic.shape}; allowed: increasing (n,) with (n, ...)")
    instantaneous = modulus.instantaneous_modulus
    parts = (modulus.moduli / instantaneous)[:, None]
    steps = np.diff(time)[:, None] / modulus.times
    decay, mean = np.exp(-steps), -np.expm1(-steps) / steps
    flat = elastic.reshape(len(time), -1)
    memory = parts * flat[0]
    out = modulus.equilibrium_modulus / instantaneous * flat
    out[0] += memory.sum(axis=0)
    for k, change in enumerate(np.diff(flat, axis=0)):
        memory = decay[k, :, None] * memory + parts * mean[k, :, None] * change
        out[k + 1] += memory.sum(axis=0)
    return out.reshape(elastic.shape)
