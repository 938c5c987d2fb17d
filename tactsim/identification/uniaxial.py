"""Mooney-Rivlin constants from a uniaxial curve: free fits, and a fit that keeps the material strongly elliptic."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import ValidationError

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError, InvalidQuantity, UnknownName, shown
from tactsim.identification.uniaxial_certainty import (
    BARELY_STRETCHED,
    UniaxialCertainty,
    certainty,
    large_strains,
    one_sided,
    pressure_text,
    wrong_signs,
)
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.identification.uniaxial_least_squares import LeastSquares
from tactsim.materials.homogeneous import cauchy_stress, nominal_stress, principal_invariants, uniaxial
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.invariant_polynomial import InvariantPolynomial, monomial_derivative, powers_of
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
from tactsim.materials.mooney_rivlin_5 import MooneyRivlin5
from tactsim.materials.polynomial import Polynomial
from tactsim.materials.stability_range import SCANNED, StabilityReport, stability_range
from tactsim.refusals import first_fault


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

IN_TENSION, IN_COMPRESSION = 1.5, 0.7
"""Assumption: moderate stretches at which fits are compared on the side that a curve leaves out."""

ALIKE = 1.1
"""Ratio of stresses below which fits are said to agree within so many per cent."""
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
    certainty: UniaxialCertainty
    """How well the curve determines the constants of this form."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the curve leaves open of this form."""
        seen = (*large_strains(self.curve), *wrong_signs(self.curve))
        return (*seen, *self.certainty.warnings(self.max_relative_error), *one_sided(self.curve))

    @property
    def case_line(self) -> str:
        """The material of a case file."""
        entries = ", ".join(f"{name}: {pressure_text(value)}" for name, value in named_terms(self.material).items())
        if "coefficients" in type(self.material).model_fields:
            entries = f"coefficients: {{{entries}}}"
        return f"{{kind: {self.material.kind}, {entries}}}"

    def __str__(self) -> str:
        """Errors, line of a case file and intervals."""
        errors = f"largest relative error {100 * self.max_relative_error:.1f} %, rms {100 * self.rms_relative_error:.1f} %"
        stable = "strongly elliptic" if self.stability.strongly_elliptic else "NOT strongly elliptic everywhere"
        return f"{self.form}: {errors}; {stable}\n  {self.case_line}\n  {self.certainty}"


def uniaxial_nominal_stress(material: Hyperelastic, stretch: Array) -> Array:
    r"""Nominal stress in Pa at uniaxial stretches, of their shape.

    .. math:: P = 2 (\lambda - \lambda^{-2}) (W_1 + W_2 / \lambda)

    Source: thesis 3.1.9 divided by the stretch, corrected: W1 and W2 keep the terms of c11.
    """
    return nominal_stress(material, "uniaxial", stretch)


def uniaxial_stress_as_printed(c10: float, c01: float, stretch: Array) -> Array:
    r"""True stress in Pa at stretches, of their shape, by the printed formula, which has no c11.

    .. math:: \sigma = 2 (\lambda^2 - \lambda^{-1}) (c_{10} + c_{01} / \lambda)

    Source: thesis 3.1.9 as printed; right for the two-parameter energy only.
    """
    return 2 * (stretch**2 - 1 / stretch) * (c10 + c01 / stretch)


def fit_uniaxial(curve: UniaxialCurve, form: str = "stable", *, relative: bool = True) -> UniaxialFit:
    r"""Least-squares fit of a form of ``FORMS`` to a curve; points at a stretch of exactly 1 determine nothing and are left out.

    .. math:: \min_c \sum_k w_k^2 (P(\lambda_k; c) - P_k)^2, \quad w_k = 1 / \max(|P_k|, \epsilon \max_j |P_j|)

    with :math:`\epsilon` = ``STRESS_FLOOR``, so that a point near rest, all noise, does not rule the fit. With ``relative`` false
    :math:`w_k = 1 / \max_j |P_j|`. The errors of the result are relative, by the first form of :math:`w_k`.

    >>> import tactsim as ts
    >>> import numpy as np
    >>> from tactsim.identification.uniaxial_data import UniaxialCurve
    >>> stretch = np.linspace(0.7, 1.3, 13)
    >>> curve = UniaxialCurve(stretch, 2 * (stretch - stretch**-2) * (3e3 + 2e3 / stretch), "made up")
    >>> ts.fit_uniaxial(curve, "2-parameter").case_line
    '{kind: mooney_rivlin_2, c10: 3 kPa, c01: 2 kPa}'

    Raises
    ------
    InputError
        If it is not a `UniaxialCurve`.
    UnknownName
        If there is no such form.
    InvalidQuantity
        If the data do not determine the constants, or give a shear modulus that is not positive.
    ConvergenceError
        If no strongly elliptic material was found.

    Source: the stress is that of `uniaxial_nominal_stress`; the weights are a choice of this package.
    """
    if not isinstance(curve, UniaxialCurve):
        raise InputError(
            f"fit_uniaxial: {shown(curve)} is not a curve; expected what read_uniaxial_curve returns, or a UniaxialCurve"
        )
    if form not in FORMS:
        raise UnknownName("form of the energy", form, FORMS)
    names = FORMS[form].coefficients
    loaded = curve.stretch != 1
    stretch, stress = curve.stretch[loaded], curve.nominal_stress[loaded]
    weight = 1 / (stress_size(curve)[loaded] if relative else np.full_like(stress, np.abs(stress).max()))
    design, target = weight[:, None] * unit_stresses(stretch, names), weight * stress
    if np.linalg.matrix_rank(design) < len(names):
        raise InvalidQuantity(f"{curve.source}: {stretch.size} points do not determine {len(names)} constants")
    squares = LeastSquares.of(design, names, strongly_elliptic=FORMS[form].strongly_elliptic)
    nearest = squares.nearest(squares.basis.T @ target)
    material = _material(FORMS[form], squares.constants(nearest), curve.source)
    error = relative_errors(material, curve)[loaded]
    report = stability_range(material)
    if FORMS[form].strongly_elliptic and not report.strongly_elliptic:
        raise ConvergenceError(
            f"{curve.source}: the {form} fit is not strongly elliptic for all stretches {SCANNED[0]:g} to {SCANNED[1]:g}"
        )
    return UniaxialFit(
        form,
        material,
        curve,
        float(np.abs(error).max()),
        float(np.sqrt(np.mean(error**2))),
        report,
        certainty(squares, design, target, names),
    )


def spread_of_forms(fits: Sequence[UniaxialFit]) -> tuple[str, ...]:
    """What fits of one curve say of the side that it leaves out: nothing, and by how much the stable forms differ there."""
    if not fits or not (open_side := one_sided(fits[0].curve)):
        return ()
    where = IN_TENSION if fits[0].curve.stretch.max() < 1 + BARELY_STRETCHED else IN_COMPRESSION
    stable = [fit.material for fit in fits if fit.form.startswith("stable")]
    if len(stable) < 2:
        return open_side
    sizes = [abs(uniaxial_nominal_stress(material, np.array(where)).item()) for material in stable]
    ratio = max(sizes) / min(sizes)
    differ = f"agree within {100 * max(ratio - 1, 0.001):.1f} %" if ratio < ALIKE else f"differ by a factor of {ratio:.2g}"
    return (f"{open_side[0]}: at a stretch of {where:g} the stable fits {differ}",)


def stress_size(curve: UniaxialCurve) -> Array:
    """Stress in Pa that an error is relative to: |P|, at least ``STRESS_FLOOR`` of the largest, of the shape of the curve."""
    size = np.abs(curve.nominal_stress)
    return np.maximum(size, STRESS_FLOOR * size.max())


def named_terms(material: InvariantPolynomial) -> dict[str, float]:
    """Coefficients in Pa by name, such as c10."""
    return {f"c{i}{j}": value for (i, j), value in material.terms.items()}


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


def _material(form: Form, values: Array, source: str) -> InvariantPolynomial:
    """The fitted constants as a material, zero where the form has none."""
    fitted = dict(zip(form.coefficients, map(float, values), strict=True))
    constants: dict[str, float] | dict[str, dict[str, float]] = {"coefficients": fitted}
    if form.kind is not Polynomial:
        constants = dict.fromkeys((name for name in form.kind.model_fields if name.startswith("c")), 0.0) | fitted
    try:
        return form.kind.model_validate(constants)
    except ValidationError as error:
        raise InvalidQuantity(f"{source}: the fit is no material: {first_fault(error)}") from None
