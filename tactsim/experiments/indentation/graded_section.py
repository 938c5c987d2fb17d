"""The section of a specimen under a rigid body, and the sizes of its elements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.interfaces.contact_shape import ContactShape
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mesh.axisymmetric import Size, edge_graded, finer_at_surface, graded_to_peak
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.model import FrozenModel
from tactsim.units import Length, Positive

PEAK_ELEMENTS = 12
"""Elements over the radius of an annulus's hole that the size at the peak of the rise, on the axis, would allow.

Why: that peak decides the threshold, whose pressure grows with nearly the third power of it, and on the axis a single height is
known less well than its neighbours. In `annulus_icf` elements a sixth of the hole long made it 0.08 % too high, so that the
threshold was 0.14 % too low; with these it is 0.06 % too high, with fewer unknowns in sum."""

KEYS = "mesh.finest, mesh.coarsest, mesh.growth and mesh.refinement"
"""What a case gives of the sizes."""


class MeshSettings(FrozenModel):
    """Size of the elements: finest at the edges of the body, growing with the distance from them."""

    finest: Positive[Length] | None = None
    """Element size at the edges; by default a third of the fillet, or a fiftieth of the body's width if its edge is sharp."""
    growth: Annotated[float, Field(gt=0, le=2)] = 0.5
    """Growth of the element size per distance from the edges, dimensionless."""
    coarsest: Positive[Length] | None = None
    """Largest element size; by default a fifth of the specimen's thickness."""
    refinement: Positive[float] = 1.0
    """Divides every size: 2 halves the elements."""
    adaptive: bool = True
    """Whether elements that sliding and stretching make too long are split on the way."""


@dataclass(frozen=True)
class GradedSection:
    """A specimen's section with elements that are smallest where the body touches it.

    Attributes
    ----------
    specimen : the tissue
    settings : what the case says of the sizes
    shape : that of the body
    rims : radii in m of circles on the surface, at which elements are smallest and which are nodes; on the axis if there are none
    reach : how far around them, in m, elements are smallest
    usual : smallest size in m unless the case gives another
    """

    specimen: Specimen
    settings: MeshSettings
    shape: ContactShape
    rims: tuple[float, ...]
    reach: float
    usual: float

    def size(self) -> Size:
        """Wanted element size in m, at points in the frame of the body at first touch.

        Around a round tip, elements finer than usual are wanted at the surface only: in the depth, stresses vary over a distance
        like the radius of the contact, which the usual size resolves.
        """
        settings, usual, reach = self.settings, self.usual, self.reach
        finest, n = settings.finest or usual, settings.refinement
        coarsest = settings.coarsest or max(self.specimen.thickness / 5, finest)
        edges = np.array([(r, 0.0) for r in self.rims or [0.0]])
        growth, shallow = settings.growth / n, self.shape.tip is not None and finest < usual
        around = usual if shallow else finest
        size = edge_graded(edges, finest=around / n, growth=growth, coarsest=max(coarsest, around) / n, reach=reach)
        return finer_at_surface(size, finest=finest / n, growth=growth, reach=reach) if shallow else size

    def mesh(self) -> QuadraticMesh:
        """The mesh; in an annulus's hole, finer at the peak of the rise too."""
        size, n = self.size(), self.settings.refinement
        if self.shape.hole:
            size = graded_to_peak(size, finest=self.shape.hole / PEAK_ELEMENTS / n, growth=self.settings.growth / n)
        return self.specimen.mesh(size, self.rims, keys=KEYS)

    def top_edges(self, mesh: QuadraticMesh) -> Array:
        """Boundary edges (F, 3) of the mesh that the body may touch, by node numbers."""
        facets, _ = mesh.boundary_facets()
        radius, height = np.moveaxis(mesh.nodes[facets], -1, 0)
        top = self.specimen.depth_of_cap(radius) * (1.0 if self.specimen.surface == "concave" else -1.0)
        return facets[(np.abs(height - top) < 1e-9 * self.specimen.thickness).all(axis=1)]
