"""Constitutive laws: energies W(I1, I2) as small files, stress and tangent derived once, stability, shipped constants."""

from tactsim.materials.any_material import AnyMaterial
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.library import LIBRARY, MaterialSet, named_material

__all__ = ["LIBRARY", "AnyMaterial", "Hyperelastic", "MaterialSet", "named_material"]
