"""Where elements change their volume by far more or less than the pressure in them asks for: the mesh is too coarse there."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.equilibrium.diagnosis import element_in_words
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium

POOR_RATIO = 0.1
"""Difference of a volume ratio from what the pressure asks for that counts as poor: a tenth, far beyond the few per cent that
P2/P1 elements leave at the corners of bodies in meshes that resolve them."""
POOR_SHARE = 1e-3
"""Part of the volume with poor ratios of which a user is warned: a few points at sharp corners are less and do no harm."""


def poor_share(body: Body, error: Array, off: float = POOR_RATIO) -> float:
    """Part of the volume whose ratios are ``off`` by more than that, an ``error`` (E, Q) says how far; poor ones by default."""
    weights = body.points.weights
    return float(weights[np.abs(error) > off].sum() / weights.sum())


class VolumeRatios:
    """The worst of the accepted states of one run; ``finer`` says what refines the mesh."""

    def __init__(self, finer: str = "take smaller elements") -> None:
        self.worst, self._worst_in_words, self._finer = 0.0, "", finer

    def poor_share(self, body: Body, state: ContactEquilibrium) -> float:
        """Part of the volume with poor ratios in a state."""
        error = body.volume_error(state.unknowns, state.kinematics)
        share = poor_share(body, error)
        if share > self.worst:
            self.worst, ratios = share, state.kinematics.J[np.abs(error) > POOR_RATIO]
            self._worst_in_words = f"{ratios.min():.3g} to {ratios.max():.3g}, the worst in {_place(body, error)}"
        return share

    def warnings(self) -> list[str]:
        """Warnings about the worst state: how much, where, and what to do."""
        if self.worst <= POOR_SHARE:
            return []
        return [
            f"{100 * self.worst:.2f} % of the volume misses the volume that its pressure asks for by more than "
            f"{100 * POOR_RATIO:.0f} % (local volume ratios of {self._worst_in_words}): the mesh is too coarse "
            f"there; {self._finer}"
        ]


def _place(body: Body, error: Array) -> str:
    """The element with the largest error: its number, undeformed centroid and region."""
    element = int(np.abs(error).max(axis=1).argmax())
    return element_in_words(body, element)
