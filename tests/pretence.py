"""A small experiment for the tests of case files, results and the command line; it is not part of the package."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from tactsim.errors import InvalidQuantity, Unfinished, UnknownName
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.model import FrozenModel
from tactsim.results import FieldFrame, Quantity, Result, Scene, Status, StepRecord
from tactsim.units import Length, Pressure, Time


class PretendedScene(Scene):
    """What figures of it would need."""

    kind: Literal["pretence"] = "pretence"
    profile: tuple[float, ...]
    """Heights in m."""


class Soft(FrozenModel):
    """A material with one modulus."""

    kind: Literal["soft"] = "soft"
    modulus: Pressure = Field(gt=0)
    """Shear modulus."""


class Stiff(FrozenModel):
    """A material with two coefficients."""

    kind: Literal["stiff"] = "stiff"
    c10: Pressure
    """Coefficient of (I1 - 3)."""
    exponent: int = Field(default=2, ge=1, le=6)
    """Power of the second term."""


class Layer(FrozenModel):
    """A layer of the specimen."""

    thickness: Length = Field(gt=0)
    """Thickness at rest."""
    material: Annotated[Soft | Stiff, Field(discriminator="kind")]
    """What it is made of."""


class Specimen(FrozenModel):
    """A stack of layers."""

    radius: Length = Field(default=0.02, gt=0)
    """Outer radius."""
    layers: tuple[Layer, ...] = Field(min_length=1)
    """From the bottom up."""
    hole: Length | None = None
    """Radius of the hole, if there is one."""

    @model_validator(mode="after")
    def _hole_is_inside(self) -> Specimen:
        if self.hole is not None and self.hole >= self.radius:
            raise InvalidQuantity(f"hole {self.hole:g} m must be smaller than radius {self.radius:g} m")
        return self


class Pretence(Experiment):
    """Counts steps; ends as its fields say."""

    history_units: ClassVar[dict[str, str]] = {"displacement": "m", "reaction_force": "N"}

    kind: Literal["pretence"] = "pretence"
    specimen: Specimen
    """What is pressed."""
    element_size: Length | Literal["auto"] = "auto"
    """Size of an element."""
    friction: float = Field(default=0.4, ge=0, le=2)
    """Coefficient of friction."""
    steps: int = Field(default=3, ge=0, le=10_000)
    """Number of steps."""
    pause: Time = Field(default=0.0, ge=0)
    """Waiting time per step."""
    fail_at: int | None = None
    """Step that does not converge."""
    stubborn: bool = False
    """Whether what was found takes its time."""
    named: str = "known"
    """A name that must be 'known'."""

    @model_validator(mode="after")
    def _name_is_known(self) -> Pretence:
        if self.named != "known":
            raise UnknownName("pretended name", self.named, ["known", "other"])
        return self

    def begin(self) -> Course:
        """One quantity per kind of value."""
        records: list[StepRecord] = []
        return Course(self._counted(records), lambda: self._findings(records), "the steps counted before are kept")

    def _counted(self, records: list[StepRecord]) -> Iterator[StepRecord]:
        for step in range(1, self.steps + 1):
            if step == self.fail_at:
                raise Unfinished("residual 1.0 after 25 iterations")
            time.sleep(self.pause)
            records.append(StepRecord(step, 4, 1e-11, {"displacement": step * 1e-4, "reaction_force": step * 0.01}))
            yield records[-1]

    def _findings(self, records: list[StepRecord]) -> Findings:
        if self.stubborn:
            time.sleep(60)
        result = pretended_result(Status.CONVERGED, "all steps accepted", tuple(records))
        return Findings(
            result.reason,
            result.steps,
            quantities=result.quantities,
            assumptions=result.assumptions,
            warnings=result.warnings,
            frames=result.frames,
            scene=result.scene,
            timing=result.timing,
        )

    @classmethod
    def example(cls) -> Pretence:
        """Two layers."""
        layers = (Layer(thickness=0.01, material=Soft(modulus=3e3)), Layer(thickness=0.002, material=Stiff(c10=1e4)))
        return cls(specimen=Specimen(layers=layers))


def pretended_result(status: Status, reason: str, records: tuple[StepRecord, ...]) -> Result:
    """A result with scalar and array quantities and one frame of six-node triangles per step."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0, 0], [0.5, 0.5, 0], [0, 0.5, 0]], dtype=float)
    frames = tuple(
        FieldFrame(
            time=float(record.step),
            points=points,
            cells={"triangle6": np.arange(6)[None]},
            point_data={"displacement [m]": np.full((6, 3), record.values["displacement"])},
            cell_data={"pressure [Pa]": np.array([17.2e3])},
        )
        for record in records
    )
    return Result(
        kind="pretence",
        status=status,
        reason=reason,
        quantities={
            "displacement": Quantity(len(records) * 1e-4, "m", "displacement of the annulus"),
            "threshold_pressure": Quantity(17.2e3, "Pa", "force over the annular area"),
            "taxel_force_upper": Quantity(np.arange(6.0).reshape(2, 3), "N", "force on each taxel"),
        },
        assumptions=("tissue is incompressible",),
        warnings=("coarse mesh",),
        timing={"solve": 0.5},
        steps=records,
        units={"displacement": "m", "reaction_force": "N"},
        frames=frames,
        scene=PretendedScene(profile=(1.0, 2.0)),
    )


PNG = b"\x89PNG pretended"

CASE_TEXT = """\
# a comment
schema: tactsim/case/1
title: A pretended case
experiment:
  kind: pretence
  specimen:
    radius: 20 mm
    layers:
      - thickness: 10 mm
        material: {kind: soft, modulus: 3 kPa}
      - thickness: 2 mm
        material:
          kind: stiff
          c10: 10 kPa
"""
