"""Materials that ship with tactsim, each with its source and how well it fits its data."""

from __future__ import annotations

from dataclasses import dataclass

from tactsim.errors import UnknownName
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.mooney_rivlin_3 import MooneyRivlin3
from tactsim.materials.mooney_rivlin_5 import MooneyRivlin5


@dataclass(frozen=True)
class MaterialSet:
    """A material by name, with where it comes from."""

    name: str
    material: Hyperelastic
    source: str
    note: str


def named_material(name: str) -> MaterialSet:
    """The shipped set of this name.

    Raises
    ------
    UnknownName
        With the nearest name.
    """
    if name not in LIBRARY:
        raise UnknownName("material", name, LIBRARY)
    return LIBRARY[name]


_PRINTED = "thesis, Table 3.1"
_STABLE = "fit of the uniaxial curve of thesis Table 3.1 over 0.6 <= stretch <= 1, relative least squares"

LIBRARY = {
    entry.name: entry
    for entry in (
        MaterialSet("b1a_printed", MooneyRivlin3(c10=-129700, c01=173670, c11=55812), _PRINTED, ""),
        MaterialSet("icf_printed", MooneyRivlin3(c10=-8598.8, c01=10284, c11=5143.6), _PRINTED, ""),
        MaterialSet("b1a_stable", MooneyRivlin5(c10=0, c01=49657.5, c20=146454.2, c11=0, c02=0), _STABLE, ""),
        MaterialSet("icf_stable", MooneyRivlin5(c10=0, c01=1995.84, c20=11957.5, c11=0, c02=0), _STABLE, ""),
    )
}
