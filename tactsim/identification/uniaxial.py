"""Mooney-Rivlin constants from a uniaxial curve: free fits, and a fit that keeps the material strongly elliptic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from pydantic import ValidationError

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity, UnknownName
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.materials.homogeneous import cauchy_stress, nominal_stress, principal_invariants, uniaxial
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.invariant_polynomial import InvariantPolynomial, monomial_derivative, powers_of
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
from tactsim.materials.mooney_rivlin_5 import MooneyRivlin5
from tactsim.materials.polynomial import Polynomial
from tactsim.materials.stability import PAIRS, shear_conditions
from tactsim.materials.stability_range import SCANNED, StabilityReport, stability_range


@dataclass(frozen=True)
class Form:
    """Which coefficients a fit may use, and the kind that holds them."""

    coefficients: tuple[str, ...]
    kind: type[InvariantPolynomial]
    strongly_elliptic: bool = False


FORMS = {
    "2-parameter": Form(("c10", "c01"), MooneyRivlin2),
    "3-parameter": Form(("c10", "c01", "c11"), MooneyRivlin3),
    "5-parameter": Form(("c10", "c01", "c20", "c11", "c02"), MooneyRivlin5),
    "stable": Form(("c10", "c01", "c11"), MooneyRivlin3, strongly_elliptic=True),
    "stable-c20": Form(("c10", "c01", "c20"), Polynomial, strongly_elliptic=True),
    "stable-c20-c11": Form(("c10", "c01", "c20", "c11"), Polynomial, strongly_elliptic=True),
    "stable-c20-c02": Form(("c10", "c01", "c20", "c02"), Polynomial, strongly_elliptic=True),
    "stable-c20-c30": Form(("c10", "c01", "c20", "c30"), Polynomial, strongly_elliptic=True),
}
"""Fits by name. ``stable`` is the thesis's own three-term energy, held strongly elliptic. The others that begin so fit a
compression curve as well and differ in every other deformation: their spread is what such a curve leaves open."""

SMALLEST_SHEAR_FRACTION = 0.1
"""Assumption: a stable fit keeps every shear modulus of the ellipticity conditions above this part of its value at rest."""

NEGLIGIBLE = 1e-9
"""Part of the data that a stable fit must explain to be distinguished from round-off."""

STRETCH_STATES = 31
"""Values per principal stretch at which a stable fit imposes its conditions, even in the logarithm."""


STRESS_FLOOR = 1e-4
"""Assumption: a relative error is taken of at least this part of the largest stress: what a load cell resolves."""


@dataclass(frozen=True)
class UniaxialFit:
    """A fitted material with its errors and its stability."""

    form: str
    material: InvariantPolynomial
    curve: UniaxialCurve
    max_relative_error: float
    """Largest relative error of the nominal stress, dimensionless."""
    rms_relative_error: float
    """Root mean square of the relative errors, dimensionless."""
    stability: StabilityReport


def uniaxial_nominal_stress(material: Hyperelastic, stretch: Array) -> Array:
    r"""Nominal stress in Pa at uniaxial stretches.

    .. math:: P = 2 (\lambda - \lambda^{-2}) (W_1 + W_2 / \lambda)

    Source: thesis 3.1.9 divided by the stretch, corrected: W1 and W2 keep the terms of c11.
    """
    return nominal_stress(material, "uniaxial", stretch)


def uniaxial_stress_as_printed(c10: float, c01: float, stretch: Array) -> Array:
    r"""True stress in Pa by the printed formula, which has no c11.

    .. math:: \sigma = 2 (\lambda^2 - \lambda^{-1}) (c_{10} + c_{01} / \lambda)

    Source: thesis 3.1.9 as printed; right for the two-parameter energy only.
    """
    return 2 * (stretch**2 - 1 / stretch) * (c10 + c01 / stretch)


def fit_uniaxial(curve: UniaxialCurve, form: str = "stable", *, relative: bool = True) -> UniaxialFit:
    r"""Least-squares fit of a form of ``FORMS`` to a curve; points at a stretch of exactly 1 determine nothing and are left out.

    .. math:: \min_c \sum_k w_k^2 (P(\lambda_k; c) - P_k)^2, \quad w_k = 1 / \max(|P_k|, \epsilon \max_j |P_j|)

    with :math:`\epsilon` = ``STRESS_FLOOR``, so that a point near rest, all noise, does not rule the fit. With ``relative`` false
    :math:`w_k = 1 / \max_j |P_j|`. The errors of the result are relative, by the first form of :math:`w_k`.

    Raises
    ------
    UnknownName
        If there is no such form.
    InvalidQuantity
        If the data do not determine the constants, or give a shear modulus that is not positive.
    ConvergenceError
        If no strongly elliptic material was found.
    """
    if form not in FORMS:
        raise UnknownName("form of the energy", form, FORMS)
    names = FORMS[form].coefficients
    loaded = curve.stretch != 1
    stretch, stress = curve.stretch[loaded], curve.nominal_stress[loaded]
    weight = 1 / (stress_size(curve)[loaded] if relative else np.full_like(stress, np.abs(stress).max()))
    design, target = weight[:, None] * unit_stresses(stretch, names), weight * stress
    if np.linalg.matrix_rank(design) < len(names):
        raise InvalidQuantity(f"{curve.source}: {stretch.size} points do not determine {len(names)} constants")
    fit = _elliptic_least_squares if FORMS[form].strongly_elliptic else _least_squares
    values = fit(design, target, names)
    material = _material(FORMS[form], values, curve.source)
    error = relative_errors(material, curve)[loaded]
    report = stability_range(material)
    if FORMS[form].strongly_elliptic and not report.strongly_elliptic:
        raise ConvergenceError(
            f"{curve.source}: the {form} fit is not strongly elliptic for all stretches {SCANNED[0]:g} to {SCANNED[1]:g}"
        )
    return UniaxialFit(form, material, curve, float(np.abs(error).max()), float(np.sqrt(np.mean(error**2))), report)


def stress_size(curve: UniaxialCurve) -> Array:
    """Stress in Pa that an error is relative to: |P|, at least ``STRESS_FLOOR`` of the largest, of the shape of the curve."""
    size = np.abs(curve.nominal_stress)
    return np.maximum(size, STRESS_FLOOR * size.max())


def relative_errors(material: Hyperelastic, curve: UniaxialCurve) -> Array:
    """Error of the nominal stress over ``stress_size``, dimensionless, of the shape of the curve."""
    return (uniaxial_nominal_stress(material, curve.stretch) - curve.nominal_stress) / stress_size(curve)


def unit_stresses(stretch: Array, names: tuple[str, ...]) -> Array:
    """Nominal stress per unit of each named coefficient, dimensionless, shape (stretches, names)."""
    stretches = uniaxial(stretch)
    I1, I2 = principal_invariants(stretches)
    columns = [
        cauchy_stress(monomial_derivative(I1, I2, power, (1, 0)), monomial_derivative(I1, I2, power, (0, 1)), stretches)
        for power in powers_of(dict.fromkeys(names, 1.0))
    ]
    return np.stack(columns, axis=-1) / stretch[:, None]


def _least_squares(design: Array, target: Array, names: tuple[str, ...]) -> Array:
    """Free coefficients in Pa."""
    return np.linalg.lstsq(design, target, rcond=None)[0]


def _elliptic_least_squares(design: Array, target: Array, names: tuple[str, ...]) -> Array:
    r"""Coefficients in Pa under the linear conditions of strong ellipticity, exactly, as a projection on their cone.

    With D = QR, z = Rc and the conditions A z >= 0, the nearest z to y = Q^T target is y + A^T u, where u >= 0 makes
    |A^T u + y| smallest.

    Source: Moreau 1962 (decomposition by a cone and its polar); Lawson & Hanson 1974, Solving Least Squares Problems, chapter 23.
    """
    Q, R = np.linalg.qr(design)
    free = Q.T @ target
    normals = np.linalg.solve(R.T, _ellipticity_rows(names).T)
    normals /= np.linalg.norm(normals, axis=0)
    try:
        multipliers, _ = scipy.optimize.nnls(normals, -free)
    except RuntimeError as error:
        raise ConvergenceError(f"stable fit: {error}") from None
    nearest = free + normals @ multipliers
    if np.linalg.norm(nearest) <= NEGLIGIBLE * np.linalg.norm(free):
        raise ConvergenceError(
            "stable fit: no strongly elliptic material of this form is nearer to the data than no stress at all"
        )
    return np.linalg.solve(R, nearest)


def _ellipticity_rows(names: tuple[str, ...]) -> Array:
    """Rows r with r . c >= 0: every g_k, and every d_k over (l_i + l_j)^2, at least a fraction of its value at rest."""
    axis = np.geomspace(*SCANNED, STRETCH_STATES)
    first, second = (side.ravel() for side in np.meshgrid(axis, axis))
    states = np.stack([first, second, 1 / (first * second)])
    states = states[:, (first <= second) & (second <= states[2]) & (states[2] <= SCANNED[1])]
    I1, I2 = principal_invariants(states)
    perimeter = np.stack([(states[i] + states[j]) ** 2 for i, j, _ in PAIRS])
    rows = []
    for power in powers_of(dict.fromkeys(names, 1.0)):
        derivatives = [monomial_derivative(I1, I2, power, order) for order in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))]
        shear, opposite, _ = shear_conditions((*derivatives,), states)  # type: ignore[arg-type]
        at_rest = 1.0 if sum(power) == 1 else 0.0
        rows.append(np.concatenate([shear.ravel(), (opposite / perimeter).ravel()]) - SMALLEST_SHEAR_FRACTION * at_rest)
    matrix = np.stack(rows, axis=-1)
    return matrix / np.abs(matrix).max(axis=1, keepdims=True)


def _material(form: Form, values: Array, source: str) -> InvariantPolynomial:
    """The fitted constants as a material, zero where the form has none."""
    fitted = dict(zip(form.coefficients, map(float, values), strict=True))
    constants: dict[str, float] | dict[str, dict[str, float]] = {"coefficients": fitted}
    if form.kind is not Polynomial:
        constants = dict.fromkeys((name for name in form.kind.model_fields if name.startswith("c")), 0.0) | fitted
    try:
        return form.kind.model_validate(constants)
    except ValidationError as error:
        raise InvalidQuantity(f"{source}: the fit is no material: {error.errors()[0]['msg']}") from None
