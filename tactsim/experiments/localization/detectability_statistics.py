r"""The smallest ball that a matched filter finds: the largest match over all places and radii against a threshold.

With forces d whose errors are Gaussian of standard deviation :math:`\sigma`, each possible ball with response s matches by
:math:`z = s \cdot d / (|s| \sigma)`, which is normal of standard deviation one around

.. math:: \lambda = c |s| / \sigma

for a ball of contrast c, and around zero without one. A ball is found if the largest :math:`|z|` over all candidates exceeds a
threshold; ``false_alarm_threshold`` finds it by seeded draws, as the candidates depend on each other.

Source: G. L. Turin 1960, doi:10.1109/TIT.1960.1057571, for the filter.
"""

from __future__ import annotations

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.deadline import check_time
from tactsim.localization.lump_response import LumpResponse

BLOCK_OF_DRAWS = 250
"""Draws that are matched together, which bounds the memory."""
FEWEST = 1e-4
"""Least radius in m that is sought: a tenth of a millimetre."""
CLOSE = 1e-7
"""Error in m of a radius found."""


def unit_templates(response: LumpResponse, every: int) -> Array:
    """Responses (n, taxels) of all tabulated balls at every ``every``-th radius, each over its own length."""
    flat = response.values[::every].reshape(-1, int(np.prod(response.values.shape[4:])))
    length = np.linalg.norm(flat, axis=1)
    kept = length > 1e-9 * length.max()
    return flat[kept] / length[kept, None]


def false_alarm_threshold(templates: Array, rate: float, *, draws: int, seed: int) -> float:
    """Threshold that the largest ``|z|`` of the templates (n, taxels) exceeds in a share ``rate`` of seeded draws of errors
    alone.

    Raises
    ------
    OutOfTime
        If the time limit has passed, or another thread has stopped the computation.
    """
    generator = np.random.default_rng(seed)
    largest = []
    for begin in range(0, draws, BLOCK_OF_DRAWS):
        check_time()
        errors = generator.standard_normal((min(BLOCK_OF_DRAWS, draws - begin), templates.shape[1]))
        largest.append(np.abs(errors @ templates.T).max(axis=1))
    return float(np.quantile(np.concatenate(largest), 1 - rate))


def detection_probability(match: Array, threshold: float) -> Array:
    r"""Probability that :math:`|z|` exceeds the threshold at the true place: :math:`\Phi(\lambda - t) + \Phi(-\lambda - t)`.

    The largest match over all candidates exceeds it at least as often. It has the shape of ``match``.
    """
    return scipy.special.ndtr(match - threshold) + scipy.special.ndtr(-match - threshold)


def smallest_radius(
    densities: Array, radii: Array, most: float, *, contrast: float, sigma: float, threshold: float, wanted: float
) -> float | None:
    r"""Smallest radius in m that is found with the probability ``wanted``, averaged over places; None if none up to ``most`` is.

    Parameters
    ----------
    densities : (places, R) in N/m^3, lengths |s| of the responses of balls of the tabulated ``radii`` (R,) over their volumes;
        between and beyond these it is linear and constant
    most : largest radius in m that fits
    """

    def excess(radius: float) -> float:
        volume = 4 / 3 * np.pi * radius**3
        length = volume * np.array([np.interp(radius, radii, one) for one in densities])
        return float(detection_probability(abs(contrast) * length / sigma, threshold).mean()) - wanted

    if most <= FEWEST or excess(most) < 0:
        return None
    if excess(FEWEST) > 0:
        return FEWEST
    return float(scipy.optimize.brentq(excess, FEWEST, most, xtol=CLOSE))
