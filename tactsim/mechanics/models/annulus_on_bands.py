"""A flat rigid annulus on a layer whose modulus, thickness and base change from band to band: linear finite elements in 3D."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.equilibrium.newton import Problem
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.mesh.axisymmetric import edge_graded, section_mesh
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.mesh.revolved import swept

SHARE_STEPS = 10
"""Shares of an element in the bands are rounded to one over this number."""
SAMPLES = 100
"""Points of an element by which its shares are counted."""
RAMP = 0.5
"""Width of the ramp of the thickness at a border, a standard deviation over the outer radius."""
INDENTATION = 1e-3
"""Displacement over the outer radius that is prescribed; the answer is linear."""


@dataclass(frozen=True)
class Band:
    """A tissue around the middle of the bands: shear modulus in Pa, thickness in m, base ``bonded`` or ``slipping``."""

    shear_modulus: float
    thickness: float
    base: str


@dataclass(frozen=True)
class BandMesh:
    """How finely the annulus is computed, lengths over its outer radius, dimensionless."""

    finest: float = 0.1
    growth: float = 0.8
    sectors: int = 6
    """In the half turn that is computed."""
    width: float = 5.0
    """Radius of the piece of tissue, over that of the annulus."""


@dataclass(frozen=True)
class AnnulusResponse:
    """Force in N/m over the displacement of the annulus, and largest rise of the tissue in the hole over it."""

    stiffness: float
    rise: float

    def threshold(self, recess: float) -> tuple[float, float]:
        """Force in N and displacement in m at which the tissue has risen by a recess in m."""
        return self.stiffness * recess / self.rise, recess / self.rise


class AnnulusOnBands:
    """An annulus on tissue in concentric bands, its axis at a distance from their middle; one mesh for all distances.

    The surface under the face moves down by the same length everywhere and slides freely, the rest of it is free. The bands are
    circles about the middle, so that the plane through it and the axis is one of symmetry and half of the tissue is computed.

    Parameters
    ----------
    inner_radius, outer_radius : of the face, in m
    bands : from the middle outward
    borders : radii of the borders between them in m, increasing
    mesh : how finely

    Raises
    ------
    InvalidQuantity
        If the bands and borders do not belong together.
    """

    def __init__(
        self,
        inner_radius: float,
        outer_radius: float,
        bands: tuple[Band, ...],
        borders: tuple[float, ...],
        *,
        mesh: BandMesh | None = None,
    ):
        if len(borders) != len(bands) - 1 or np.any(np.diff(borders) <= 0):
            raise InvalidQuantity(f"{len(bands)} bands with borders at {borders} m; allowed: one border fewer, increasing")
        self.inner_radius, self.outer_radius, self.bands, self.borders = inner_radius, outer_radius, bands, np.array(borders)
        self.settings = mesh or BandMesh()

    def at(self, distance: float) -> AnnulusResponse:
        """Response with the axis at a distance in m from the middle of the bands.

        Raises
        ------
        ConvergenceError
            If the linear system is singular.
        """
        return self._response(lambda points: self._band(distance, points), self._ramped(distance))

    def alone(self, band: int) -> AnnulusResponse:
        """Response on one band that goes on everywhere, by the same mesh.

        Raises
        ------
        ConvergenceError
            If the linear system is singular.
        """
        thickness = np.full(len(self._mesh.nodes), self.bands[band].thickness)
        return self._response(lambda points: np.full(points.shape[:-1], band), thickness)

    def _band(self, distance: float, points: Array) -> Array:
        """Number of the band at points (..., >= 2) in m from the axis of the annulus."""
        return np.searchsorted(self.borders, np.hypot(distance + points[..., 0], points[..., 1]), side="right")

    @cached_property
    def _mesh(self) -> QuadraticMesh:
        """Half of a cylinder of thickness 1 m in z, the annulus's circles among its edges."""
        settings, a = self.settings, self.outer_radius
        thickness = max(band.thickness for band in self.bands)
        edges = np.array([(self.inner_radius, 0.0), (a, 0.0)])
        size = edge_graded(edges, finest=settings.finest * a, growth=settings.growth, coarsest=thickness / 3)
        section = section_mesh(settings.width * a, (0.0, -thickness), size, rings=(self.inner_radius, a))
        mesh = swept(section, settings.sectors, np.pi).mesh
        return mesh.moved(mesh.nodes / np.array([1.0, 1.0, thickness]))

    def _response(self, band_at: Callable[[Array], Array], thickness: Array) -> AnnulusResponse:
        mesh, a = self._mesh, self.outer_radius
        shares = self._shares(band_at)
        kinds, regions = np.unique(np.round(SHARE_STEPS * shares).astype(int), axis=0, return_inverse=True)
        moduli = kinds / kinds.sum(axis=1, keepdims=True) @ np.array([band.shear_modulus for band in self.bands])
        nodes = mesh.nodes * np.column_stack([*np.ones((2, len(mesh.nodes))), thickness])
        body = Body(
            TaylorHood(nodes, mesh.elements, "solid"),
            [_incompressible(float(modulus)) for modulus in moduli],
            regions.ravel(),
        )
        height, radius = mesh.nodes[:, 2], np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1])
        top, base = np.abs(height) < 1e-9, height < -1 + 1e-9
        face = np.flatnonzero(top & (radius >= self.inner_radius * (1 - 1e-9)) & (radius <= a * (1 + 1e-9)))
        bonded = np.array([band.base == "bonded" for band in self.bands])[band_at(mesh.nodes)]
        fixed = [3 * face + 2, 3 * np.flatnonzero(base) + 2, 3 * np.flatnonzero(np.abs(mesh.nodes[:, 1]) < 1e-12 * a) + 1]
        fixed += [3 * np.flatnonzero(base & bonded) + axis for axis in (0, 1)]
        guess = np.zeros(body.space.size)
        depth = INDENTATION * a
        guess[3 * face + 2] = -depth
        unknowns = Problem(body, np.unique(np.concatenate(fixed))).solve(guess).unknowns
        force = -2 * float(body.residual(unknowns)[3 * face + 2].sum())
        hole = top & (radius <= self.inner_radius * (1 + 1e-9))
        highest = float(unknowns[2 : 3 * len(nodes) : 3][hole].max())
        return AnnulusResponse(force / depth, 1 + highest / depth)

    def _shares(self, band_at: Callable[[Array], Array]) -> Array:
        """Share of each element in each band, shape (E, bands)."""
        weights = scipy.stats.qmc.Sobol(3, seed=0).random(128)[:SAMPLES]
        ordered = np.sort(weights, axis=1)
        barycentric = np.diff(np.hstack([np.zeros((SAMPLES, 1)), ordered, np.ones((SAMPLES, 1))]), axis=1)
        points = np.einsum("sv,evd->esd", barycentric, self._mesh.nodes[self._mesh.elements[:, :4]])
        band = band_at(points)
        return np.stack([(band == k).mean(axis=1) for k in range(len(self.bands))], axis=1)

    def _ramped(self, distance: float) -> Array:
        """Thickness in m at each node with the axis at a distance in m, ramped like a normal distribution at the borders."""
        thickness = np.array([band.thickness for band in self.bands])
        away = np.hypot(distance + self._mesh.nodes[:, 0], self._mesh.nodes[:, 1])
        steps = scipy.special.ndtr((away[:, None] - self.borders) / (RAMP * self.outer_radius))
        return thickness[0] + steps @ np.diff(thickness)


def _incompressible(shear_modulus: float) -> LinearElastic:
    """Incompressible linear tissue of a shear modulus in Pa."""
    return LinearElastic.model_validate({"youngs_modulus": 3 * shear_modulus, "poisson_ratio": 0.5})
