"""The annular sensor on linear elastic and on atrial tissue: thesis, sections 4.2, 4.6 and 4.7."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.analytic.atrial import atrial_shear_compliance, table_4_1
from tactsim.analytic.force_factor import LARGEST_RATIO, force_factor, rise_factor
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.interfaces import drawing, quantity
from tactsim.units import Force, Length, NonNegative, Positive, Time
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.quantities.atrium import Compliance, Times

Approximation = Literal["thesis_4_2_21", "small_hole_series", "smythe"]
Formula = Annotated[Literal["exact", Approximation], Field(description="Formula of the force factor.")]
Ratio = Annotated[float, Field(ge=0, le=LARGEST_RATIO, description="Inner over outer radius.")]
Ratios = Annotated[tuple[float, ...], Field(min_length=1, description="Inner over outer radius.")]
OuterRadius = Annotated[Length, Field(gt=0, description="Radius of the face.")]
OUTER_RADIUS = 3e-3
"""Radius of the face in m, Fig. 3.7d; chapter 4 prints none."""
CREEP_UNITS = {"displacement": "m", "rise": "m", "time_to_touch": "s", "force_to_touch": "N", "displacement_over_radius": "1"}
FORMULA_LABELS = {
    "exact": "exact (solved contact)",
    "thesis_4_2_21": "4.2.21 as printed",
    "small_hole_series": "series in beta to the sixth power",
    "smythe": "Smythe 1951",
}
RATIOS_DRAWN, POINTS_DRAWN = 400, 200
"""Points of a curve over the ratio of the radii, and of one over time or force."""


@quantity(unit="1")
def annulus_force_factor(
    radius_ratio: Ratio,
    formula: Formula = "exact",
    measure: Literal["value", "relative_error", "third_power", "fourth_power"] = "value",
) -> float:
    """Force factor kappa = (1 - nu) p / (4 G ro eps0), or how far a formula of it is off, or what its powers would need.

    Parameters
    ----------
    measure : the number; its relative error; (1 - kappa) / beta^3; (1 - kappa - 4 beta^3 / (3 pi^2)) / beta^4
    """
    factor = float(force_factor(radius_ratio, formula))
    if measure == "relative_error":
        return factor / float(force_factor(radius_ratio)) - 1
    if measure == "third_power":
        return (1 - factor) / radius_ratio**3
    return factor if measure == "value" else (1 - factor - 4 * radius_ratio**3 / (3 * np.pi**2)) / radius_ratio**4


@quantity(unit="1")
def annulus_rise_factor(radius_ratio: Ratio) -> float:
    """Height of the surface on the axis above the face of the annulus over its displacement, on a half-space; dimensionless."""
    return float(rise_factor(radius_ratio))


@quantity(unit="1")
def displacement_prefactor(compliance: Compliance = "half_shear") -> float:
    """n in eps0 = p D(t) / (n ro kappa) of eq. 4.6.4, with the compliance D of Table 4.1 and Poisson's ratio 1/2, at 1 s."""
    annulus = ViscoelasticAnnulus(1.0, 0.1, atrial_shear_compliance("viscosities", compliance))
    displacement = float(annulus.creep_displacement(1.0, 1.0))
    return float(table_4_1("viscosities").creep(1.0)) / (displacement * annulus.force_factor)


@quantity(unit=lambda quantity: CREEP_UNITS[quantity])
def annulus_creep(
    *,
    quantity: Literal["displacement", "rise", "time_to_touch", "force_to_touch", "displacement_over_radius"],
    radius_ratio: Annotated[float, Field(gt=0, le=LARGEST_RATIO)] = 0.1,
    outer_radius: OuterRadius = OUTER_RADIUS,
    recess: Positive[Length] = 0.7e-3,
    force: Positive[Force] = 1.0,
    time: NonNegative[Time] = 0.5,
    times: Times = "viscosities",
    compliance: Compliance = "half_shear",
    formula: Formula = "exact",
) -> float:
    """Displacement or rise in m under a constant force on atrial tissue, or the time in s or force in N at which it touches.

    Parameters
    ----------
    quantity : what is asked for; the rise is that of the tissue in the hole
    radius_ratio : inner over outer radius
    recess : depth of the small sensor
    force : constant force
    time : time since the force began
    """
    annulus = ViscoelasticAnnulus(outer_radius, radius_ratio, atrial_shear_compliance(times, compliance), formula)
    if quantity == "time_to_touch":
        return float(annulus.time_to_touch(recess, force))
    if quantity == "force_to_touch":
        return float(annulus.force_to_touch(recess, time))
    displacement = float(annulus.creep_displacement(force, time))
    if quantity == "displacement_over_radius":
        return displacement / outer_radius
    return displacement if quantity == "displacement" else float(annulus.rise(displacement))


@quantity(unit="1")
def ratio_effect(
    force: Positive[Force],
    over: Positive[Force],
    ratios: tuple[Ratio, Ratio] = (0.1, 0.5),
    time: Positive[Time] = 0.5,
) -> float:
    """Difference of the displacements at two ratios of the radii under a force, over that under another one; dimensionless.

    Parameters
    ----------
    force, over : forces
    ratios : the two ratios of inner over outer radius
    time : time since the force began
    """

    def difference(load: float) -> float:
        narrow, wide = (annulus_creep(quantity="displacement", radius_ratio=ratio, force=load, time=time) for ratio in ratios)
        return wide - narrow

    return difference(force) / difference(over)


@drawing
def force_factor_errors(
    title: Title, formulas: Annotated[tuple[Approximation, ...], Field(min_length=1)], largest_error: Positive[float] = 0.05
) -> Data:
    """The force factor above, the error of each formula in percent below, over the ratio of the radii.

    Parameters
    ----------
    formulas : formulas that are judged
    largest_error : a formula is drawn up to this error
    """
    beta = np.linspace(0.0, LARGEST_RATIO, RATIOS_DRAWN)
    exact = force_factor(beta)
    factors = [series(FORMULA_LABELS["exact"], beta, exact)]
    errors = [series(FORMULA_LABELS["exact"], beta, np.zeros(beta.size))]
    for formula in formulas:
        value = force_factor(beta, formula)
        error = value / exact - 1
        beyond = np.flatnonzero(np.abs(error) > largest_error)
        shown = slice(0, int(beyond[0]) if beyond.size else beta.size)
        factors.append(series(FORMULA_LABELS[formula], beta[shown], value[shown]))
        errors.append(series(FORMULA_LABELS[formula], beta[shown], (100 * error)[shown]))
    return curves_figure(title, "ri/ro", "", [panel("force factor kappa", "", factors), panel("error in %", "", errors)])


@drawing
def annulus_indentations(
    *,
    title: Title,
    over: Literal["time", "force"],
    ratios: Ratios,
    force: Positive[Force],
    time: Positive[Time],
    outer_radius: OuterRadius = OUTER_RADIUS,
    times: Times = "viscosities",
    compliance: Compliance = "half_shear",
) -> Data:
    """Displacement of the annulus in m above, exact rise of the tissue in its hole below, for several ratios, as Fig. 4.13.

    Parameters
    ----------
    over : what runs along the axis, up to its value below; the other is held
    force : force, or the largest force
    time : time since the force began, or the longest one
    """
    tissue = atrial_shear_compliance(times, compliance)
    x = np.linspace(0, time if over == "time" else force, POINTS_DRAWN)
    displacements, rises = [], []
    for ratio in ratios:
        annulus = ViscoelasticAnnulus(outer_radius, ratio, tissue)
        displacement = annulus.creep_displacement(force, x) if over == "time" else annulus.creep_displacement(x, time)
        displacements.append(series(f"ri/ro = {ratio:g}", x, displacement))
        rises.append(series(f"ri/ro = {ratio:g}", x, annulus.rise(displacement)))
    panels = [panel("displacement", "m", displacements), panel("rise in the hole", "m", rises)]
    return curves_figure(title, over, "s" if over == "time" else "N", panels, even_panels=True)
