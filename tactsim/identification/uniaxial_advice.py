"""Which form of the energy to take for a curve, of those that were fitted to it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from tactsim.identification.uniaxial import STRESS_FLOOR, UniaxialFit, named_terms

LEVEL = 0.05
"""Probability at which a form that is as good as the best one is called worse."""


def advised_form(fits: Sequence[UniaxialFit]) -> UniaxialFit | None:
    r"""The strongly elliptic fit of fewest constants that is not significantly worse than the best of them; None without one.

    With :math:`S` the sum of squares of what a fit of the other points misses a point by, :math:`m` constants and :math:`f`
    degrees of freedom, those of independent points, a form is worse than the best one, b, if

    .. math:: \frac{(S - S_b) / (m_b - m)}{S_b / f_b} > F_{0.95}(m_b - m, f_b)

    An error below ``STRESS_FLOOR`` is taken for that: no load cell tells it apart.

    Source: Bates & Watts, Nonlinear regression analysis, 1988, 3.10 (the F test of nested models), with the errors of points
    left out.
    """
    known = [fit for fit in fits if fit.stability.strongly_elliptic and fit.certainty.noise.known]
    if not known:
        return None
    best = min(known, key=_missed)
    fewer = [fit for fit in known if _constants(fit) < _constants(best) and not _worse(fit, best)]
    return min(fewer, key=lambda fit: (_constants(fit), _missed(fit)), default=best)


def advice(fits: Sequence[UniaxialFit]) -> str:
    """Which form to take and why, in a line; empty if there is no choice."""
    form = advised_form(fits)
    if form is None or len(fits) < 2:
        return ""
    return (
        f"take {form.form}: of the strongly elliptic forms that follow this curve not significantly worse than the best of them "
        f"(F test, {100 * LEVEL:.0f} %) it has the fewest constants, {_constants(form)}"
    )


def _missed(fit: UniaxialFit) -> float:
    """Mean square of what a fit of the other points misses a point by."""
    return max(float(np.mean(fit.certainty.noise.deviations**2)), STRESS_FLOOR**2)


def _constants(fit: UniaxialFit) -> int:
    return len(named_terms(fit.material))


def _worse(fit: UniaxialFit, best: UniaxialFit) -> bool:
    """Whether a form of fewer constants is significantly worse than the best one."""
    freed, freedom = _constants(best) - _constants(fit), best.certainty.noise.freedom
    ratio = (_missed(fit) - _missed(best)) / freed / (_missed(best) / freedom)
    return bool(ratio > scipy.stats.f.ppf(1 - LEVEL, freed, freedom))
