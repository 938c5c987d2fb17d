"""Layers of cells between curved surfaces and the boxes around them: their edges bulge with the surface beneath.

Where a layer is thinner than the surface is curved, the mid-nodes of the surface would reach through straight cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.solid import FACES
from tactsim.mesh.fitting.constrained import Constraints


@dataclass(frozen=True)
class Layers:
    """Layers of cells between curved surfaces and the boxes around them.

    Attributes
    ----------
    beneath : (n,) corner of the surface beneath each corner of a layer, of the surface itself and of the box; -1 elsewhere
    share : (n,) distance from the surface over that of the box
    """

    beneath: Array
    share: Array

    @classmethod
    def none(cls, count: int) -> Layers:
        """Corners (count,) in no layer."""
        return cls(np.full(count, -1), np.zeros(count))

    def with_body(self, inside: int, box: Array, ends: Array) -> Layers:
        """These corners, then those of a body: some inside it, those of its surface, and as many at each end (k,) of a layer.

        The last layer leads from the last end to the corners ``box`` (w,), which are among these.
        """
        wall = len(self.beneath) + inside + np.arange(len(box))
        beneath, share = self.beneath.copy(), self.share.copy()
        beneath[box], share[box] = wall, 1.0
        return Layers(
            np.concatenate([beneath, np.full(inside, -1), np.tile(wall, 1 + len(ends))]),
            np.concatenate([share, np.zeros(inside), np.repeat([0.0, *ends], len(box))]),
        )

    def repeated(self, times: int) -> Layers:
        """These corners several times, one after the other."""
        count, copies = len(self.beneath), np.tile(self.beneath, (times, 1))
        beneath = np.where(copies < 0, -1, copies + count * np.arange(times)[:, None])
        return Layers(beneath.ravel(), np.tile(self.share, times))

    def with_others(self, count: int) -> Layers:
        """These corners, then so many in no layer."""
        return Layers(np.append(self.beneath, np.full(count, -1)), np.append(self.share, np.zeros(count)))

    def kept(self, used: Array) -> Layers:
        """Corners ``used`` (m,), ascending, renumbered; those of surfaces beneath are among them."""
        beneath = self.beneath[used]
        return Layers(np.where(beneath < 0, -1, np.searchsorted(used, beneath)), self.share[used])

    def bulges(self, nodes: Array, edges: Array, constraints: Constraints) -> tuple[Array, Array, Array]:
        """Numbers (m,) of edges (e, 2) in layers, the corners (m, 2) of the surface beneath, and their bulge (m, 3) in m."""
        beneath, share = self.beneath[edges], self.share[edges].mean(axis=1)
        on = constraints.on[beneath].all(axis=1)
        within = (beneath >= 0).all(axis=1) & (beneath[:, 0] != beneath[:, 1]) & (share > 0) & (share < 1)
        chosen = within & on[:, len(FACES) :].any(axis=1)
        beneath, on = np.sort(beneath[chosen], axis=1), on[chosen]
        straight = nodes[beneath].mean(axis=1)
        bulge = Constraints(constraints.patches, on, constraints.size).restored(straight) - straight
        return np.flatnonzero(chosen), beneath, (1 - share[chosen])[:, None] * bulge
