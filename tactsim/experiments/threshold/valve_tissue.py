"""A surface of several tissues in bands around a valve, and what a small threshold sensor meets on it."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.array import Array
from tactsim.experiments.threshold.tip_contact import SensorContact
from tactsim.model import FrozenModel, check_increasing
from tactsim.relaxation import Relaxation
from tactsim.sensors.threshold.sensor_ring import SensorRing
from tactsim.units import Length, Positive, Pressure


class BandTissue(FrozenModel):
    """The tissue of one band."""

    name: Annotated[str, Field(min_length=1, max_length=40)]
    """Name in figures and warnings."""
    shear_modulus: Positive[Pressure]
    """Small-strain shear modulus."""
    thickness: Positive[Length]
    """Thickness."""
    base: Literal["bonded", "slipping"] = "bonded"
    """How it rests on what lies below."""
    relaxation: Relaxation | None = None
    """Prony series of its stress; null is elastic tissue."""
    threshold_pressure: Positive[Pressure] | None = None
    """Threshold pressure of the sensor on this tissue, from a simulation; null takes the closed form."""


class ValveSurface(FrozenModel):
    """A flat surface of tissues in concentric bands around the middle of a valve, from the middle outward."""

    tissues: Annotated[tuple[BandTissue, ...], Field(min_length=2)]
    """Tissues from the middle outward: leaflet, annulus, atrium."""
    borders: Annotated[tuple[Positive[Length], ...], Field(min_length=1)]
    """Radii of the borders between them, increasing."""

    @model_validator(mode="after")
    def _matching(self) -> Self:
        if len(self.borders) != len(self.tissues) - 1:
            raise ValueError(f"{len(self.tissues)} tissues need {len(self.tissues) - 1} borders, not {len(self.borders)}")
        check_increasing(borders=self.borders)
        names = [tissue.name for tissue in self.tissues]
        if len(set(names)) < len(names):
            raise ValueError("each tissue needs a name of its own")
        return self

    def shares(self, ring: SensorRing, place: tuple[float, float]) -> Array:
        """Part of the disc under each sensor that each tissue has, shape (sensor, tissue); ``place`` of the tip in m."""
        points = (ring.positions + np.array(place))[:, None, :] + ring.face_points()
        band = np.searchsorted(self.borders, np.linalg.norm(points, axis=-1), side="right")
        return np.stack([(band == k).mean(axis=1) for k in range(len(self.tissues))], axis=1)

    def contacts(self, ring: SensorRing) -> list[SensorContact]:
        """The sensor on each tissue alone."""
        return [_contact(tissue, ring) for tissue in self.tissues]

    def mixed(self, ring: SensorRing, place: tuple[float, float]) -> list[SensorContact]:
        """What each sensor meets: over two tissues the mean weighted by area."""
        alone = self.contacts(ring)
        values = np.array([[c.force, c.displacement, c.small_stiffness] for c in alone])
        mixed = (self.shares(ring, place) @ values).tolist()
        return [SensorContact(force, depth, stiffness, ring.recess) for force, depth, stiffness in mixed]


def _contact(tissue: BandTissue, ring: SensorRing) -> SensorContact:
    r"""The annulus and its small sensor on a layer in closed form.

    .. math:: P^* = 8 G a \kappa L / \rho, \quad d^* = L / \rho, \quad k_s = 8 G b \kappa_0

    Source: ``analytic.annular_punch``; kappa_0 and the solid punch from the same without a hole.
    """
    a, b, recess = ring.outer_radius, ring.inner_radius, ring.recess
    annulus = solve_annular_punch(b / a, radius_over_thickness=a / tissue.thickness, base=tissue.base)
    punch = solve_annular_punch(0.0, radius_over_thickness=b / tissue.thickness, base=tissue.base)
    displacement = recess / annulus.largest_rise_factor
    force = 8 * tissue.shear_modulus * a * annulus.force_factor * displacement
    if tissue.threshold_pressure is not None:
        force = tissue.threshold_pressure * ring.area
    return SensorContact(force, displacement, 8 * tissue.shear_modulus * b * punch.force_factor, recess)
