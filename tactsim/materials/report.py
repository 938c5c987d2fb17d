"""A material in words: constants, moduli, where it is stable, where it comes from."""

from __future__ import annotations

from tactsim.interfaces import Material
from tactsim.materials.library import LIBRARY, MaterialSet
from tactsim.materials.moduli import youngs_modulus
from tactsim.materials.stability_range import Interval, StabilityReport, stability_range
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.units import format_quantity


def material_report(name: str, material: Material) -> str:
    """A text of several lines: source, constants with units, small-strain moduli, ranges of stability.

    ``name`` is a shipped set or what the user calls the material; source and fit are given for the unchanged constants of a set.
    """
    entry = LIBRARY.get(name)
    lines = [f"{name} ({material.kind})", *_origin_lines(entry, material), "", "Constants"]
    lines += [f"  {label:<16} {value}" for label, value in _constants(material)]
    when = "" if material.relaxation is None else f", {material.relaxation.when_constants_hold}"
    lines += [
        "",
        f"Moduli at small strain{when}",
        *_moduli_lines(material),
        *_relaxation_lines(material),
    ]
    lines += ["", *_stability_lines(stability_range(material))]
    return "\n".join(lines)


def _origin_lines(entry: MaterialSet | None, material: Material) -> list[str]:
    """Source, note and error of the fit of a shipped set."""
    if entry is None or entry.material.terms != getattr(material, "terms", None):
        return []
    lines = [f"  source: {entry.source}", f"  note: {entry.note}"]
    if entry.fitted_stretch and entry.max_relative_error is not None and entry.rms_relative_error is not None:
        lines.append(
            f"  fit: largest relative error {100 * entry.max_relative_error:.1f} %, rms {100 * entry.rms_relative_error:.1f} %, "
            f"over uniaxial stretch {_interval(entry.fitted_stretch)}"
        )
    if entry.left_open:
        lines.append(f"  open: {entry.left_open}")
    return lines


def _constants(material: Material) -> list[tuple[str, str]]:
    """Every constant of the material with its unit."""
    constants: list[tuple[str, str]] = []
    for name, field in type(material).model_fields.items():
        value = getattr(material, name)
        unit = field.json_schema_extra.get("unit", "") if isinstance(field.json_schema_extra, dict) else ""
        if isinstance(value, dict):
            constants += [(key, format_quantity(number, "Pa")) for key, number in value.items()]
        elif isinstance(value, float) and name != "bulk_modulus":
            constants.append((name, format_quantity(value, str(unit))))
    return constants


def _moduli_lines(material: Material) -> list[str]:
    """Shear, Young's and bulk modulus."""
    G, K = material.shear_modulus, material.bulk_modulus
    bulk = "infinite (exactly incompressible)" if K is None else format_quantity(K, "Pa")
    rows = (("shear G", format_quantity(G, "Pa")), ("Young's E", format_quantity(youngs_modulus(G, K), "Pa")), ("bulk K", bulk))
    return [f"  {label:<16} {value}" for label, value in rows]


def _relaxation_lines(material: Material) -> list[str]:
    """Shear modulus at once and in the end, and every part that relaxes, as a part of the first."""
    if material.relaxation is None:
        return []
    shear = shear_relaxation(material)
    first = shear.instantaneous_modulus
    ends = ((f"shear G {when}", value) for when, value in (("at once", first), ("in the end", shear.equilibrium_modulus)))
    lines = [
        "",
        "Relaxation of the isochoric stress",
        *(f"  {words:<18} {format_quantity(value, 'Pa')}" for words, value in ends),
    ]
    return lines + [
        f"  {modulus / first:<18.6g} relaxes in {format_quantity(time, 's')}"
        for modulus, time in zip(shear.moduli.tolist(), shear.times.tolist(), strict=True)
    ]


def _stability_lines(report: StabilityReport) -> list[str]:
    """Ranges of stretch of both conditions in each deformation."""
    lines = [f"Stability, looked at for stretches {_interval(report.scanned)}"]
    for title, condition in (("Strongly elliptic", "elliptic"), ("Drucker stable", "drucker")):
        lines.append(f"  {title}")
        for name, path in report.paths.items():
            lost = ", ".join(_interval(interval) for interval in getattr(path, f"{condition}_lost"))
            lines.append(f"    {name:<14} {_interval(getattr(path, condition))}" + (f"; lost in {lost}" if lost else ""))
    within = report.elliptic_everywhere_within
    lines.append(f"  Strongly elliptic in every state with principal stretches {_interval((1 / within, within))}")
    if not report.strongly_elliptic:
        lines.append("  WARNING: outside this range the finite element problem is ill-posed and its result depends on the mesh")
    return lines


def _interval(interval: Interval) -> str:
    """``0.606 to 0.83``."""
    return f"{interval[0]:.3g} to {interval[1]:.3g}"
