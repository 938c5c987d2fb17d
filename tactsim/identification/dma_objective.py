"""The constants of the generalized Kelvin model as one vector, their compliance, and how far it is from data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.array import Array
from tactsim.errors import UnknownName
from tactsim.identification.dma_data import DmaData

FORMS = ("squared", "as_printed")
"""``squared``: the sum of the squared norms, as the text of thesis 4.5 says; ``as_printed``: the sum of the norms, as 4.5.2."""


@dataclass(frozen=True, eq=False)
class KelvinConstants:
    """E0, E1..En and tau1..taun, n units in the order of the vector (not merged, unlike ``GeneralizedKelvin``)."""

    glassy_modulus: float
    """E0 in Pa."""
    moduli: Array
    """E_i in Pa, shape (n,)."""
    retardation_times: Array
    """tau_i in s, shape (n,)."""

    @property
    def logarithms(self) -> Array:
        """Natural logarithms of the constants in SI, shape (2n + 1,)."""
        return np.log(np.concatenate([[self.glassy_modulus], self.moduli, self.retardation_times]))

    @classmethod
    def from_logarithms(cls, logarithms: Array) -> KelvinConstants:
        """The constants of a vector of shape (2n + 1,)."""
        values, units = np.exp(logarithms), len(logarithms) // 2
        return cls(float(values[0]), values[1 : units + 1], values[units + 1 :])

    @property
    def names(self) -> tuple[str, ...]:
        """``e_0``, ``e_1`` ... ``tau_1`` ... in the order of ``logarithms``."""
        numbers = range(1, len(self.moduli) + 1)
        return ("e_0", *(f"e_{i}" for i in numbers), *(f"tau_{i}" for i in numbers))

    def model(self) -> GeneralizedKelvin:
        """The model with these constants."""
        return GeneralizedKelvin(1 / self.glassy_modulus, 1 / self.moduli, self.retardation_times)


def compliance_parts(logarithms: Array, frequencies: Array) -> Array:
    r"""Elastic and viscous compliance in 1/Pa, shape (..., 2, frequencies), of log constants of shape (..., 2n + 1).

    .. math::
        D_e = \frac{1}{E_0} + \sum_i \frac{1}{E_i (1 + \omega^2 \tau_i^2)}, \quad
        D_v = \sum_i \frac{\omega \tau_i}{E_i (1 + \omega^2 \tau_i^2)}

    Source: thesis eq. 4.3.8.
    """
    glassy, terms, product = _terms(logarithms, frequencies)
    return np.stack([glassy + terms.sum(axis=-2), (terms * product).sum(axis=-2)], axis=-2)


def part_sensitivities(logarithms: Array, frequencies: Array) -> Array:
    """Derivatives of ``compliance_parts`` in 1/Pa by log constants of shape (2n + 1,); shape (2, frequencies, 2n + 1)."""
    glassy, terms, product = _terms(logarithms, frequencies)
    slope = terms * product / (1 + product**2)
    elastic = [np.broadcast_to(-glassy, (1, len(frequencies))), -terms, -2 * product * slope]
    viscous = [np.zeros((1, len(frequencies))), -terms * product, (1 - product**2) * slope]
    return np.stack([np.concatenate(elastic).T, np.concatenate(viscous).T])


def _terms(logarithms: Array, frequencies: Array) -> tuple[Array, Array, Array]:
    """1/E0 with a last axis, 1/(E_i (1 + x^2)) and x = omega tau_i, the last two of shape (..., n, frequencies)."""
    units = logarithms.shape[-1] // 2
    product = np.exp(logarithms[..., units + 1 :, None]) * (2 * np.pi * np.asarray(frequencies))
    terms = np.exp(-logarithms[..., 1 : units + 1, None]) / (1 + product**2)
    return np.exp(-logarithms[..., :1]), terms, product


def objective(logarithms: Array, data: DmaData, form: str = "squared") -> Array:
    r"""Distance from the data, shape (...), of log constants of shape (..., 2n + 1).

    .. math::
        f = \|g\|^2 + \|v\|^2, \quad g_k = D_e(\omega_k) - D_e^{exp}(\omega_k), \quad v_k = D_v(\omega_k) - D_v^{exp}(\omega_k)

    in 1/Pa^2; with ``form="as_printed"`` it is :math:`\|g\| + \|v\|` in 1/Pa.

    Raises
    ------
    UnknownName
        If the form is none of ``FORMS``.

    Source: thesis section 4.5, eq. 4.5.2; errata E22.
    """
    _check_form(form)
    squares = ((compliance_parts(logarithms, data.frequencies) - data.parts) ** 2).sum(axis=-1)
    return squares.sum(axis=-1) if form == "squared" else np.sqrt(squares).sum(axis=-1)


def _check_form(form: str) -> None:
    if form not in FORMS:
        raise UnknownName("form of the objective", form, FORMS)


def objective_slopes(logarithms: Array, data: DmaData, form: str = "squared") -> Array:
    """Derivatives of ``objective`` by log constants of shape (2n + 1,), of the same shape; raises as that does."""
    _check_form(form)
    misfit = compliance_parts(logarithms, data.frequencies) - data.parts
    halved = np.einsum("kf,kfp->kp", misfit, part_sensitivities(logarithms, data.frequencies))
    if form == "squared":
        return np.asarray(2 * halved.sum(axis=0))
    norms = np.linalg.norm(misfit, axis=1)
    return np.asarray((halved / np.where(norms > 0, norms, 1.0)[:, None]).sum(axis=0))
