"""A ball of another stiffness in a large body of incompressible tissue that is strained: Eshelby's closed form."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array

RIGID_CONTRAST = 2.5
"""Contrast of a small rigid ball in incompressible tissue."""


def eshelby_contrast(shear_ratio: Array) -> Array:
    r"""Contrast of a small ball in incompressible tissue, dimensionless, for its shear modulus over that of the tissue.

    .. math:: c = \frac{5 (k - 1)}{2 k + 3}

    It has the shape of the ratio and lies between -5/3 (a hole) and 5/2 (rigid).

    Source: J. D. Eshelby 1957, doi:10.1098/rspa.1957.0133, for nu = 1/2.
    """
    ratio = np.asarray(shear_ratio, dtype=float)
    return 5 * (ratio - 1) / (2 * ratio + 3)


def stiffness_ratio_of(contrast: float) -> float:
    r"""Stiffness of a small ball over that of the tissue at the working strain, dimensionless, from its contrast c.

    .. math:: k = \frac{5 + 3 c}{5 - 2 c}

    The inverse of :func:`eshelby_contrast`: 1 for tissue, 0 for a hole, infinite from c = 5/2 on, where the ball is as good as
    rigid, or too large for a small one.

    Source: J. D. Eshelby 1957, doi:10.1098/rspa.1957.0133, for nu = 1/2, solved for the ratio.
    """
    if contrast >= RIGID_CONTRAST:
        return float("inf")
    return max(0.0, (5 + 3 * contrast) / (5 - 2 * contrast))


def displacement_by_ball(places: Array, radius: float, strain: Array, shear_ratio: float) -> Array:
    r"""Displacement (n, 3) in m that a bonded ball adds to that of a uniform strain, both materials incompressible.

    .. math::

        u = -\frac{2 c}{5} \left[ \frac52 \left( \frac{a^3}{r^3} - \frac{a^5}{r^5} \right) \frac{x \cdot E x}{r^2} x
            + \frac{a^5}{r^5} E x \right], \qquad u = -\frac{2 c}{5} E x \quad (r \le a)

    with the contrast :math:`c` of `eshelby_contrast`. The strain inside is uniform: :math:`5 / (2 k + 3)` times that outside.

    Parameters
    ----------
    places : (n, 3) in m from the ball's centre
    radius : :math:`a` in m
    strain : :math:`E` (3, 3) far from the ball, symmetric and without change of volume
    shear_ratio : :math:`k`, shear modulus of the ball over that of the tissue

    Source: J. D. Eshelby 1957, doi:10.1098/rspa.1957.0133, for the strain inside; outside the field of a rigid ball, A. Einstein
    1906, doi:10.1002/andp.19063240204, in proportion to what is missing at its surface.
    """
    distance = np.maximum(np.linalg.norm(places, axis=1), np.finfo(float).tiny)[:, None]
    strained, direction, near = places @ strain, places / distance, np.minimum(1.0, radius / distance)
    along = (direction * strained).sum(axis=1, keepdims=True) * direction
    missing = float(eshelby_contrast(np.array(shear_ratio))) / RIGID_CONTRAST
    return -missing * (2.5 * (near**3 - near**5) * along + near**5 * strained)
