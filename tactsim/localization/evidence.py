r"""How well one or two bodies of unknown contrast explain a change of the taxels' forces: Bayesian evidence.

The change d is whitened: it is S^T c plus Gaussian errors of variance 1, with rows s of S for the bodies and a normal prior of
standard deviation :math:`\sigma` for each contrast. With the contrasts integrated out,

.. math:: \ln p(d) = -\frac{d \cdot d - b^T A^{-1} b}{2} - \frac{1}{2} \ln\det \sigma^2 A,
    \quad A = S S^T + \frac{1}{\sigma^2} 1, \quad b = S d

but for a constant that only depends on the number of taxels. Two bodies are rewarded for what they explain and fined by the
determinant and by being averaged over all places, so that no other penalty for their number is needed.

Source: D. J. C. MacKay 1992, doi:10.1162/neco.1992.4.3.415.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.localization.candidates import Candidates
from tactsim.localization.reference_errors import ReferenceFit, single_evidence, whitened

BEGINNINGS = 4
"""Pairs of the coarse grid from which the search on the fine grid begins."""
DRAWS = 32
"""Bodies drawn near the best pairs, each of which is paired with every other one."""
ROWS = 64
"""Bodies that are held against all others at once: enough to count, few enough for the memory."""
ROUNDS = 2
"""Sweeps of the search; in each, either body of a pair moves to its best place while the other stays."""


@dataclass(frozen=True, eq=False)
class Explanation:
    """How well a class of bodies explains a change.

    Attributes
    ----------
    evidence : logarithm of the probability of the change under this class, averaged over all its members
    bodies : one or two draws from the posterior: candidate numbers (m,) of each
    weights : (m,) of the draws, adding up to 1
    contrasts, spreads : (m,) of each body: mean and variance of its contrast in each draw
    """

    evidence: float
    bodies: tuple[Array, ...]
    weights: Array
    contrasts: tuple[Array, ...]
    spreads: tuple[Array, ...]


@dataclass(frozen=True, eq=False)
class Change:
    """A change of the taxels' forces (taxels,), over its errors and dimensionless, and the prior of a contrast."""

    values: Array
    contrast_spread: float

    @classmethod
    def of_fit(cls, fit: ReferenceFit, contrast_spread: float) -> Self:
        """The change of a fit over the errors of the fit."""
        return cls(whitened(fit.change, fit.covariance), contrast_spread)

    @property
    def ridge(self) -> float:
        """One over the prior's variance."""
        return 1 / self.contrast_spread**2

    def single(self, candidates: Candidates) -> Explanation:
        """The evidence of single bodies: one of the candidates alone."""
        evidence, contrasts, spreads = single_evidence(candidates.signals, self.values, self.contrast_spread)
        total = float(scipy.special.logsumexp(evidence))
        weights = np.exp(evidence - total)
        numbers = np.arange(len(candidates))
        averaged = total - np.log(len(candidates)) + noise_evidence(self.values)
        return Explanation(averaged, (numbers,), weights, (contrasts,), (spreads,))

    def double(self, fine: Candidates, coarse: Candidates, generator: np.random.Generator) -> Explanation:
        r"""Two of the fine candidates that do not overlap, by importance sampling.

        All pairs of the coarse grid are tried; the best are moved on the fine one. Then bodies i are drawn with the probability
        q(i) that they have beside one of the best others, and paired with all others j:

        .. math:: p(d) = \frac{1}{m} \sum_{i \sim q} \frac{1}{\nu n^2 q(i)} \sum_j p(d | i, j)

        with the share :math:`\nu` of the n^2 pairs that do not overlap: the others are no members of the class.
        The evidence is minus infinity if all overlap, as in a block that has no room for two.
        """
        table = _Table(fine, self)
        likelihoods = [table.beside(partner) for partner in self._partners(table, coarse)]
        if not likelihoods:
            return _no_pair()
        totals = np.array([scipy.special.logsumexp(likelihood) for likelihood in likelihoods])
        q = sum(
            share * np.exp((likelihood - likelihood.max()) / 2) / np.exp((likelihood - likelihood.max()) / 2).sum()
            for share, likelihood in zip(_shares(totals), likelihoods, strict=True)
        )
        drawn = generator.choice(len(fine), DRAWS, p=q / q.sum())
        rows = [table.beside(int(i)) for i in drawn]
        logs = np.array([scipy.special.logsumexp(row) for row in rows]) - np.log(q[drawn] / q.sum())
        pairs = 2 * np.log(len(fine)) + np.log(fine.geometry.apart)
        evidence = float(scipy.special.logsumexp(logs)) - np.log(DRAWS) - pairs
        shares = np.exp(logs - scipy.special.logsumexp(logs))
        first, second = self._paired(fine, drawn, rows, generator)
        mean, spread = table.contrasts(first, second)
        evidence += noise_evidence(self.values)
        return Explanation(evidence, (first, second), np.repeat(shares / DRAWS, DRAWS), mean, spread)

    def _partners(self, table: _Table, coarse: Candidates) -> list[int]:
        """Bodies of the best pairs, as numbers of the fine candidates, which are few where the coarse ones have no pair."""
        partners, grid, pairs = list[int](), coarse, _best_pairs(coarse, self)
        if not pairs:
            grid, pairs = table.candidates, _best_pairs(table.candidates, self)
        for _, partner in pairs:
            fine = table.nearest(grid, partner)
            for _ in range(ROUNDS):
                other = int(table.beside(fine).argmax())
                fine = int(table.beside(other).argmax())
            partners += [number for number in (other, fine) if number not in partners]
        return partners

    def _paired(self, fine: Candidates, drawn: Array, rows: list[Array], generator: np.random.Generator) -> tuple[Array, Array]:
        """Both bodies (DRAWS^2,) of draws from the posterior; the first is always the one nearer to that of the best draw."""
        first, second = np.repeat(drawn, DRAWS), []
        for row in rows:
            weights = np.exp(row - row.max())
            second.append(generator.choice(len(fine), DRAWS, p=weights / weights.sum()))
        other, centers = np.concatenate(second), fine.geometry.centers
        best = int(np.argmax([row.max() for row in rows]))
        anchors = centers[int(drawn[best])], centers[int(rows[best].argmax())]
        straight, crossed = (
            np.linalg.norm(centers[first] - a, axis=1) + np.linalg.norm(centers[other] - b, axis=1)
            for a, b in (anchors, anchors[::-1])
        )
        swap = crossed < straight
        return np.where(swap, other, first), np.where(swap, first, other)


def over_errors(candidates: Candidates, fit: ReferenceFit) -> Candidates:
    """The candidates with their signals times the factor of a fit, over its errors and dimensionless."""
    return replace(candidates, signals=whitened(fit.factor * candidates.signals, fit.covariance))


def _no_pair() -> Explanation:
    """By a class without members."""
    none, numbers = np.zeros(0), np.zeros(0, int)
    return Explanation(-np.inf, (numbers, numbers), none, (none, none), (none, none))


def noise_evidence(values: Array) -> float:
    """Log probability of a whitened change (taxels,) that is noise only, up to a common constant."""
    return float(-(values @ values) / 2)


class _Table:
    """Products of all candidates with the change, from which the evidence of pairs follows."""

    def __init__(self, candidates: Candidates, change: Change):
        self.candidates, self.change = candidates, change
        self.along = candidates.signals @ change.values
        self.stiff = (candidates.signals**2).sum(axis=1) + change.ridge

    def beside(self, one: int) -> Array:
        """Log evidence (n,) of every candidate as the second one beside a given first, minus infinity where they overlap."""
        cross = self.candidates.signals @ self.candidates.signals[one]
        evidence = _pair_evidence(self.along, self.along[one], a=self.stiff, b=self.stiff[one], cross=cross, change=self.change)
        evidence[self.candidates.geometry.overlaps(one)] = -np.inf
        return evidence

    def contrasts(self, first: Array, second: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Means and variances of both contrasts in pairs (m,)."""
        signals = self.candidates.signals
        cross = (signals[first] * signals[second]).sum(axis=1)
        a, b, u, w = self.stiff[first], self.stiff[second], self.along[first], self.along[second]
        spreads = 1 / _remainder(a, b, cross, self.change), 1 / _remainder(b, a, cross, self.change)
        mean = spreads[1] * (w - cross * u / a)
        return ((u - cross * mean) / a, mean), spreads

    def nearest(self, coarse: Candidates, number: int) -> int:
        """The candidate most like one of another grid."""
        own, wanted = self.candidates.geometry, coarse.geometry
        ends = ((own.begins, wanted.begins), (own.ends, wanted.ends))
        away = sum(((points - point[number]) ** 2).sum(axis=1) for points, point in ends)
        return int(np.argmin(away + (own.radii - wanted.radii[number]) ** 2))


def _pair_evidence(u: Array, w: Array, *, a: Array, b: Array, cross: Array, change: Change) -> Array:
    """Log evidence, without the common part, of pairs of signals.

    ``u`` and ``w`` are the products of the two signals with the change, ``a`` and ``b`` their squares, ``cross`` their product.
    """
    remainder = _remainder(b, a, cross, change)
    explained = u**2 / a + (w - cross * u / a) ** 2 / remainder
    return explained / 2 - np.log(a / change.ridge * remainder / change.ridge) / 2


def _remainder(a: Array, b: Array, cross: Array, change: Change) -> Array:
    """Square of a signal less its part along another, which is at least what the prior adds, also where rounding leaves less."""
    return np.maximum(a - cross**2 / b, change.ridge)


def _best_pairs(coarse: Candidates, change: Change) -> list[tuple[int, int]]:
    """The best pairs of the coarse grid, no two of which share a body."""
    if not len(coarse):
        return []
    table = _Table(coarse, change)
    cross = coarse.signals @ coarse.signals.T
    evidence = _pair_evidence(
        table.along[:, None], table.along, a=table.stiff[:, None], b=table.stiff, cross=cross, change=change
    )
    for some in np.array_split(np.arange(len(coarse)), -(-len(coarse) // ROWS)):
        evidence[some] = np.where(coarse.geometry.overlaps(some), -np.inf, evidence[some])
    pairs: list[tuple[int, int]] = []
    for _ in range(BEGINNINGS):
        first, second = (int(k) for k in np.unravel_index(int(evidence.argmax()), evidence.shape))
        if not np.isfinite(evidence[first, second]):
            break
        pairs.append((first, second))
        evidence[[first, second]] = -np.inf
        evidence[:, [first, second]] = -np.inf
    return pairs


def _shares(totals: Array) -> Array:
    """Shares of the best partners in the proposal: tempered, so that none is left out."""
    shares = np.exp((totals - totals.max()) / 4)
    return shares / shares.sum()
