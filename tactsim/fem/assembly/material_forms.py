"""Which compiled loops equal the stress and the tangent that a material gives."""

from __future__ import annotations

from typing import Literal

from tactsim.interfaces import Material

LAW = ("first_piola_kirchhoff", "tangent", "volume_change", "volume_change_gradient")
"""Methods that the compiled loops stand for."""


def compiled_form(material: Material) -> Literal["invariants", "small_strain"] | None:
    """The compiled form of a material; None if the nearest class that defines its law declares none.

    A subclass that overrides a part of the law is not what its base declared, and has no compiled form unless it says so itself.
    """
    for cls in type(material).__mro__:
        if "compiled_form" in vars(cls):
            form: Literal["invariants", "small_strain"] | None = vars(cls)["compiled_form"]
            return form
        if any(name in vars(cls) for name in LAW):
            return None
    return None


def interpreted_warnings(materials: dict[str, Material]) -> list[str]:
    """What a run must report of materials, by their names in a case, that have no compiled form."""
    slow = {material.kind: name for name, material in materials.items() if compiled_form(material) is None}
    return [
        f"{name}: material {kind} has no compiled form: assembly is interpreted, several times slower"
        for kind, name in slow.items()
    ]
