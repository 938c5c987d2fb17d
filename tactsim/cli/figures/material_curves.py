"""Figures of material curves: the three homogeneous deformations with their stability, and fits beside data (Fig. 3.8)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.identification.uniaxial import UniaxialFit, relative_errors, uniaxial_nominal_stress
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.interfaces import Material
from tactsim.materials.homogeneous import PATHS, nominal_stress
from tactsim.materials.stability_range import PathStability, stability_range
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.plotting.canvas import encoded as encoded
from tactsim.plotting.canvas import entitle
from tactsim.units import format_quantity

SHOWN = (0.5, 2.0)
"""Stretches on the axis."""

CURVE_POINTS = 301
LINE_STYLES = ("C0--", "C1-.", "C2:", "C3-", "C4--", "C5-.", "C6:", "C8-")
"""Distinguishable without colour."""
RANGE_IN_VIEW = (0.6, 1.75)
"""Stretches whose stress the vertical axis holds: further out the curves are so steep that nothing else would be seen."""
STABLE_COLOUR = "#e3f1e3"
LOST_COLOUR = "#d62728"


def material_figure(material: Material, name: str) -> Figure:
    """Nominal stress against stretch in uniaxial, equibiaxial and planar loading, stable range shaded, lost range marked.

    Of a material that relaxes it is the stress when its constants hold, at once or in the end, and says so.
    """
    report = stability_range(material)
    figure = Figure(figsize=(10.5, 3.9), layout="constrained")
    FigureCanvasAgg(figure)
    stretch = np.geomspace(*SHOWN, CURVE_POINTS)
    stresses = {path: nominal_stress(material, path, stretch) for path in PATHS}
    unit, factor = pressure_unit(np.concatenate(list(stresses.values())))
    axes = figure.subplots(1, len(PATHS), squeeze=False)[0]
    label = "nominal stress" + ("" if material.relaxation is None else f" {material.relaxation.when_constants_hold}")
    for axis, (path, stress) in zip(axes, stresses.items(), strict=True):
        _draw_path(axis, stretch, stress * factor, report.paths[path], label)
        axis.set_title(path, loc="left")
        axis.set_xlabel("stretch")
    axes[0].set_ylabel(f"{label} in {unit}")
    labelled = {label: handle for axis in axes for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(list(labelled.values()), list(labelled), loc="outside lower center", ncols=len(labelled), frameon=False)
    volume = "" if material.small_strain else ", incompressible"
    entitle(figure, f"{name} ({material.kind}){volume}, {_modulus_words(material)}")
    return figure


def _modulus_words(material: Material) -> str:
    """The shear modulus, of a material that relaxes at once and in the end."""
    shear = shear_relaxation(material)
    first = f"G = {format_quantity(shear.instantaneous_modulus, 'Pa')}"
    if material.relaxation is None:
        return first
    return f"{first} at once, {format_quantity(shear.equilibrium_modulus, 'Pa')} in the end"


def fit_figure(curve: UniaxialCurve, fits: Iterable[UniaxialFit], name: str) -> Figure:
    """Uniaxial data with fitted curves as in thesis Fig. 3.8, and the relative error of each fit below."""
    figure = Figure(figsize=(7, 6.2), layout="constrained")
    FigureCanvasAgg(figure)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1))
    unit, factor = pressure_unit(curve.nominal_stress)
    every = max(1, curve.stretch.size // 40)  # about forty points are seen
    upper.plot(curve.stretch, curve.nominal_stress * factor, "o", color="0.6", markersize=4, markevery=every, label="data")
    stretch = np.linspace(curve.stretch.min(), curve.stretch.max(), CURVE_POINTS)
    for style, fit in zip(LINE_STYLES, fits, strict=False):
        label = f"{fit.form}: max {100 * fit.max_relative_error:.1f} %, rms {100 * fit.rms_relative_error:.1f} %"
        upper.plot(stretch, uniaxial_nominal_stress(fit.material, stretch) * factor, style, label=label)
        lower.plot(curve.stretch, 100 * relative_errors(fit.material, curve), style)
    upper.set_ylabel(f"nominal stress in {unit}")
    upper.set_title(f"{name}: uniaxial curve and fits", loc="left")
    upper.legend(frameon=False)
    lower.axhline(0, color="0.6", linewidth=0.8)
    lower.set_ylabel("relative error in %")
    lower.set_xlabel("stretch")
    figure.draw_without_rendering()  # settles the ticks, whose width the layout of the saved figure needs
    return figure


def pressure_unit(pressures: Array) -> tuple[str, float]:
    """The unit that suits the median size of pressures in Pa, of any shape, and the factor to it."""
    size = float(np.median(np.abs(pressures)))
    for unit, scale in (("MPa", 1e6), ("kPa", 1e3)):
        if size >= scale:
            return unit, 1 / scale
    return "Pa", 1.0


def _draw_path(axis: Axes, stretch: Array, stress: Array, stability: PathStability, label: str) -> None:
    """One curve with its label over its stable and lost ranges."""
    low, high = np.clip(stability.elliptic, *SHOWN)
    axis.axvspan(low, high, color=STABLE_COLOUR, zorder=0, label="strongly elliptic around rest")
    for k, (lost_low, lost_high) in enumerate(stability.elliptic_lost):
        span = np.clip((lost_low, lost_high), *SHOWN)
        axis.axvspan(*span, color=LOST_COLOUR, alpha=0.15, zorder=0)
        lost = (stretch >= lost_low) & (stretch <= lost_high)
        axis.plot(
            stretch[lost],
            stress[lost],
            color=LOST_COLOUR,
            linewidth=4,
            alpha=0.7,
            label="strong ellipticity lost" if k == 0 else None,
        )
    axis.plot(stretch, stress, color="#1f4e79", linewidth=1.6, label=label)
    axis.axhline(0, color="0.6", linewidth=0.8)
    axis.axvline(1, color="0.6", linewidth=0.8)
    axis.set_xlim(*SHOWN)
    seen = stress[(stretch >= RANGE_IN_VIEW[0]) & (stretch <= RANGE_IN_VIEW[1])]
    margin = 0.05 * float(np.ptp(seen))
    axis.set_ylim(seen.min() - margin, seen.max() + margin)
