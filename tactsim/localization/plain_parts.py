"""Whether a reference is of the tissue that was read: the readings beside the estimated inclusions tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings, taxel_name
from tactsim.localization.reference_errors import SAME_TISSUE, TAXEL_ERROR, WORTH_SAYING, ReferenceErrors
from tactsim.sensors.response_errors import root_mean_square

REACH = 1.25
"""Distance in plan, in pitches, from which a taxel is beside an inclusion: those next to its own in row or column are not."""
LEAST = 4
"""Taxels that are needed for a verdict."""
SURE = 0.999
"""Probability with which readings that fit have both parts of their chi-square below the limits."""
ALONE = 0.2
"""Largest change of any other taxel, over that of a taxel that changes alone. Of balls drawn within a block of 20 mm between 3
rows of 3 taxels of 9 mm one in a hundred falls below it, near the corners; half of them are above 0.38."""


@dataclass(frozen=True)
class PlainParts:
    """How the readings of the plain parts compare with the reference.

    Attributes
    ----------
    taxels : number of taxels beside the inclusions
    common : chi-square of what is common to their change, a multiple of the reference, with the errors of one of the same tissue
    apart : chi-square of the rest, which differs from taxel to taxel
    factor : readings over reference that fits them best
    scaled_chi_square : that of what this factor leaves
    """

    taxels: int
    common: float
    apart: float
    factor: float
    scaled_chi_square: float

    @property
    def limits(self) -> tuple[float, float]:
        """Largest ``common`` and ``apart`` of readings that fit, together with the probability `SURE`."""
        common, apart = scipy.stats.chi2.ppf(np.sqrt(SURE), [1, self.taxels - 1])
        return float(common), float(apart)

    @property
    def fits(self) -> bool:
        """Whether the reference can be of this tissue."""
        common, apart = self.limits
        return self.common <= common and self.apart <= apart

    @property
    def fits_scaled(self) -> bool:
        """Whether it can be but for a common factor of stiffness and gain."""
        return self.scaled_chi_square <= float(scipy.stats.chi2.ppf(SURE, self.taxels - 1))


def plain_parts(readings: Readings, estimate: Estimate) -> PlainParts | None:
    r"""The plain parts of readings, as an estimate leaves them; None without a reference, or if too few taxels lie there.

    With the change d and the reference p of the n taxels whose centre is more than `REACH` pitches from every estimated centre,

    .. math:: \chi^2 = d \cdot S^{-1} d = \frac{(p \cdot d)^2 / |p|^2}{w + b^2 |p|^2} +
        \frac{|d|^2 - (p \cdot d)^2 / |p|^2}{w}, \qquad S = w 1 + b^2 p p^T, \quad w = 2 \sigma^2 + e_b^2 \overline{p^2}

    whose two parts have one and n - 1 degrees of freedom. Each has a limit of its own, for in their sum the n taxels would hide
    a factor; readings of the tissue of the reference bring either above its limit once in a thousand times. A factor f of the
    reference multiplies its errors too: what it leaves has the variance :math:`(1 + f^2) \sigma^2 + f^2 e_b^2 \overline{p^2}`.

    Source: the inverse of S after Sherman & Morrison 1950, doi:10.1214/aoms/1177729893.
    """
    return _of_taxels(readings, _beside(readings, estimate.inclusions))


def _of_taxels(readings: Readings, beside: Array) -> PlainParts | None:
    """The same of a mask (jaw, row, column) of taxels."""
    if readings.reference is None or readings.difference is None:
        return None
    reference = np.asarray(readings.reference, dtype=float)
    change, plain = readings.difference[beside], reference[beside]
    if len(plain) < LEAST or not plain.any():
        return None
    spread = TAXEL_ERROR * root_mean_square(reference) / root_mean_square(plain)
    errors = ReferenceErrors(plain, readings.noise, spread, SAME_TISSUE, 0.0)
    factor = 1 + float(plain @ change / (plain @ plain))
    along, left = (factor - 1) ** 2 * float(plain @ plain), change - (factor - 1) * plain
    rest, same = float(left @ left), errors.alone
    scaled = factor**2 * same + (1 - factor**2) * readings.noise**2
    return PlainParts(len(plain), along / (same + SAME_TISSUE**2 * float(plain @ plain)), rest / same, factor, rest / scaled)


def plain_parts_warning(readings: Readings, estimate: Estimate) -> str | None:
    """What the user must know if the plain parts do not fit the reference, or are too few to tell; None if nothing."""
    if words := _lone_taxel(readings):
        return words
    parts = plain_parts(readings, estimate)
    if parts is None:
        return _factor_without_plain_parts(estimate) or _multiple_under_inclusions(readings, estimate)
    if parts.fits:
        return None
    words = (
        f"the readings of the {parts.taxels} taxels away from the estimate do not fit the reference (chi-square of their common "
        f"factor {parts.common:.3g}, of a reference of the same tissue at most {parts.limits[0]:.3g}; of what it leaves "
        f"{parts.apart:.3g}, at most {parts.limits[1]:.3g})"
    )
    if not parts.fits_scaled:
        return f"{words}, nor any multiple of it: other friction, closing or inclusions; do not trust the place"
    if parts.factor < 0:
        return f"{words}: they have the opposite sign; forces are positive where the tissue presses; do not trust the place"
    words += f": they are {parts.factor:.3g} times as large, so tissue or sensors are not those of the reference"
    if estimate.factor is None:
        return (
            f"{words}; the estimate allows for no such factor, and may take it for an inclusion; give a reference of this tissue"
        )
    return f"{words}; the estimate allows for one common factor"


def _lone_taxel(readings: Readings) -> str | None:
    """That all taxels but one fit the reference, so that whatever is found rests on this one; None if it is not so.

    Why: a taxel of 18 that read 50 mN too much, with a noise of 1 mN, was an inclusion beside it with a probability of 1.
    """
    trusted = readings.trusted
    parts = _of_taxels(readings, trusted)
    if parts is None or parts.fits or readings.difference is None:
        return None
    change = np.where(trusted, np.abs(readings.difference), 0.0)
    lone = np.unravel_index(change.argmax(), change.shape)
    others = trusted.copy()
    others[lone] = False
    without = _of_taxels(readings, others)
    if without is None or not without.fits or change[others].max() > ALONE * change.max():
        return None
    name = taxel_name(*map(int, lone))
    return (
        f"all readings but that of taxel {name} fit the reference: a small inclusion close to it may do that, and so may a taxel "
        "that reads wrong; grasp again a little aside, or leave it out as dead"
    )


def _factor_without_plain_parts(estimate: Estimate) -> str | None:
    """That inclusions under nearly all taxels raise their readings as stiffer tissue does, if a factor is worth it; or None."""
    if not estimate.inclusions or estimate.factor is None or abs(estimate.factor - 1) < WORTH_SAYING:
        return None
    return (
        f"fewer than {LEAST} taxels lie away from the estimate: whether its factor of {estimate.factor:.3g} is of tissue and "
        "sensors, or is what the inclusions do to all readings, cannot be told; do not trust their stiffness and size"
    )


def _multiple_under_inclusions(readings: Readings, estimate: Estimate) -> str | None:
    """That a factor alone explains the readings of all taxels, where the estimate leaves none to test it; None if it does not.

    An estimator without a factor covers the block with inclusions rather than say that the tissue is another.
    """
    everywhere = _of_taxels(readings, readings.trusted) if estimate.inclusions else None
    if everywhere is None or everywhere.fits or not everywhere.fits_scaled or everywhere.factor < 0:
        return None
    return (
        f"fewer than {LEAST} taxels lie away from the estimate, and the readings of all {everywhere.taxels} are "
        f"{everywhere.factor:.3g} times the reference (chi-square of this common factor {everywhere.common:.3g}, of a reference "
        f"of the same tissue at most {everywhere.limits[0]:.3g}; of what it leaves {everywhere.scaled_chi_square:.3g}): tissue "
        "or sensors that are not those of the reference explain them without any inclusion; give a reference of this tissue"
    )


def _beside(readings: Readings, inclusions: Sequence[EstimatedInclusion]) -> Array:
    """Which taxels (jaw, row, column) lie beside all of these inclusions and can be trusted."""
    x, y = readings.taxel_places()
    places = np.stack(np.meshgrid(x, y), axis=-1)
    beside = np.ones(places.shape[:2], bool)
    for one in inclusions:
        beside &= _distance(places, one) > REACH * readings.layout.pitch
    return beside & readings.trusted


def _distance(places: Array, one: EstimatedInclusion) -> Array:
    """From places (..., 2) in m to the centre of an inclusion, or the centre line of a tube, in plan."""
    begin, end = (np.array(point[:2]) for point in (one.line or (one.center, one.center)))
    along = end - begin
    length = float(along @ along)
    share = np.clip((places - begin) @ along / length, 0.0, 1.0) if length > 0 else np.zeros(places.shape[:-1])
    return np.linalg.norm(places - begin - share[..., None] * along, axis=-1)
