"""Whether a part of a body is strained beyond what its theory of small strains, exact to first order, can answer."""

from __future__ import annotations

import numpy as np

from tactsim.fem.assembly.body import Body, Kinematics

LARGE = 0.1
"""Displacement gradient from which on a law of small strains is warned of: it leaves out what is of this part of its answer."""


class SmallStrains:
    """Follows the displacement gradients of elements with a law of small strains; ``largest`` is the largest mean of any state.

    The mean is weighted with the energy, half the work of the stress on the gradient, so that corners of contacts, where
    gradients are large in a few cells whatever the load, do not count for more than they do in the answer.
    """

    def __init__(self) -> None:
        self.largest = 0.0
        self._kinds: set[str] = set()

    def observe(self, body: Body, state: Kinematics) -> None:
        """Take in the deformation of the next accepted state."""
        energies, sizes = [], []
        for index, material in enumerate(body.materials):
            mine = body.regions == index
            if material.small_strain and mine.any():
                F = state.F[:, :, mine]
                gradient = F - np.eye(3)[:, :, None, None]
                pressure = (material.bulk_modulus or 0.0) * material.volume_change(F)
                work = np.einsum("iJeq,iJeq->eq", material.first_piola_kirchhoff(F, pressure), gradient)
                energies.append((body.points.weights[mine] * np.maximum(work, 0.0) / 2).ravel())
                sizes.append(np.linalg.norm(gradient, axis=(0, 1)).ravel())
                self._kinds.add(material.kind)
        energy = np.concatenate(energies) if energies else np.zeros(0)
        if energy.sum() > 0:
            self.largest = max(self.largest, float(energy @ np.concatenate(sizes) / energy.sum()))

    def warnings(self) -> list[str]:
        """The warning, if the gradients are large."""
        if self.largest < LARGE:
            return []
        return [
            f"{' and '.join(sorted(self._kinds))} is a law of small strains and rotations, and displacement gradients are "
            f"{self.largest:.2g} in the mean: its answer is off by about that part of itself; take neo_hookean, with "
            "c10 = E / (4 (1 + nu)) and bulk_modulus E / (3 (1 - 2 nu)), which is the same for small strains"
        ]
