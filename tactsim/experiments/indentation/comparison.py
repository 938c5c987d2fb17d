"""A timed indentation beside the closed form of the annulus."""

from __future__ import annotations

import math

import numpy as np

from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.experiments.indentation.setup import IndentationSetup, Timed
from tactsim.materials.viscoelasticity import shear_compliance


class Comparison:
    """What the closed form that a case asks for says at the times of accepted steps, with the small-strain moduli."""

    def __init__(self, setup: IndentationSetup, drive: Timed):
        self._drive, self._history = drive, drive.loading.history()
        specimen, radius = setup.specimen, setup.contact_radius
        self._annulus = ViscoelasticAnnulus(
            outer_radius=radius,
            radius_ratio=setup.body.contact_shape.hole / radius,
            shear_compliance=shear_compliance(specimen.material),
            radius_over_thickness=radius / specimen.thickness if drive.compare == "layer" else 0.0,
            base="bonded" if specimen.base == "fixed" else "slipping",
        )

    def values(self, time: float, prescribed: float, computed: dict[str, float]) -> dict[str, float]:
        """Displacement in m and force in N of the closed form at a time in s, and the relative difference of the answer.

        ``prescribed`` is the force or displacement at that time, ``computed`` the values of the simulation.
        """
        now = np.array([time])
        if self._drive.by_force:
            displacement, force = float(self._annulus.displacement(self._history, now)[0]), prescribed
            difference = computed["displacement"] / displacement - 1 if displacement else math.nan
        else:
            force, displacement = float(self._annulus.force(self._history, now)[0]), prescribed
            difference = computed["reaction_force"] / force - 1 if force else math.nan
        return {"closed_form_displacement": displacement, "closed_form_force": force, "closed_form_difference": difference}
