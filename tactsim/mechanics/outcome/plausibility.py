"""What no tissue, body or material is likely to be: such a case runs, and its result says what looks like a wrong unit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from tactsim.interfaces import Material
from tactsim.materials.invariant_polynomial import InvariantPolynomial
from tactsim.materials.moduli import poisson_ratio
from tactsim.materials.stability_range import stability_range
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.units import format_quantity

TISSUE_LENGTHS = (20e-6, 0.5)
"""Usual sizes in m of tissue and phantoms: from a thin membrane or the outermost skin to a torso."""
BODY_LENGTHS = (50e-6, 0.2)
"""Usual sizes in m of what presses on tissue: from the finest needle to a palm."""
SHEAR_MODULI = (1.0, 1e9)
"""Usual shear moduli in Pa: from the weakest gel that keeps a shape to dense bone."""
LARGEST_SIZE_RATIO = 1e3
"""Largest of tissue over smallest of bodies: a specimen a hundred radii wide is a half-space to a tenth of a per cent already."""
LARGEST_STIFFNESS_RATIO = 1e5
"""Stiffest over softest material of one body: a calcified artery in fat has about 1e4."""
POISSON_ZERO = 2 / 3
"""Bulk over shear modulus below which Poisson's ratio is negative, by `poisson_ratio`."""
NEARLY_INCOMPRESSIBLE = 1e6
"""Bulk over shear modulus beyond which a volume change is round-off: water has some 2 GPa, the softest tissue about 1 kPa."""


def oddities(
    materials: Mapping[str, Material], *, tissue: Mapping[str, float] | None = None, bodies: Mapping[str, float] | None = None
) -> list[str]:
    """Warnings on materials and lengths in m by their names in a case."""
    tissue, bodies = tissue or {}, bodies or {}
    return [
        *_unusual_lengths(tissue, TISSUE_LENGTHS, "tissue"),
        *_unusual_lengths(bodies, BODY_LENGTHS, "what presses on it"),
        *_far_apart(tissue, bodies),
        *(words for name, material in _different(materials) for words in _unusual_material(name, material)),
        *_unlike_stiffness(materials),
    ]


def _unusual_lengths(lengths: Mapping[str, float], usual: tuple[float, float], what: str) -> Iterator[str]:
    least, most = usual
    for name, length in lengths.items():
        if not least <= length <= most:
            low, high, given = (format_quantity(value, "m") for value in (least, most, length))
            yield f"{name} is {given}; usual for {what}: {low} to {high}: is its unit right?"


def _far_apart(tissue: Mapping[str, float], bodies: Mapping[str, float]) -> Iterator[str]:
    if not tissue or not bodies:
        return
    big, small = max(tissue, key=lambda name: tissue[name]), min(bodies, key=lambda name: bodies[name])
    if tissue[big] > LARGEST_SIZE_RATIO * bodies[small]:
        large, little = format_quantity(tissue[big], "m"), format_quantity(bodies[small], "m")
        yield (
            f"{big} of {large} is {tissue[big] / bodies[small]:.3g} times {small} of {little}; usual: up to "
            f"{LARGEST_SIZE_RATIO:g} times: are both units right?"
        )


def _different(materials: Mapping[str, Material]) -> Iterator[tuple[str, Material]]:
    """Each material once, under its first name."""
    seen: list[Material] = []
    for name, material in materials.items():
        if material not in seen:
            seen.append(material)
            yield name, material


def _unusual_material(name: str, material: Material) -> Iterator[str]:
    shear, bulk = material.shear_modulus, material.bulk_modulus
    least, most = SHEAR_MODULI
    low, high = (format_quantity(value, "Pa") for value in SHEAR_MODULI)
    if not least <= shear <= most:
        given = format_quantity(shear, "Pa")
        yield f"{name} has a shear modulus of {given}; tissue and elastomers usually have {low} to {high}: is its unit right?"
    else:
        response = shear_relaxation(material)
        for when, modulus in (("at once", response.instantaneous_modulus), ("in the end", response.equilibrium_modulus)):
            if not least <= modulus <= most:
                given, usual = format_quantity(modulus, "Pa"), f"usual are {low} to {high}"
                yield f"{name} has a shear modulus of {given} {when}, by its fractions; {usual}: are they right?"
    if bulk is not None and not POISSON_ZERO <= bulk / shear <= NEARLY_INCOMPRESSIBLE:
        both = [format_quantity(value, "Pa") for value in (bulk, shear)]
        negative = f"its Poisson's ratio is {poisson_ratio(shear, bulk):.3g}, that of no tissue"
        end = "take bulk_modulus: null" if bulk > shear else negative
        yield f"{name} has a bulk modulus of {both[0]}, {bulk / shear:.3g} times its shear modulus of {both[1]}: {end}"
    if not isinstance(material, InvariantPolynomial):
        return
    first, second = (material.terms.get(powers, 0.0) for powers in ((1, 0), (0, 1)))
    if second < 0 and not (stability := stability_range(material)).strongly_elliptic:
        within = stability.elliptic_everywhere_within
        yield (
            f"{name} has c01 = {format_quantity(second, 'Pa')} beside c10 = {format_quantity(first, 'Pa')}: it is stable only "
            f"while all principal stretches stay within {1 / within:.3g} to {within:.3g}"
        )


def _unlike_stiffness(materials: Mapping[str, Material]) -> Iterator[str]:
    if not materials:
        return
    moduli = {name: material.shear_modulus for name, material in materials.items()}
    hard, soft = max(moduli, key=lambda name: moduli[name]), min(moduli, key=lambda name: moduli[name])
    ratio = moduli[hard] / moduli[soft]
    if ratio > LARGEST_STIFFNESS_RATIO:
        yield (
            f"{hard} with a shear modulus of {format_quantity(moduli[hard], 'Pa')} is {ratio:.3g} times as stiff as {soft} with "
            f"{format_quantity(moduli[soft], 'Pa')}; usual: up to {LARGEST_STIFFNESS_RATIO:g} times: are both units right?"
        )
