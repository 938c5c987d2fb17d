"""How well a uniaxial curve determines the constants of a form, and what it says nothing of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.identification.certainty import COVERED, Noise, intervals, noise_of
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.identification.uniaxial_least_squares import LeastSquares

DETERMINED = 0.25
"""Assumption: a curve determines a constant if half its interval is worth less than this part of the stress (rms)."""
AT_REST = ("c10", "c01")
"""Twice the sum of these is the shear modulus at rest."""
ROUND_OFF = 1e-9
"""Part of an interval below which one of its ends is 0, and of a stress below which a residual is no error of the form."""
LARGEST_STRAIN = 10.0
"""Assumption: no rubber or tissue is stretched further, by 1000 %."""
BARELY_STRETCHED = 0.05
"""Assumption: a curve that ends within this strain of rest holds nothing of that side."""


@dataclass(frozen=True)
class UniaxialCertainty:
    """What other curves of the same noise would have given, if the form is true."""

    intervals: dict[str, tuple[float, float]]
    """Constant -> lower and upper end in Pa of its interval of 95 %; infinite where no point is to spare."""
    shear_modulus: tuple[float, float]
    """The same of the shear modulus at rest, which is that of no material below 0."""
    undetermined: tuple[str, ...]
    """Constants whose value may be exchanged for that of others."""
    noise: Noise
    """Of the weighted residuals."""

    def warnings(self, largest_error: float) -> tuple[str, ...]:
        """What cannot be relied on, in words."""
        warnings = []
        if self.undetermined:
            modulus = f" and the shear modulus at rest, {_range(self.shear_modulus)}" if _finite(self.shear_modulus) else ""
            warnings.append(
                f"the curve does not determine {' and '.join(self.undetermined)} one by one, only the stress where it was "
                f"measured{modulus}: use a form of fewer constants or measure another deformation"
            )
        if self.noise.in_runs and largest_error > ROUND_OFF:
            warnings.append(
                f"the residuals come in runs of one sign: the form does not follow the curve, which it misses by up to "
                f"{100 * largest_error:.1f} %; the intervals are wide for it and hold for this form only: take fewer strains"
            )
        return tuple(warnings)

    def __str__(self) -> str:
        """The intervals in a line."""
        ranges = ", ".join(_named_range(name, ends) for name, ends in self.intervals.items())
        open_ends = f"; not determined one by one: {', '.join(self.undetermined)}" if self.undetermined else ""
        return (
            f"{100 * COVERED:.0f} % intervals: {ranges}, {_named_range('shear modulus at rest', self.shear_modulus)}{open_ends}"
        )


def certainty(squares: LeastSquares, design: Array, target: Array, names: tuple[str, ...]) -> UniaxialCertainty:
    r"""What noise leaves open of a fit of a weighted design (n, m) to a target (n,).

    The noise is that of the residuals, see `noise_of`; its draws are added to the data :math:`Q^T y` and fitted again, under the
    conditions of strong ellipticity if the fit was.
    """
    data = squares.basis.T @ target
    noise = noise_of(target - squares.basis @ squares.projected(data), squares.fitted_basis(data))
    if not noise.known:
        everything = (-np.inf, np.inf)
        return UniaxialCertainty(dict.fromkeys(names, everything), everything, names, noise)
    fitted = squares.constants(squares.projections(data + noise.drawn(squares.basis)).T)
    ends = intervals(fitted.T)
    worth = np.diff(ends, axis=0)[0] / 2 * np.sqrt(np.mean(design**2, axis=0))
    at_rest = [name in AT_REST for name in names]
    low, high = (max(0.0, float(end)) for end in intervals(2 * fitted[at_rest].sum(axis=0)))
    return UniaxialCertainty(
        intervals={name: (float(ends[0, k]), float(ends[1, k])) for k, name in enumerate(names)},
        shear_modulus=(low, high),
        undetermined=tuple(name for name, value in zip(names, worth, strict=True) if value > DETERMINED),
        noise=noise,
    )


def wrong_signs(curve: UniaxialCurve) -> tuple[str, ...]:
    """Names points whose stress has another sign than their strain, in words: a fit of relative errors is ruled by them."""
    wrong = np.flatnonzero(curve.nominal_stress * (curve.stretch - 1) < 0)
    if not wrong.size:
        return ()
    at, stress = curve.stretch[wrong[0]], pressure_text(float(curve.nominal_stress[wrong[0]]))
    return (
        f"{wrong.size} of {curve.stretch.size} points have a stress against their strain, such as {stress} at a strain of "
        f"{at - 1:.3g}, of slack or of an offset of the load cell; they rule a fit of relative errors: leave them out or fit "
        "absolute errors",
    )


def large_strains(curve: UniaxialCurve) -> tuple[str, ...]:
    """What strains beyond any tissue suggest, in words: that they are in percent."""
    largest = float(curve.stretch.max()) - 1
    if largest <= LARGEST_STRAIN:
        return ()
    percent = f"{largest:.4g} ({100 * largest:.4g} %)"
    return (f"strains reach {percent}: if they are in percent, say so in the header, such as strain [%]",)


def one_sided(curve: UniaxialCurve) -> tuple[str, ...]:
    """What a curve of one sign, or of small strains alone, leaves open, in words."""
    tension, compression = float(curve.stretch.max()) - 1, 1 - float(curve.stretch.min())
    if max(tension, compression) < BARELY_STRETCHED:
        largest = f"no strain of the curve exceeds {100 * max(tension, compression):.2g} %"
        return (f"{largest}, which says nothing of larger ones; a threshold pressure depends on them",)
    if tension < BARELY_STRETCHED:
        return ("the curve is compression alone, which says nothing of tension; a threshold pressure depends on it",)
    if compression < BARELY_STRETCHED:
        return ("the curve is tension alone, which says little of compression; what lies under a sensor is compressed",)
    return ()


def _finite(ends: tuple[float, float]) -> bool:
    return bool(np.isfinite(ends).all())


def _named_range(name: str, ends: tuple[float, float]) -> str:
    """A name with its interval, or that it has none."""
    return f"{name} {_range(ends)}" if _finite(ends) else f"{name}: not determined"


def _range(ends: tuple[float, float]) -> str:
    """Both ends in one unit, three digits each."""
    largest = max(map(abs, ends))
    unit, factor = _unit(largest)
    low, high = (f"{(0.0 if abs(end) < ROUND_OFF * largest else end) * factor:.3g}" for end in ends)
    return f"{low} to {high} {unit}"


def pressure_text(value: float) -> str:
    """A constant as a case file has it, five digits; never in mPa, a letter from MPa."""
    unit, factor = _unit(abs(value))
    return f"{value * factor:.5g} {unit}"


def _unit(size: float) -> tuple[str, float]:
    return next(((unit, factor) for unit, factor in (("MPa", 1e-6), ("kPa", 1e-3)) if size * factor >= 1), ("Pa", 1.0))
