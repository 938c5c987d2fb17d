"""How the forces of a tip's sensors on their tissues are computed: in closed form, or by finite elements of every tissue."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.array import Array
from tactsim.contact.annulus import Annulus
from tactsim.contact.coulomb import Coulomb
from tactsim.errors import Unfinished
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.experiments.threshold.contact_curve import ContactCurve, SensorShape, continued
from tactsim.experiments.threshold.source import ClosedFormSource
from tactsim.experiments.threshold.tip_contact import SensorContact, TipContact, mixed_contacts
from tactsim.experiments.threshold.valve_tissue import BandTissue, ValveSurface
from tactsim.interfaces.run import returned_by, run_within_another
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mechanics.paths.loading import close
from tactsim.model import FrozenModel
from tactsim.results.result import Result, Status, StepRecord
from tactsim.sensors.threshold.sensor_ring import SensorRing
from tactsim.units import Length, Positive

if TYPE_CHECKING:
    from tactsim.mechanics.models.annulus_on_bands import AnnulusOnBands

WIDTH = 6.0
"""Radius of the piece of tissue that finite elements compute, over the outer radius of a sensor."""
DEEPEST, FURTHEST = 0.8, 5.0
"""Most that is tried to reach a threshold: part of the thickness, and times the displacement of the closed form."""
SAMPLES = 60
"""Rows by which an approach in closed form is stored."""
FLAT_ERRORS = (
    # recess over outer radius, and threshold by finite elements over the closed form, less one: smallest and largest
    (0.05, -0.099, -0.090),
    (0.10, -0.050, -0.011),
    (0.15, -0.008, 0.073),
)
"""Neo-Hookean layers of 2 to 6 outer radii, bonded or slipping; fillet a twentieth of the radius, friction 0 to 0.4. A test
computes rows anew; beyond them, at 0.20 with friction 0.4, the difference is 0.175."""
FLAT_OWN = 0.007
"""Part of these errors, up or down, that sensors do not share: at one recess and friction it varies by up to 1.3 % in all with
thickness and base."""
BORDER_ERROR = 0.06
"""Error of the mean by area at a border over the logarithm of the ratio of the two thresholds, at most: the linear model in 3D
differs by 2.4 % at a ratio of 2, 8.8 % at 6, and by 6.6 % at 3 where thickness and base change too. A test computes it again."""
NEAR = 1.5
"""Distance of a sensor's axis from a border, in outer radii, up to which the border counts."""
FEM_ERROR, FEM_BORDER_ERROR = 0.01, 0.03
"""Errors of the finite elements: of the mesh, and near a border of the small piece of tissue and its linear law too."""


class ClosedFormTip(FrozenModel):
    """The annulus on a linear layer, frictionless; over two tissues the mean weighted by area."""

    kind: Literal["closed_form"] = "closed_form"

    def contacts(
        self, surface: ValveSurface, ring: SensorRing, place: tuple[float, float], speed: float
    ) -> Generator[StepRecord, None, list[TipContact]]:
        """Returns what each sensor of a tip at a place in m meets at a speed in m/s, with the errors of the closed form."""
        yield from ()  # no simulation
        shares = surface.shares(ring, place)
        if any(tissue.relaxation is not None for tissue in surface.tissues):
            curves = [relaxing_curve(tissue, ring, speed) for tissue in surface.tissues]
            contacts: Sequence[SensorContact] = mixed_contacts(curves, shares, np.ones((len(shares), 2)))
        else:
            contacts = surface.mixed(ring, place)
        alone = [contact.force for contact in surface.contacts(ring)]
        low, high = flat_errors(ring.recess / ring.outer_radius)
        borders = border_errors(surface, ring, place, alone, factor=BORDER_ERROR)
        return [
            TipContact(contact, low - border, high + border, FLAT_OWN + border)
            for contact, border in zip(contacts, borders.tolist(), strict=True)
        ]

    def assumptions(self, recess_ratio: float) -> list[str]:
        """What the closed form leaves out, and what finite elements say of it."""
        low, high = flat_errors(recess_ratio)
        return [
            "linear, incompressible tissue, frictionless and without a fillet; sensors do not feel each other",
            f"beside finite elements (neo-Hookean, fillet of a twentieth of the radius, friction 0 to 0.4) flat thresholds are "
            f"{100 * low:+.0f} to {100 * high:+.0f} % of the closed form's away from it at this recess, alike for all sensors",
            "over two tissues a sensor meets their mean weighted by area; finite elements differ by up to 9 % at a sixfold ratio",
        ]


class FiniteElementTip(FrozenModel):
    """Every tissue by axisymmetric finite elements at finite strain; borders by a linear model in 3D of each sensor.

    A sensor near a border has the mean of its tissues weighted by area, times what the model in 3D finds over that mean.
    """

    kind: Literal["fem"] = "fem"
    friction: Annotated[float, Field(ge=0, le=2)] = 0.4
    """Coefficient of friction."""
    fillet: Positive[Length] | None = None
    """Fillet of the edges of a sensor; null is a twentieth of its outer radius."""
    surface_radius: Positive[Length] | None = None
    """Radius of a convex surface under each sensor; null is flat. Near a border the correction is that of a flat surface."""

    def contacts(
        self, surface: ValveSurface, ring: SensorRing, place: tuple[float, float], speed: float
    ) -> Generator[StepRecord, None, list[TipContact]]:
        """Yields the steps of all tissues, and returns what each sensor of a tip at a place in m meets at a speed in m/s.

        Raises
        ------
        Unfinished
            If a tissue does not reach the recess.
        """
        shares, factors = surface.shares(ring, place), border_factors(surface, ring, place)
        curves = []
        for tissue in surface.tissues:
            curves.append((yield from self.curve(tissue, ring, speed)))
        contacts = mixed_contacts(curves, shares, factors)
        near = (factors != 1.0).any(axis=1)
        errors = FEM_ERROR + np.where(near, FEM_BORDER_ERROR, 0.0)
        return [TipContact(c, -e, e, e) for c, e in zip(contacts, errors.tolist(), strict=True)]

    def curve(self, tissue: BandTissue, ring: SensorRing, speed: float) -> Generator[StepRecord, None, ContactCurve]:
        """Yields the steps of a sensor that is pressed into one tissue, flat or convex, at a speed in m/s; returns its forces.

        Raises
        ------
        Unfinished
            If the tissue does not reach the recess.
        """
        result = yield from run_within_another(self._pressed(tissue, ring, speed))
        shape = _shape(ring)
        if result.status is not Status.CONVERGED:
            raise Unfinished(f"the {tissue.name} under a sensor: {result.reason}")
        names = ("displacement", "reaction_force", "tissue_rise")
        rows = np.array([[0.0] * 4] + [[*(step.values[name] for name in names), 0.0] for step in result.steps])
        rows[0, 2] = self._rise_at_touch(ring)
        rows = rows[: 1 + _touch_row(result, rows, ring.recess)]
        rows[:, 2] = np.minimum(rows[:, 2], ring.recess)
        rows = np.vstack([rows, continued(rows, shape, tissue.thickness)])
        displacement, plate, rise, small = np.maximum(rows.T, 0.0)
        return ContactCurve(shape, displacement, plate, rise, small, len(rows) - 2)

    def assumptions(self, recess_ratio: float) -> list[str]:
        """What the finite elements take."""
        curved = "flat" if self.surface_radius is None else f"convex with a radius of {1e3 * self.surface_radius:g} mm"
        return [
            f"tissues by finite elements: neo-Hookean, surface {curved}, friction {self.friction:g}; sensors do not feel "
            "each other",
            "past the touch the small sensor is a solid punch on tissue of the last tangent stiffness",
            "near a border: area's mean times what a linear model in 3D, flat and frictionless, finds over that mean",
        ]

    def _pressed(self, tissue: BandTissue, ring: SensorRing, speed: float) -> Indentation | TimedIndentation:
        a = ring.outer_radius
        body = Annulus(inner_radius=ring.inner_radius, outer_radius=a, fillet=self.fillet or a / 20)
        radius = WIDTH * a if self.surface_radius is None else min(WIDTH * a, 0.8 * self.surface_radius)
        specimen = Specimen(
            material=NeoHookean(c10=tissue.shear_modulus / 2, relaxation=tissue.relaxation),
            thickness=tissue.thickness,
            radius=radius,
            base="fixed" if tissue.base == "bonded" else "slipping",
            surface="flat" if self.surface_radius is None else "convex",
            surface_radius=self.surface_radius,
        )
        closed = solve_annular_punch(ring.inner_radius / a, radius_over_thickness=a / tissue.thickness, base=tissue.base)
        deepest = min(DEEPEST * tissue.thickness, FURTHEST * ring.recess / closed.rise_factor)
        common = {"specimen": specimen, "body": body, "contact": Coulomb(friction=self.friction), "recess": ring.recess}
        if tissue.relaxation is None:
            return Indentation(**common, displacement=deepest)
        return TimedIndentation(**common, loading=close(to=deepest, duration=deepest / speed), stop="touch")

    def _rise_at_touch(self, ring: SensorRing) -> float:
        """Rise in m of a convex surface into the hole when the face touches it."""
        if self.surface_radius is None:
            return 0.0
        inner = ring.inner_radius + (self.fillet or ring.outer_radius / 20)
        return float(self.surface_radius - np.sqrt(self.surface_radius**2 - inner**2))


TipModel = Annotated[ClosedFormTip | FiniteElementTip, Field(discriminator="kind")]


def _shape(ring: SensorRing) -> SensorShape:
    return SensorShape(ring.inner_radius, ring.outer_radius, ring.recess)


def _touch_row(result: Result, rows: Array, recess: float) -> int:
    """Row of the touch: the event of an indentation, or the last of a history that stops there."""
    reached = result.quantities.get("threshold_displacement")
    if reached is not None:
        return int(np.argmin(np.abs(rows[:, 0] - reached.value)))
    return int(np.argmin(np.abs(rows[:, 2] - recess)))


def relaxing_curve(tissue: BandTissue, ring: SensorRing, speed: float) -> ContactCurve:
    """Forces on a sensor that is pressed into relaxing tissue at a speed in m/s, in closed form."""
    source = ClosedFormSource(
        material=NeoHookean(c10=tissue.shear_modulus / 2, relaxation=tissue.relaxation),
        inner_radius=ring.inner_radius,
        outer_radius=ring.outer_radius,
        recess=ring.recess,
        thickness=tissue.thickness,
        base=tissue.base,
        beyond=tissue.thickness,
    )
    approach = returned_by(source.tissue()).approach(speed)
    times = np.concatenate([np.linspace(0, approach.touch, SAMPLES), np.linspace(approach.touch, approach.duration, SAMPLES)[1:]])
    plate, small = approach.at(times)
    rise = ring.recess * times / approach.touch
    return ContactCurve(_shape(ring), speed * times, plate, rise, small, SAMPLES - 1)


def flat_errors(recess_ratio: float) -> tuple[float, float]:
    """Smallest and largest relative difference of finite elements from the closed form, at a recess over the outer radius.

    Linear between the rows of ``FLAT_ERRORS`` and prolonged with the last slopes beyond.
    """
    ratio, low, high = np.array(FLAT_ERRORS).T
    k = int(np.clip(np.searchsorted(ratio, recess_ratio) - 1, 0, len(ratio) - 2))
    part = (recess_ratio - ratio[k]) / (ratio[k + 1] - ratio[k])
    return float(low[k] + part * (low[k + 1] - low[k])), float(high[k] + part * (high[k + 1] - high[k]))


def border_errors(
    surface: ValveSurface, ring: SensorRing, place: tuple[float, float], alone: Sequence[float], *, factor: float
) -> Array:
    """Relative error (sensor,) of the mean by area near borders, from the thresholds of the tissues ``alone`` in N."""
    distance = np.linalg.norm(ring.positions + np.array(place), axis=1)
    errors = np.zeros(ring.count)
    for border, inner, outer in zip(surface.borders, alone[:-1], alone[1:], strict=True):
        near = np.abs(distance - border) < NEAR * ring.outer_radius
        errors = np.maximum(errors, near * factor * abs(np.log(outer / inner)))
    return errors


def border_factors(surface: ValveSurface, ring: SensorRing, place: tuple[float, float]) -> Array:
    """Threshold force and displacement by the linear model in 3D over the means by area, shape (sensor, 2), 1 off borders.

    Raises
    ------
    ConvergenceError
        If a linear system is singular.
    """
    from tactsim.mechanics.models.annulus_on_bands import AnnulusOnBands, Band

    factors = np.ones((ring.count, 2))
    distance = np.linalg.norm(ring.positions + np.array(place), axis=1)
    near = (np.abs(distance[:, None] - np.array(surface.borders)) < NEAR * ring.outer_radius).any(axis=1)
    if not near.any():
        return factors
    bands = tuple(Band(tissue.shear_modulus, tissue.thickness, tissue.base) for tissue in surface.tissues)
    model = AnnulusOnBands(ring.inner_radius, ring.outer_radius, bands, surface.borders)
    alone = np.array([model.alone(k).threshold(ring.recess) for k in range(len(bands))])
    shares = surface.shares(ring, place)
    for sensor in np.flatnonzero(near):
        factors[sensor] = _at(model, float(distance[sensor]), ring.recess) / (shares[sensor] @ alone)
    return factors


def _at(model: AnnulusOnBands, distance: float, recess: float) -> Array:
    return np.array(model.at(distance).threshold(recess))
