"""Materials that ship with tactsim, each with its source and how well it fits its data."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from tactsim.analytic.atrial import atrial_shear_compliance
from tactsim.interfaces import Material
from tactsim.materials.invariant_polynomial import InvariantPolynomial
from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.materials.viscoelasticity import neo_hookean_of
from tactsim.registry import shipped


@dataclass(frozen=True)
class MaterialSet:
    """A material by name, with where it comes from."""

    name: str
    material: InvariantPolynomial
    source: str
    """Where the constants stand, or what they were fitted to and how."""
    note: str
    """What a user must know before using it."""
    fitted_stretch: tuple[float, float] | None = None
    """Range of uniaxial stretch of the fit; None if it is not known."""
    max_relative_error: float | None = None
    """Largest relative error of the nominal stress over that range, dimensionless."""
    rms_relative_error: float | None = None
    """Root mean square of the relative errors over that range, dimensionless."""
    threshold_spread: tuple[float, float] | None = None
    """Lowest and highest threshold pressure of other stable energies that fit the same curve in compression, over that of this
    one, dimensionless, for the specimen and recess of the case ``annulus_icf``; None if not computed. Source: table_3_2, whose
    rows ``spread`` compute it."""

    @property
    def left_open(self) -> str | None:
        """What data in compression alone leave undecided, in words; None if the spread is not known."""
        if self.fitted_stretch is None or self.threshold_spread is None:
            return None
        (shortest, longest), (low, high) = self.fitted_stretch, self.threshold_spread
        return (
            f"fitted in compression alone (stretch {shortest:g} to {longest:g}), which leaves its energy open: other stable "
            f"energies that fit as well give {low:g} to {high:g} times its threshold pressure on a layer of 10 mm, recess 0.8 mm "
            "(table_3_2)"
        )


def named_material(name: str) -> MaterialSet:
    """The shipped set of this name.

    Raises
    ------
    UnknownName
        With the nearest name.
    """
    material: MaterialSet = shipped("material set", name, LIBRARY)
    return material


def material(name: str) -> InvariantPolynomial:
    """The shipped material of this name, such as ``icf_stable``.

    >>> import tactsim as ts
    >>> ts.material("lump").kind
    'neo_hookean'

    Raises
    ------
    UnknownName
        With the nearest name.
    """
    return named_material(name).material


B1A_PRINTED = MaterialSet(
    name="b1a_printed",
    material=MooneyRivlin3(c10=-129700, c01=173670, c11=55812),
    source="thesis, Table 3.1, row B1 (erratum E5: the text calls this elastomer B1-A)",
    note="not strongly elliptic in part of compression: finite element results depend on the mesh; b1a_stable is the alternative",
)

ICF_PRINTED = MaterialSet(
    name="icf_printed",
    material=MooneyRivlin3(c10=-8598.8, c01=10284, c11=5143.6),
    source="thesis, Table 3.1, row ICF",
    note="not strongly elliptic in part of compression: finite element results depend on the mesh; icf_stable is the alternative",
)

_FITTED_TO = "uniaxial curve of {} (3.1.9 with c11, erratum E4) at 200 even stretches, relative least squares, form 'stable'"
_STABLE_NOTE = "strongly elliptic at every stretch from 0.2 to 5; the fitted range is an assumption, the test is not described"

B1A_STABLE = MaterialSet(
    name="b1a_stable",
    material=MooneyRivlin3(c10=-109658, c01=154795, c11=63247),
    source=_FITTED_TO.format("b1a_printed"),
    note=_STABLE_NOTE,
    fitted_stretch=(0.6, 1.0),
    max_relative_error=0.0255,
    rms_relative_error=0.0093,
    threshold_spread=(1.08, 2.07),
)

ICF_STABLE = MaterialSet(
    name="icf_stable",
    material=MooneyRivlin3(c10=-6757.5, c01=8534.3, c11=5887.9),
    source=_FITTED_TO.format("icf_printed"),
    note=_STABLE_NOTE,
    fitted_stretch=(0.6, 1.0),
    max_relative_error=0.0516,
    rms_relative_error=0.0171,
    threshold_spread=(1.21, 2.39),
)

_ATRIAL_NOTE = "the data determine the compliance between 1 and 36 Hz, not each constant; a neo-Hookean energy is an assumption"


def _atrial() -> MaterialSet:
    return MaterialSet(
        name="atrial",
        material=neo_hookean_of(atrial_shear_compliance()),
        source="thesis, Table 4.1: 1/E with retardation times in s, incompressible (the readings that 4.3.8 and the test imply)",
        note=_ATRIAL_NOTE,
    )


def _atrial_printed() -> MaterialSet:
    return MaterialSet(
        name="atrial_printed",
        material=neo_hookean_of(atrial_shear_compliance(times="viscosities", compliance="half_shear")),
        source="thesis, Table 4.1 as 4.6.4 uses it: the column of times as viscosities in MPa s, the compliance as 1/(2G)",
        note=_ATRIAL_NOTE,
    )


LUMP = MaterialSet(
    name="lump",
    material=NeoHookean(c10=18e3 / 6),
    source="thesis, 6.5: Young's modulus 18 kPa, isotropic; c10 = E/6 of an incompressible material",
    note="a neo-Hookean energy is an assumption; soft in B1-A (E = 264 kPa), 1.8 times as stiff as ICF (erratum E15)",
)

ARTERY_WALL = MaterialSet(
    name="artery_wall",
    material=NeoHookean(c10=130e3 / 6),
    source="thesis, 6.5: Young's modulus 130 kPa, isotropic; c10 = E/6 of an incompressible material",
    note="a neo-Hookean energy is an assumption; alone, a wall with radii of 4 and 4.6 mm bears at most 45 mmHg (erratum E14)",
)

HARD_BALL = MaterialSet(
    name="hard_ball",
    material=NeoHookean(c10=3e6 / 6),
    source="thesis, 6.3: plastic balls of a much higher modulus than the elastomers; none is printed",
    note="E = 3 MPa is an assumption: beyond ten times the modulus of the tissue a harder ball cannot be told from this one",
)

HARD_TUBE = MaterialSet(
    name="hard_tube",
    material=NeoHookean(c10=1.5e6 / 6),
    source="thesis, 6.4: soft plastic tubes in place of arteries; their modulus is known there but not printed",
    note="E = 1.5 MPa is an assumption: six times B1-A, 150 times ICF",
)


class _Library(Mapping[str, MaterialSet]):
    """Sets by name; those of the atrium, whose compliance must be converted, are made when they are first asked for."""

    def __init__(self, sets: Iterable[MaterialSet], made: Mapping[str, Callable[[], MaterialSet]]):
        self._sets = {one.name: one for one in sets}
        self._made = made

    def __getitem__(self, name: str) -> MaterialSet:
        if name not in self._sets:
            self._sets[name] = self._made[name]()
        return self._sets[name]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted({*self._sets, *self._made}))

    def __len__(self) -> int:
        return len({*self._sets, *self._made})


_WRITTEN = (ARTERY_WALL, B1A_PRINTED, B1A_STABLE, HARD_BALL, HARD_TUBE, ICF_PRINTED, ICF_STABLE, LUMP)
LIBRARY: Mapping[str, MaterialSet] = _Library(_WRITTEN, {"atrial": _atrial, "atrial_printed": _atrial_printed})
"""Shipped sets by name."""


def set_with_constants_of(material: Material) -> MaterialSet | None:
    """The shipped set of written constants, not those made from a compliance, whose constants this material has."""
    terms = getattr(material, "terms", None)
    return next((entry for entry in _WRITTEN if entry.material.terms == terms), None)
