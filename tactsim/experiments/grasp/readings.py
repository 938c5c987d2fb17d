"""What the taxels of both jaws read in a state, checked against the force that the equilibrium knows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.surface_forces import TaxelForces
from tactsim.mechanics.models.block_model import GraspModel

SUMS = 1e-8
"""Largest difference of taxels, gaps and outside from the force on the jaw, over the size of all."""
NOTHING = 1e-12
"""Force over shear modulus and area of the block that counts as none."""


@dataclass(frozen=True)
class JawReading:
    """``taxels`` are forces in N in the jaw's own axes, z pressing into its face; ``force`` (3,) in N is that in the block's."""

    taxels: TaxelForces
    force: Array

    @property
    def normal(self) -> float:
        """Force in N that presses into the face."""
        return float(self.taxels.total[2])


def jaw_readings(model: GraspModel, state: ContactEquilibrium, layout: TaxelLayout) -> dict[str, JawReading]:
    """The readings of the upper and the lower jaw.

    Raises
    ------
    ConvergenceError
        If the forces on taxels, in gaps and outside do not add up to the force on the jaw.
    """
    readings = {side: JawReading(model.taxels(state, side, layout), model.jaw_force(state, side)) for side in JAWS}
    extent = np.ptp(model.mesh.nodes, axis=0)
    least = NOTHING * model.body.materials[0].shear_modulus * float(extent[0] * extent[1])
    for side, reading in readings.items():
        check_sums(reading, model.jaws[side].rotation, side, least)
    return readings


def check_sums(reading: JawReading, rotation: Array, side: str, least: float) -> None:
    """Refuse a reading whose parts do not add up to the force on the jaw; ``least`` in N is a force that counts as none.

    ``rotation`` (3, 3) turns the jaw's own axes into those of the tissue.

    Raises
    ------
    ConvergenceError
        If they do not add up to the force on the jaw.
    """
    resultant, parts = rotation.T @ reading.force, reading.taxels
    size = float(np.abs(parts.taxels).sum() + np.abs(parts.gaps).sum() + np.abs(parts.outside).sum() + np.abs(resultant).sum())
    missed = float(np.abs(parts.total - resultant).max())
    if not missed <= SUMS * size + least:
        raise ConvergenceError(
            f"taxels, gaps and outside of the {side} jaw miss its force by {missed:.2e} N of {size:.2e} N; "
            f"allowed: {SUMS:g} of it"
        )
