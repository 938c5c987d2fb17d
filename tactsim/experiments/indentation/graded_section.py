"""The section of a specimen under a rigid body, and the sizes of its elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
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

PEAK_ELEMENTS = 16
"""Elements over the radius of an annulus's hole that the size at the peak of the rise, on the axis, would allow.

Why: that peak decides the threshold, whose pressure grows with nearly the third power of it, and on the axis a single height is
known less well than its neighbours. In `annulus_icf` the threshold is 0.05 % too high with these, 0.06 % with 12 and 0.15 %
with 6, for 2 827, 2 766 and 2 711 nodes."""

KEYS = "mesh.finest, mesh.coarsest, mesh.growth and mesh.refinement"
"""What a case gives of the sizes."""


class MeshSettings(FrozenModel):
    """Size of the elements: finest at the edges of the body, growing with the distance from them."""

    finest: Positive[Length] | None = None
    """Element size at the edges; by default a third of the fillet, or a fiftieth of the body's radius if its edge is sharp."""
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
    reach : how far around them, in m, elements are smallest on the surface
    usual : smallest size in m unless the case gives another
    deep : smallest size in m in the depth, as far around the rims as on the surface; None if none are small there
    """

    specimen: Specimen
    settings: MeshSettings
    shape: ContactShape
    rims: tuple[float, ...]
    reach: float
    usual: float
    deep: float | None = None

    def size(self) -> Size:
        """Wanted element size in m, at points in the frame of the body at first touch.

        Small elements are wanted at the surface only. In the depth, stresses vary over the distance from it: a quarter more nodes
        would lie beneath the fillets of `annulus_icf`, for nothing. Around a round tip they vary over the radius of the contact,
        which the usual size resolves.
        """
        n, growth = self.settings.refinement, self.settings.growth / self.settings.refinement
        finest, radii = self.settings.finest or self.usual, np.array(self.rims or [0.0])
        coarsest = max(self.settings.coarsest or self.specimen.thickness / 5, finest)
        at_surface = partial(finer_at_surface, radii=radii, finest=finest / n, growth=growth, reach=self.reach)
        beneath = self.deep if self.shape.tip is None else self.usual
        if beneath is None:
            return at_surface(lambda points: np.full(len(points), coarsest / n))
        beneath = max(beneath, finest)
        edges, most = np.column_stack([radii, np.zeros_like(radii)]), max(coarsest, beneath)
        return at_surface(edge_graded(edges, finest=beneath / n, growth=growth, coarsest=most / n, reach=self.reach))

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
