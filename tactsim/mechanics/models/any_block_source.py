"""All that gives the mesh of a block, and the choice among them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tactsim.array import Array
from tactsim.interfaces import Inclusion
from tactsim.mechanics.models.block_file import FileSource
from tactsim.mechanics.models.block_source import (
    BlockSource,
    GradedSource,
    LayersSource,
    Size,
    StructuredSource,
    TetrahedraSource,
)


class AutomaticSource(BlockSource):
    """Graded cells where they can follow the inclusions; tetrahedra around free forms, and bodies below the edge of a jaw."""

    finer: ClassVar[str] = (
        "take a smaller edge_size at the edges of the jaws, a smaller inclusion_size at an inclusion, both under mesh.graded, or "
        "mesh.tetrahedra where these are taken"
    )
    nearer: ClassVar[str] = "less with a smaller inclusion_size under mesh.graded, or mesh.tetrahedra where these are taken"
    kind: Literal["automatic"] = "automatic"
    graded: GradedSource = GradedSource()
    """The cells around spheres, ellipsoids and tubes."""
    tetrahedra: TetrahedraSource = TetrahedraSource()
    """The tetrahedra otherwise."""

    def least_gap(self, size: Size) -> float:
        """Least distance in m between inclusions, and from faces, that either mesh needs in a block of this size in m."""
        return min(source.least_gap(size) for source in (self.graded, self.tetrahedra))

    def chosen(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> GradedSource | TetrahedraSource:
        """What suits these inclusions in a block of this size in m, and jaws with these ``flats`` (2, 2) in m."""
        return self.graded if self.graded.misfit(size, inclusions, flats) is None else self.tetrahedra


AnySource = TetrahedraSource | LayersSource | GradedSource | StructuredSource | FileSource
"""What gives a mesh."""
AnyBlockSource = Annotated[AutomaticSource | AnySource, Field(discriminator="kind")]
