r"""How far a reference can be trusted: a common factor of stiffness and of gain, and errors from taxel to taxel.

Where the closing is prescribed, every force is in proportion to the moduli: tissue that is f times as stiff as that of the
reference p reads f times as much, with a lump of contrast c and response s too, and so do sensors whose gain is f times as large:

.. math:: y = f (p + c s), \qquad d = y - p = (f - 1) p + f c s

One factor stands for both, which such readings cannot tell apart. (Under a prescribed force they could: the sum of a jaw's
readings over that force is the gain.) Its prior is a mixture around one: either the tissue is that of the reference and f is
known to b, or it is another and the deviation of f is :math:`\tau` more; both are taken as normal, which a log-normal one is to
first order. f is integrated out: it adds :math:`b^2 p p^T`, or :math:`(b^2 + \tau^2) p p^T`, to the covariance of d.

Source of the evidence: D. J. C. MacKay 1992, doi:10.1162/neco.1992.4.3.415.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InputError

SAME_TISSUE = 0.02
"""b: standard deviation of the factor where the reference is of the same tissue; closing and friction are not known exactly."""
OTHER_TISSUE = 0.25
""":math:`\\tau`: that of the factor where it is of another tissue, or was read by other sensors."""
TAXEL_ERROR = 0.015
"""e_b: error of the reference from taxel to taxel over its root mean square."""
ROUNDS = 3
"""Times that the error of the forward model follows the factor."""
THINNING = 7
"""Of the candidates from which the factor is estimated in these rounds: every so manyth."""
ROUNDING = 1e-12
"""Of a change over the largest reading of the reference."""
WORTH_SAYING = 0.05
"""Least distance of a factor from one that is put into words."""
UNCHANGED = "no inclusion: the readings are those of the reference"
"""Why nothing is there, in words."""


@dataclass(frozen=True, eq=False)
class ReferenceErrors:
    r"""Gaussian errors of a change of force from a reference.

    .. math:: S = \bigl(v + e_m^2 \overline{a^2}\bigr) 1 + \beta^2 p p^T, \quad v = 2 \sigma^2 + e_b^2 \overline{p^2}

    Attributes
    ----------
    plain : p (taxels,) in N, the reference
    noise : :math:`\sigma` of a reading in N
    taxel : e_b, error from taxel to taxel over the root mean square of p
    factor : :math:`\beta`, standard deviation of the common factor
    model : e_m, error of the forward model over the root mean square of the change a that a body makes
    """

    plain: Array
    noise: float
    taxel: float
    factor: float
    model: float

    @property
    def alone(self) -> float:
        """v: variance in N^2 from taxel to taxel without a body."""
        return float(2 * self.noise**2 + self.taxel**2 * np.mean(self.plain**2))

    def white(self, left: Array) -> float:
        """Variance in N^2 from taxel to taxel beside a body, from what the factor leaves of a change (taxels,) in N.

        Its mean square less v is that of what the body adds: errors alone, which vary by chance, are no body's.
        """
        return float(self.alone + self.model**2 * max(np.mean(left**2) - self.alone, 0.0))

    def covariance(self, left: Array) -> Array:
        """S (taxels, taxels) in N^2 beside a body, from what the factor leaves of a change (taxels,) in N."""
        return self.white(left) * np.eye(self.plain.size) + self.factor**2 * np.outer(self.plain, self.plain)

    def excess(self, change: Array, white: float) -> float:
        """Mean of f - 1 for a change (taxels,) in N that is nothing else, of this variance from taxel to taxel in N^2."""
        strength = float(self.plain @ self.plain)
        return float(self.plain @ change) / (strength + white / self.factor**2) if self.factor * strength > 0 else 0.0


@dataclass(frozen=True, eq=False)
class ReferenceFit:
    """What a change of force is, by one prior of the factor.

    Attributes
    ----------
    change : d (taxels,) in N
    errors : of the reference, with that prior
    covariance : S (taxels, taxels) in N^2 beside a body
    evidence : (n,) logarithmic, of each candidate over that of errors of the covariance S alone
    contrasts, spreads : (n,) mean and variance of the contrast of each candidate, times the factor
    factor : mean of f beside a body
    """

    change: Array
    errors: ReferenceErrors
    covariance: Array
    evidence: Array
    contrasts: Array
    spreads: Array
    factor: float

    @property
    def total(self) -> float:
        """Logarithm of the mean of the evidence."""
        return float(scipy.special.logsumexp(self.evidence) - np.log(len(self.evidence)))

    @property
    def weights(self) -> Array:
        """Probability (n,) of each candidate, if there is one."""
        return np.exp(self.evidence - scipy.special.logsumexp(self.evidence))

    @property
    def evidence_of_body(self) -> float:
        """Logarithmic probability density of the change beside a body, without the constant of its dimension."""
        return self.total + log_density(self.change, self.covariance)

    @property
    def evidence_of_none(self) -> float:
        """The same without a body; minus infinity if the errors leave no room for any change."""
        alone = self.errors.covariance(0 * self.change)
        return log_density(self.change, alone) if alone[0, 0] > 0 else -np.inf

    @property
    def log_whitening(self) -> float:
        """Logarithm of the density of a change over that of what `whitened` makes of it."""
        return float(-np.log(np.diag(scipy.linalg.cholesky(self.covariance, lower=True))).sum())

    @property
    def likelihood(self) -> float:
        """Logarithmic probability density of the change if a body is as likely as none, without the same constant."""
        return float(np.logaddexp(self.evidence_of_none, self.evidence_of_body))

    @property
    def bare_factor(self) -> float:
        """Mean of f without a body."""
        return 1 + self.errors.excess(self.change, self.errors.alone)


def fitted(signals: Array, change: Array, errors: ReferenceErrors, contrast_spread: float) -> ReferenceFit:
    """How well one body of unknown contrast among candidates explains a change of force, and the factor that goes with it.

    The error of the forward model is a share of what the body adds, d - (f - 1) p without its errors, and follows the factor by
    iteration, from the one without a body on.

    Parameters
    ----------
    signals : (n, taxels) in N for a contrast of one
    change : d (taxels,) in N; not one that a factor explains without any error
    errors : of the reference and of the signals
    contrast_spread : standard deviation of the contrast beforehand

    Raises
    ------
    InputError
        If no error is left by which to weigh the change.
    """
    if errors.white(change) == 0:
        raise InputError(
            "the readings differ from the reference, and the noise and all errors of the estimator are 0; give noise or a "
            "model_error above 0"
        )
    plain, few = errors.plain, signals[::THINNING]
    excess = errors.excess(change, errors.alone)
    for _ in range(ROUNDS):
        left = change - excess * plain
        evidence, contrasts, _ = _single(few, change, errors.covariance(left), contrast_spread)
        body = (np.exp(evidence - scipy.special.logsumexp(evidence)) * contrasts) @ few
        excess = errors.excess(change - body, errors.white(left))
    covariance = errors.covariance(change - excess * plain)
    return ReferenceFit(change, errors, covariance, *_single(signals, change, covariance, contrast_spread), factor=1 + excess)


def without_error(change: Array, errors: ReferenceErrors) -> bool:
    """Whether a factor explains a change (taxels,) in N to rounding, although the errors leave no room for any other."""
    if errors.alone > 0:
        return False
    left = change - errors.excess(change, 0.0) * errors.plain
    return float(np.abs(left).max()) <= ROUNDING * float(np.abs(errors.plain).max())


def stated_factor(factor: float, spread: float) -> float | None:
    """The factor of a fit, None if the reference cannot be of another tissue: then what is fitted is the error of its own."""
    return factor if spread > 0 else None


def factor_words(factor: float | None) -> str:
    """What a user must know of a factor; nothing if it may be that of a reference of the same tissue."""
    if factor is None or abs(factor - 1) < WORTH_SAYING:
        return ""
    if factor < 0:
        return "; the readings have the opposite sign of the reference: forces are positive where the tissue presses"
    return f"; the readings are {factor:.3g} times those of the reference: stiffness and gain cannot be told apart"


def whitened(rows: Array, covariance: Array) -> Array:
    """Rows (..., taxels) in N of errors of a covariance (taxels, taxels) in N^2, turned into ones of the variance one."""
    root = scipy.linalg.cholesky(covariance, lower=True)
    return scipy.linalg.solve_triangular(root, rows.T, lower=True).T


def log_density(change: Array, covariance: Array) -> float:
    """Of a Gaussian of this covariance in N^2 at a change (taxels,) in N, without the constant of its dimension."""
    root = scipy.linalg.cholesky(covariance, lower=True)
    return float(-(scipy.linalg.solve_triangular(root, change, lower=True) ** 2).sum() / 2 - np.log(np.diag(root)).sum())


def _single(signals: Array, change: Array, covariance: Array, contrast_spread: float) -> tuple[Array, Array, Array]:
    """As `single_evidence`, of signals (n, taxels) and a change (taxels,) in N with errors of a covariance in N^2."""
    white = whitened(np.vstack([change, signals]), covariance)
    return single_evidence(white[1:], white[0], contrast_spread)


def single_evidence(signals: Array, change: Array, contrast_spread: float) -> tuple[Array, Array, Array]:
    """Logarithmic evidence (n,) over that of no signal, and mean and variance (n,) of the contrast.

    The signals (n, taxels) and the change (taxels,) are whitened: their errors are of variance 1.
    """
    stiff, along = (signals**2).sum(axis=1) + 1 / contrast_spread**2, signals @ change
    return along**2 / stiff / 2 - np.log(stiff * contrast_spread**2) / 2, along / stiff, 1 / stiff
