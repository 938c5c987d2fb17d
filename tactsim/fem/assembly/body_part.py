"""A part of a body that stands for the whole: which of the body's unknowns and facets it has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body


@dataclass(frozen=True, eq=False)
class BodyPart:
    """A part of a body on one side of planes across which it is its own mirror image.

    Attributes
    ----------
    body : the part
    nodes : (n',) its nodes by their numbers in the whole, ascending
    unknowns : (size',) its unknowns by their numbers in the whole
    sides : (size',) how many parts share each of them; what acts on an unknown of the whole is borne by all of these alike
    """

    body: Body
    nodes: Array
    unknowns: Array
    sides: Array

    def share(self, forces: Array) -> Array:
        """What acts on the part (size',) of nodal forces on the whole (size,)."""
        return forces[self.unknowns] / self.sides

    def facets(self, facets: Array) -> tuple[Array, Array]:
        """Which (F',) of the facets (F, a) of the whole lie on the part, and these (F', a) by its own node numbers."""
        chosen = np.flatnonzero(np.isin(facets, self.nodes).all(axis=1))
        return chosen, np.searchsorted(self.nodes, facets[chosen])
