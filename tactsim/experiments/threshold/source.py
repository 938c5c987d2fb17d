"""Where the forces on a threshold sensor come from: a closed form, a simulation made before or now, or a stored curve."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Generator
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.analytic.histories import History, Segment
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.array import Array
from tactsim.errors import InvalidQuantity, Unfinished
from tactsim.experiments.annulus.closed_form import check_closed_form
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.threshold.contact_curve import Approach, ContactCurve, SensorShape
from tactsim.identification.columns import of_file, read_columns
from tactsim.interfaces.run import run_within_another
from tactsim.materials import AnyMaterial
from tactsim.materials.viscoelasticity import shear_compliance
from tactsim.model import FrozenModel
from tactsim.outside.input_path import InputPath
from tactsim.results.reading import read_basis
from tactsim.results.result import Status, StepRecord
from tactsim.units import Length, Positive, format_quantity

COLUMNS = {"displacement": "m", "plate force": "N", "tissue rise": "m", "small sensor force": "N"}


class ClosedFormTissue:
    """A flat annulus on linear viscoelastic tissue, and its small sensor as a solid punch of the hole's radius.

    Source: thesis, 4.6.1; the punch is the annulus without a hole, which the tissue meets at the speed of its rise.
    """

    def __init__(self, shape: SensorShape, annulus: ViscoelasticAnnulus, punch: ViscoelasticAnnulus, beyond: float):
        self.shape, self._annulus, self._punch, self._beyond = shape, annulus, punch, beyond

    def approach(self, speed: float) -> Approach:
        """The forces over time at a speed in m/s."""
        rise = self._annulus.touch_factor
        touch = self.shape.recess / rise / speed
        duration = touch + self._beyond / speed
        down, inward = (History((Segment(0.0, duration, 0.0, rate),)) for rate in (speed, rise * speed))

        def forces(times: Array) -> tuple[Array, Array]:
            return self._annulus.force(down, times), self._punch.force(inward, times - touch)

        threshold = float(self._annulus.force(down, touch))
        return Approach(speed, duration, touch, threshold, forces)


Tissue = Generator[StepRecord, None, ClosedFormTissue | ContactCurve]
"""Yields the steps of what is simulated first, if anything, and returns the forces on the sensor."""


class Source(FrozenModel):
    """What gives the forces on a sensor."""

    @abstractmethod
    def tissue(self) -> Tissue:
        """The tissue that the sensor meets."""

    def assumptions(self) -> list[str]:
        """Assumptions of the contact that the result lists: those of a curve."""
        return [
            "the tissue's force depends on the displacement alone, not on the speed: elastic tissue",
            "past the touch the small sensor bears what the simulation computed; where it ended at the touch, a solid punch of "
            "the hole's radius on tissue of the plate's last tangent stiffness",
        ]


class ClosedFormSource(Source):
    """The annulus on linear viscoelastic tissue by its closed form: small displacements, frictionless."""

    kind: Literal["closed_form"] = "closed_form"
    material: AnyMaterial
    """Tissue; its small-strain shear relaxation counts; incompressible."""
    inner_radius: Positive[Length] = 1.5e-3
    """Radius of the hole, that of the small sensor."""
    outer_radius: Positive[Length] = 3e-3
    """Radius of the face."""
    recess: Positive[Length] = 0.8e-3
    """Depth L of the small sensor."""
    thickness: Positive[Length] | None = None
    """Thickness of the tissue on a rigid base; null is a half-space."""
    base: Literal["bonded", "slipping"] = "bonded"
    """How the tissue rests on its base."""
    beyond: Positive[Length] = 0.5e-3
    """Displacement past the touch that is followed; without a trigger up to there a touch counts as missed."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_closed_form(self.inner_radius, self.outer_radius, self.material)
        if self.thickness is not None and self.recess >= self.thickness:
            raise ValueError("the recess must be smaller than the thickness of the tissue (thesis, end of 3.1.1)")
        return self

    def tissue(self) -> Generator[StepRecord, None, ClosedFormTissue]:
        """The contact in closed form.

        Raises
        ------
        InvalidQuantity
            If the annulus would be pressed to the base of the tissue before the small sensor is touched.
        """
        yield from ()
        compliance = shear_compliance(self.material)

        def punch(radius: float, ratio: float) -> ViscoelasticAnnulus:
            slenderness = radius / self.thickness if self.thickness else 0.0
            return ViscoelasticAnnulus(radius, ratio, compliance, radius_over_thickness=slenderness, base=self.base)

        shape = SensorShape(self.inner_radius, self.outer_radius, self.recess)
        annulus = punch(self.outer_radius, self.inner_radius / self.outer_radius)
        if not np.isfinite(annulus.touch_displacement(self.recess)):
            most = format_quantity(annulus.touch_factor * annulus.thickness, "m")
            raise InvalidQuantity(
                f"source.recess {format_quantity(self.recess, 'm')}: the annulus would be pressed to the base of the tissue, "
                f"{format_quantity(annulus.thickness, 'm')} thick, before it is touched; allowed: less than {most} on this tissue"
            )
        return ClosedFormTissue(shape, annulus, punch(self.inner_radius, 0.0), self.beyond)

    def assumptions(self) -> list[str]:
        """Assumptions of the contact that the result lists."""
        return [
            "closed form: linear, incompressible tissue, frictionless contact, small displacements",
            "past the touch the small sensor is a solid punch of the hole's radius that the tissue meets as fast as it rises",
        ]


class RunSource(Source):
    """The history of an indentation that was run before."""

    kind: Literal["run"] = "run"
    path: InputPath
    """Folder of the result, beside the case or in the working folder."""
    beyond: Positive[Length] = 0.2e-3
    """Displacement by which a run that stopped at its threshold is continued with its last slopes."""

    def tissue(self) -> Tissue:
        """The curve in the folder.

        Raises
        ------
        StorageError
            If the folder holds no result that can be read.
        """
        yield from ()
        return ContactCurve.of_result(read_basis(self.path).result, beyond=self.beyond)


class IndentationSource(Source):
    """An indentation that is simulated first; to know what the small sensor feels, let it stop at a displacement."""

    kind: Literal["indentation"] = "indentation"
    experiment: Indentation
    """The indentation, by an annulus with a recess."""
    beyond: Positive[Length] = 0.2e-3
    """Displacement by which a run that stopped at its threshold is continued with its last slopes."""

    def tissue(self) -> Tissue:
        """The curve of the simulation.

        Raises
        ------
        Unfinished
            If it does not come to its end.
        """
        result = yield from run_within_another(self.experiment)
        if result.status is not Status.CONVERGED:
            raise Unfinished(f"the indentation {result.reason}")
        return ContactCurve.of_result(result, beyond=self.beyond)


class CurveSource(Source):
    """A stored curve."""

    kind: Literal["curve"] = "curve"
    path: InputPath
    """CSV file, beside the case or in the working folder; header such as
    ``displacement [mm], plate force [N], tissue rise [mm], small sensor force [N]``; one row stands at the touch."""
    inner_radius: Positive[Length] = 1.5e-3
    """Radius of the hole."""
    outer_radius: Positive[Length] = 3e-3
    """Radius of the face."""
    recess: Positive[Length] = 0.8e-3
    """Depth L of the small sensor."""

    @model_validator(mode="after")
    def _ring(self) -> Self:
        if self.inner_radius >= self.outer_radius:
            inner, outer = format_quantity(self.inner_radius, "m"), format_quantity(self.outer_radius, "m")
            raise ValueError(f"inner_radius {inner} must be below the outer_radius {outer}")
        return self

    def tissue(self) -> Tissue:
        """The curve in the file.

        Raises
        ------
        InvalidQuantity
            If a column is missing, or the rows make no curve; with the file.
        """
        yield from ()
        columns = read_columns(self.path, COLUMNS, complete=True)
        with of_file(self.path):
            return ContactCurve.of_rows(SensorShape(self.inner_radius, self.outer_radius, self.recess), columns)


AnySource = Annotated[ClosedFormSource | RunSource | IndentationSource | CurveSource, Field(discriminator="kind")]
