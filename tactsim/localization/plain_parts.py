"""Whether a reference is of the tissue that was read: the readings beside the estimated inclusions tell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.localization.reference_errors import SAME_TISSUE, TAXEL_ERROR, ReferenceErrors

REACH = 1.25
"""Distance in plan, in pitches, from which a taxel is beside an inclusion: those next to its own in row or column are not."""
LEAST = 4
"""Taxels that are needed for a verdict."""
SURE = 0.999
"""Probability with which readings that fit have a chi-square below the limit."""


@dataclass(frozen=True)
class PlainParts:
    """How the readings of the plain parts compare with the reference.

    Attributes
    ----------
    taxels : number of taxels beside the inclusions
    chi_square : of their change, with the errors of a reference of the same tissue
    factor : readings over reference that fits them best
    scaled_chi_square : that of what this factor leaves
    """

    taxels: int
    chi_square: float
    factor: float
    scaled_chi_square: float

    @property
    def limit(self) -> float:
        """Largest chi-square of readings that fit, with the probability `SURE`."""
        return float(scipy.stats.chi2.ppf(SURE, self.taxels))

    @property
    def fits(self) -> bool:
        """Whether the reference can be of this tissue."""
        return self.chi_square <= self.limit

    @property
    def fits_scaled(self) -> bool:
        """Whether it can be but for a common factor of stiffness and gain."""
        return self.scaled_chi_square <= float(scipy.stats.chi2.ppf(SURE, self.taxels - 1))


def plain_parts(readings: Readings, estimate: Estimate) -> PlainParts | None:
    r"""The plain parts of readings, as an estimate leaves them; None without a reference, or if too few taxels lie there.

    With the change d and the reference p of the n taxels whose centre is more than `REACH` pitches from every estimated centre,

    .. math:: \chi^2 = d \cdot S^{-1} d, \qquad S = (2 \sigma^2 + e_b^2 \overline{p^2}) 1 + b^2 p p^T

    which readings of the tissue of the reference bring above the limit once in a thousand times. A factor f of the reference
    multiplies its errors too: what it leaves has the variance :math:`(1 + f^2) \sigma^2 + f^2 e_b^2 \overline{p^2}`.
    """
    if readings.reference is None or readings.difference is None:
        return None
    beside = _beside(readings, estimate)
    reference = np.asarray(readings.reference, dtype=float)
    change, plain = readings.difference[beside], reference[beside]
    if len(plain) < LEAST or not plain.any():
        return None
    errors = ReferenceErrors(plain, readings.noise, TAXEL_ERROR * _rms(reference) / _rms(plain), SAME_TISSUE, 0.0)
    factor = 1 + float(plain @ change / (plain @ plain))
    squares = float(change @ np.linalg.solve(errors.covariance(0 * change), change))
    left = change - (factor - 1) * plain
    white = factor**2 * errors.white(0 * change) + (1 - factor**2) * readings.noise**2
    return PlainParts(len(plain), squares, factor, float(left @ left) / white)


def plain_parts_warning(readings: Readings, estimate: Estimate) -> str | None:
    """What the user must know if the plain parts do not fit the reference; None if they do."""
    parts = plain_parts(readings, estimate)
    if parts is None or parts.fits:
        return None
    words = (
        f"the readings of the {parts.taxels} taxels away from the estimate do not fit the reference (chi-square "
        f"{parts.chi_square:.3g}, of a reference of the same tissue at most {parts.limit:.3g})"
    )
    if not parts.fits_scaled:
        return f"{words}, nor any multiple of it: other friction, closing or inclusions; do not trust the place"
    if parts.factor < 0:
        return f"{words}: they have the opposite sign; forces are positive where the tissue presses; do not trust the place"
    words += f": they are {parts.factor:.3g} times as large, so tissue or sensors are not those of the reference"
    if estimate.factor is None:
        return f"{words}; the estimate takes that for an inclusion; give a reference of this tissue"
    return f"{words}; the estimate allows for one common factor"


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _beside(readings: Readings, estimate: Estimate) -> Array:
    """Which taxels (jaw, row, column) lie beside all estimated inclusions and can be trusted."""
    x, y = readings.taxel_places()
    places = np.stack(np.meshgrid(x, y), axis=-1)
    beside = np.ones(places.shape[:2], bool)
    for one in estimate.inclusions:
        beside &= _distance(places, one) > REACH * readings.layout.pitch
    both = np.broadcast_to(beside, readings.forces.shape)
    return both if readings.valid is None else both & readings.valid


def _distance(places: Array, one: EstimatedInclusion) -> Array:
    """From places (..., 2) in m to the centre of an inclusion, or the centre line of a tube, in plan."""
    begin, end = (np.array(point[:2]) for point in (one.line or (one.center, one.center)))
    along = end - begin
    length = float(along @ along)
    share = np.clip((places - begin) @ along / length, 0.0, 1.0) if length > 0 else np.zeros(places.shape[:-1])
    return np.linalg.norm(places - begin - share[..., None] * along, axis=-1)
