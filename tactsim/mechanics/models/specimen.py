"""A cylindrical piece of tissue: layers, surface, base, and its axisymmetric mesh."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from tactsim.array import Array
from tactsim.interfaces import Material
from tactsim.materials import AnyMaterial
from tactsim.mesh.axisymmetric import Size, section_mesh
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.model import FrozenModel
from tactsim.units import Length, Positive, format_quantity

LARGEST_CAP = 0.9
"""Largest difference of height of a curved surface, as a part of the thickness."""


class Layer(FrozenModel):
    """A layer of other material at the top of the specimen."""

    thickness: Positive[Length]
    """Thickness of the layer."""
    material: AnyMaterial
    """Material of the layer."""


class Specimen(FrozenModel):
    """A cylinder of tissue on a rigid base; its axis is the axis of the body pressed into it.

    >>> import tactsim as ts
    >>> ts.Specimen(material="icf_stable", thickness="6 mm", radius="12 mm").thickness  # m
    0.006
    """

    material: AnyMaterial
    """Material below the layers."""
    thickness: Positive[Length] = 10e-3
    """Thickness on the axis of a flat specimen, layers included."""
    radius: Positive[Length] = 15e-3
    """Radius of the cylinder; its side is free."""
    layers: tuple[Layer, ...] = ()
    """Layers from the surface down, inside the thickness."""
    base: Literal["fixed", "slipping"] = "fixed"
    """Whether the tissue sticks to the base or slides on it without friction."""
    surface: Literal["flat", "convex", "concave"] = "flat"
    """Shape of the top."""
    surface_radius: Positive[Length] | None = None
    """Radius of the sphere that a convex or concave top follows."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        stacked = sum(layer.thickness for layer in self.layers)
        if stacked >= self.thickness:
            stack, thickness = format_quantity(stacked, "m"), format_quantity(self.thickness, "m")
            raise ValueError(f"layers of {stack} leave nothing of the thickness {thickness}")
        if (self.surface == "flat") != (self.surface_radius is None):
            raise ValueError("surface_radius belongs to a convex or concave surface, and such a surface needs it")
        if self.surface_radius is not None and self.surface_radius < self.radius:
            given, least = format_quantity(self.surface_radius, "m"), format_quantity(self.radius, "m")
            raise ValueError(f"surface_radius {given} must be at least the specimen's radius, {least}")
        if self.depth_of_cap(self.radius) >= LARGEST_CAP * self.thickness:
            raise ValueError("the curved surface is as deep as the specimen is thick; take a larger surface_radius")
        return self

    @property
    def materials(self) -> tuple[Material, ...]:
        """Materials by region, from the top down."""
        return (*(layer.material for layer in self.layers), self.material)

    @property
    def materials_by_key(self) -> dict[str, Material]:
        """The same by their key paths within the specimen, such as ``layers.0.material``."""
        return {f"layers.{k}.material": layer.material for k, layer in enumerate(self.layers)} | {"material": self.material}

    @property
    def interfaces(self) -> tuple[float, ...]:
        """Heights in m of the top, of every layer's lower face and of the base, on a flat specimen."""
        depths = np.cumsum([layer.thickness for layer in self.layers])
        return (0.0, *(-float(depth) for depth in depths), -self.thickness)

    def depth_of_cap(self, radius: float | Array) -> Array:
        """How far in m the sphere of the surface has dropped at a distance in m from the axis, of its shape."""
        if self.surface_radius is None:
            return np.zeros_like(np.asarray(radius, float))
        return self.surface_radius - np.sqrt(self.surface_radius**2 - np.asarray(radius, float) ** 2)

    def mesh(self, size: Size, rings: tuple[float, ...], keys: str) -> QuadraticMesh:
        """Section of the specimen, r >= 0, the top of the axis at z = 0; nodes of a curved top lie on it.

        ``keys`` is what messages call that which the size follows from.

        Raises
        ------
        InputError
            If the mesh would have too many elements, or the wanted size is not positive somewhere.
        """
        flat = section_mesh(self.radius, self.interfaces, size, rings=rings, keys=keys)
        if self.surface == "flat":
            return flat
        drop = self.depth_of_cap(flat.nodes[:, 0]) * (-1.0 if self.surface == "convex" else 1.0)
        nodes = flat.nodes.copy()
        nodes[:, 1] += drop * (1 + nodes[:, 1] / self.thickness)
        return flat.moved(nodes)
