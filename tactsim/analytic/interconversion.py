r"""Exact interconversion of creep compliance and relaxation modulus with discrete times.

With the operational compliance :math:`C(s) = s \tilde J` and modulus :math:`M(s) = s \tilde G`, the two are bound by
:math:`C M = 1`. At :math:`s = -x` both are sums over the rates (reciprocal times) of a model, so that the poles of one are
the zeros of the other. The residues are taken from the products over zeros and poles: a zero has an error of round-off relative
to its own size, and so has the product wherever :math:`\mathrm{Re}\, s \ge 0`, near-equal times included.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.array import Array
from tactsim.errors import InvalidQuantity


def maxwell_of(kelvin: GeneralizedKelvin) -> GeneralizedMaxwell:
    r"""The generalized Maxwell model with the same behaviour.

    With :math:`\lambda_i = 1/\tau_i` and :math:`w_i = J_i \lambda_i`, and a pole 0 of weight :math:`\varphi` for a fluid,

    .. math::
        C(x) = J_0 + \sum_i \frac{w_i}{\lambda_i - x}, \quad C(x_k) = 0, \quad
        \tau_k = \frac{1}{x_k}, \quad G_k = \frac{1}{x_k C'(x_k)}, \quad G_\infty = \frac{1}{C(0)}

    One root lies above each pole.

    Raises
    ------
    InvalidQuantity
        If the compliances and times are so many decades apart that a result leaves the range of floats.

    Source: Gross 1953, Mathematical Structure of the Theories of Viscoelasticity; Tschoegl 1989, chapter 8.
    """
    with representable():
        poles = RateSum(kelvin.glassy_compliance, kelvin.fluidity, kelvin.compliances / kelvin.times, kelvin.times)
        times, residues = poles.roots()
        return GeneralizedMaxwell(1 / kelvin.equilibrium_compliance, times * residues, times)


def kelvin_of(maxwell: GeneralizedMaxwell) -> GeneralizedKelvin:
    r"""The generalized Kelvin model with the same behaviour.

    With :math:`x_k = 1/\tau_k`,

    .. math::
        M(x) = G_\infty - x \sum_k \frac{G_k}{x_k - x} = -x S(x), \quad
        S(x) = \frac{G_\infty}{0 - x} + \sum_k \frac{G_k}{x_k - x}, \quad S(\lambda_i) = 0,

        \tau_i = \frac{1}{\lambda_i}, \quad J_i = \frac{1}{\lambda_i |M'(\lambda_i)|} = \frac{1}{\lambda_i^2 S'(\lambda_i)},
        \quad J_0 = \frac{1}{G(0)}

    One root lies below each pole. For :math:`G_\infty = 0` the lowest is 0, and :math:`\varphi = 1/S(0) = 1/\sum_k G_k \tau_k`.

    Raises
    ------
    InvalidQuantity
        If the moduli and times are so many decades apart that a result leaves the range of floats.

    Source: Gross 1953, Mathematical Structure of the Theories of Viscoelasticity; Tschoegl 1989, chapter 8.
    """
    with representable():
        times, residues = RateSum(0.0, maxwell.equilibrium_modulus, maxwell.moduli, maxwell.times).roots()
        viscosity = math.fsum(maxwell.moduli * maxwell.times)
        fluidity = 0.0 if maxwell.equilibrium_modulus else 1 / viscosity
        return GeneralizedKelvin(1 / maxwell.instantaneous_modulus, times**2 * residues, times, fluidity=fluidity)


@contextmanager
def representable() -> Iterator[None]:
    """A block in which a number that leaves the range of floats is an error.

    Raises
    ------
    InvalidQuantity
        If strengths or times are so many decades apart that a number overflows.
    """
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            yield
    except (ArithmeticError, ValueError) as error:
        raise InvalidQuantity("strengths and times are too many decades apart; allowed: about 100 decades") from error


@dataclass(frozen=True, eq=False)
class RateSum:
    r"""The function of a rate x in 1/s, increasing between its poles,

    .. math:: f(x) = c + \frac{w_0}{0 - x} + \sum_j \frac{w_j}{1/T_j - x}

    Parameters
    ----------
    constant, weight_at_zero : float
        ``c >= 0`` and ``w_0 >= 0``; a zero weight is no pole.
    weights, times : array
        ``w_j > 0`` and ``T_j > 0`` in s, increasing, shape (n,).

    Source: Gross 1953, Mathematical Structure of the Theories of Viscoelasticity: the roots are the rates of the inverse
    function.
    """

    constant: float
    weight_at_zero: float
    weights: Array
    times: Array

    def roots(self) -> tuple[Array, Array]:
        """Reciprocals (m,) in s of the roots of f, and 1 / f' (m,) there, in increasing order of the root.

        A root lies between each two neighbouring poles and, for c > 0, one above the last. Each is computed as its offset from
        the nearer pole, so that all differences of rates keep their digits (Li 1993, LAPACK Working Note 89).
        """
        weights, times = self.weights[::-1], self.times[::-1]
        differences = rate_differences(times)
        if self.weight_at_zero:
            rates = 1 / times
            differences = np.block([[np.zeros((1, 1)), -rates[None]], [rates[:, None], differences]])
            weights, times = np.append(self.weight_at_zero, weights), np.append(np.inf, times)
        roots = [self._between(k, differences, weights) for k in range(len(times) - 1)]
        if self.constant and len(times):
            roots.append((len(times) - 1, self._above_last(differences[:, -1], weights)))
        anchors = np.array([anchor for anchor, _ in roots], dtype=int)
        offsets = np.array([offset for _, offset in roots])
        pole_to_root = differences[:, anchors] - offsets
        root_to_root = pole_to_root[anchors] + offsets[:, None]
        return 1 / (1 / times[anchors] + offsets), self._residues(np.abs(pole_to_root), np.abs(root_to_root), weights.sum())

    def _residues(self, pole_to_root: Array, root_to_root: Array, total: float) -> Array:
        r"""1 / f' at the roots r_k from the distances of rates, shapes (poles, roots) and (roots, roots).

        .. math::
            \frac{1}{f'(r_k)} = \frac{\prod_j |p_j - r_k|}{c \prod_{l \ne k} |r_l - r_k|}, \quad
            c \to \sum_j w_j \text{ where } c = 0

        Source: Gu & Eisenstat 1994, doi:10.1137/S089547989223924X, whose weights of given roots these are.
        """
        diagonal = np.eye(len(root_to_root), dtype=bool)
        ratios = pole_to_root[: len(diagonal)] / np.where(diagonal, 1.0, root_to_root)
        last = 1 / self.constant if self.constant else pole_to_root[-1] / total
        return ratios.prod(axis=0) * last

    def _between(self, k: int, differences: Array, weights: Array) -> tuple[int, float]:
        """The nearer pole to the root between poles k and k + 1, and the offset of the root from it."""
        half = differences[k + 1, k] / 2
        if balance(half, self.constant, differences[:, k], weights) > 0:
            opposed = self.constant + 2 * (weights[k + 1 :] / differences[k + 1 :, k]).sum()
            return k, root_offset(self.constant, differences[:, k], weights, (weights[k] / opposed, half))
        opposed = -2 * (weights[: k + 1] / differences[: k + 1, k + 1]).sum()
        return k + 1, -root_offset(-self.constant, -differences[:, k + 1], weights, (weights[k + 1] / opposed, half))

    def _above_last(self, differences: Array, weights: Array) -> float:
        """The offset of the root above the last pole from this pole, bounded by the last weight and by all of them."""
        bounds = weights[-1] / self.constant, weights.sum() / self.constant
        return root_offset(self.constant, differences, weights, bounds)


def rate_differences(times: Array) -> Array:
    """1/T_j - 1/T_k in 1/s, shape (n, n), from the differences of the times, so that near-equal times keep their digits."""
    return (times - times[:, None]) / times / times[:, None]


def balance(offset: float, constant: float, differences: Array, weights: Array) -> float:
    """constant + sum w_j / (d_j - offset), divided by the sum of the sizes of its terms; d and w (n,), d and offset in 1/s."""
    terms = weights / (differences - offset)
    size = abs(constant) + np.abs(terms).sum()
    return float((constant + terms.sum()) / size)


def root_offset(constant: float, differences: Array, weights: Array, bounds: tuple[float, float]) -> float:
    """The positive root in 1/s of ``balance`` between ``bounds``, at the lower of which it is negative but for round-off.

    ``differences`` (n,) and ``bounds`` are in 1/s, ``weights`` (n,) as in `RateSum`.

    Brent's method in the logarithm of the offset, which may be many decades below the distance of the poles, to 1e-6; then three
    steps of Newton's method, whose relative error squares, since no pole is nearer to the root than the offset.
    """
    low, high = bounds[0] / 2, bounds[1]

    def at_logarithm(z: float) -> float:
        return balance(low * math.exp(z), constant, differences, weights)

    end = math.log(high / low)
    if at_logarithm(end) <= 0:
        return high
    logarithm = scipy.optimize.brentq(at_logarithm, 0.0, end, xtol=1e-6, maxiter=1000)
    offset = low * math.exp(logarithm)
    for _ in range(3):
        terms = weights / (differences - offset)
        newton = offset - (constant + terms.sum()) / (terms / (differences - offset)).sum()
        offset = min(max(newton, low), high)  # round-off of far poles may exceed the gap of near-equal times
    return float(offset)
