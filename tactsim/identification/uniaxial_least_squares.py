"""Least squares of a uniaxial curve in its constants, free or held strongly elliptic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.materials.homogeneous import principal_invariants
from tactsim.materials.invariant_polynomial import monomial_derivative, powers_of
from tactsim.materials.stability import PAIRS, EnergyDerivatives, shear_conditions
from tactsim.materials.stability_range import SCANNED

SMALLEST_SHEAR_FRACTION = 0.1
"""Assumption: a stable fit keeps every shear modulus of the ellipticity conditions above this part of its value at rest."""

NEGLIGIBLE = 1e-9
"""Part of the data that a stable fit must explain to be distinguished from round-off."""

STRETCH_STATES = 31
"""Values per principal stretch at which a stable fit imposes its conditions, even in the logarithm."""

TOUCHING = 1e-12
"""Part of the data by which a condition may be broken: round-off."""
PARALLEL = 1e-6
"""Directions of conditions that differ by less are one."""
MOST_ROUNDS = 300

TANGENTS = np.geomspace(1 / 16, 16, 9)
"""Ratios at which the third set of conditions is held; between two of them it may fall short by 3 % of its terms."""


@dataclass(frozen=True, eq=False)
class LeastSquares:
    r"""Weighted least squares of a design D = QR, with z = Rc and data y = Q^T target: the z nearest to y.

    With the conditions A z >= 0 of strong ellipticity it is y + A^T u, where u >= 0 makes |A^T u + y| smallest.

    Source: Moreau 1962 (decomposition by a cone and its polar); Lawson & Hanson 1974, Solving Least Squares Problems, chapter 23.
    """

    basis: Array
    """Q, shape (n, m)."""
    triangle: Array
    """R, shape (m, m)."""
    normals: Array | None
    """Columns of A^T of unit length, shape (m, conditions); None of a free fit."""

    @classmethod
    def of(cls, design: Array, names: tuple[str, ...], *, strongly_elliptic: bool) -> LeastSquares:
        """That of a weighted design (n, m) of the named constants."""
        Q, R = np.linalg.qr(design)
        if not strongly_elliptic:
            return cls(Q, R, None)
        normals = np.linalg.solve(R.T, ellipticity_rows(names).T)
        return cls(Q, R, normals / np.linalg.norm(normals, axis=0))

    def nearest(self, data: Array) -> Array:
        """z (m,) nearest to y (m,).

        Raises
        ------
        ConvergenceError
            If the conditions leave nothing, or the search for the nearest does not end.
        """
        nearest = self.projected(data)
        if self.normals is not None and np.linalg.norm(nearest) <= NEGLIGIBLE * np.linalg.norm(data):
            raise ConvergenceError(
                "stable fit: no strongly elliptic material of this form is nearer to the data than no stress at all"
            )
        return nearest

    def projected(self, data: Array) -> Array:
        """The same (m,), nearly zero where the conditions leave nothing.

        Raises
        ------
        ConvergenceError
            If the search for the nearest does not end.
        """
        return data if self.normals is None else _projected(data, self.normals, [])

    def projections(self, data: Array) -> Array:
        """The same of many y (draws, m).

        Raises
        ------
        ConvergenceError
            If the search for the nearest of one does not end.
        """
        held: list[int] = []
        return data if self.normals is None else np.stack([_projected(one, self.normals, held) for one in data])

    def constants(self, nearest: Array) -> Array:
        """Constants (m, ...) in Pa of z (m, ...)."""
        constants: Array = np.linalg.solve(self.triangle, nearest)
        return constants

    def fitted_basis(self, data: Array) -> Array:
        """Directions (n, k) of the residuals along which the data y (m,) alone decide: Q but for the conditions that hold z.

        Raises
        ------
        ConvergenceError
            If the search for the nearest does not end.
        """
        if self.normals is None:
            return self.basis
        pushed = self.projected(data)
        held = self.normals[:, pushed @ self.normals < TOUCHING * np.linalg.norm(data)]
        return self.basis @ scipy.linalg.null_space(held.T, rcond=PARALLEL) if held.size else self.basis


def _projected(data: Array, normals: Array, held: list[int]) -> Array:
    """The point nearest to y (m,) with all ``normals`` (m, conditions) at least 0.

    The conditions in ``held`` are tried first; what is broken most joins it until none is.
    """
    nearest, allowed = data, -TOUCHING * float(np.linalg.norm(data))
    for _ in range(MOST_ROUNDS):
        if held:
            try:
                pushes, _ = scipy.optimize.nnls(normals[:, held], -data)
            except RuntimeError as error:
                raise ConvergenceError(f"stable fit: {error}") from None
            nearest = data + normals[:, held] @ pushes
        margins = nearest @ normals
        worst = int(margins.argmin())
        if margins[worst] >= allowed:
            return nearest
        held.append(worst)
    raise ConvergenceError(f"stable fit: the conditions are not met after {MOST_ROUNDS} rounds")


def ellipticity_rows(names: tuple[str, ...]) -> Array:
    r"""Rows r (n, m) with r . c >= 0: the conditions of strong ellipticity, all convex in the m constants, as n linear ones.

    They are those of the energy less a part, ``SMALLEST_SHEAR_FRACTION``, of the neo-Hookean one of the same shear modulus. The
    third set, see `shear_conditions`, is the envelope of its tangents,

    .. math:: (\sqrt{d_i} + \sqrt{d_j})^2 + e_k = \min_{t > 0}\, (1 + t)\, d_i + (1 + 1/t)\, d_j + e_k

    of which those of ``TANGENTS`` are held.

    Source: the conditions are those of `shear_conditions`; the tangents are derived here, the least at
    :math:`t = \sqrt{d_j / d_i}`.
    """
    axis = np.geomspace(*SCANNED, STRETCH_STATES)
    first, second = (side.ravel() for side in np.meshgrid(axis, axis))
    states = np.stack([first, second, 1 / (first * second)])
    states = states[:, (first <= second) & (second <= states[2]) & (states[2] <= SCANNED[1])]
    invariants, unit = principal_invariants(states), np.ones(states.shape[1])
    neo_hookean = _conditions(EnergyDerivatives(unit, *(0 * unit,) * 4), states)
    rows = []
    for power in powers_of(dict.fromkeys(names, 1.0)):
        derivatives = [monomial_derivative(*invariants, power, order) for order in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))]
        rows.append(
            _conditions(EnergyDerivatives(*derivatives), states)
            - (SMALLEST_SHEAR_FRACTION if sum(power) == 1 else 0.0) * neo_hookean
        )
    matrix = np.stack(rows, axis=-1)
    return matrix / np.abs(matrix).max(axis=1, keepdims=True)


def _conditions(energy: EnergyDerivatives, states: Array) -> Array:
    """Every mu_k, every d_k, and the tangents of the third set, at states (3, n), flat."""
    shear, opposite, equal = shear_conditions(energy, states)
    tangents = [(1 + t) * opposite[i] + (1 + 1 / t) * opposite[j] + equal[k] for i, j, k in PAIRS for t in TANGENTS]
    return np.concatenate([shear.ravel(), opposite.ravel(), *tangents])
