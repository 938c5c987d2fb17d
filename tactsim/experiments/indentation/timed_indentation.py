"""A rigid body pressed into tissue by a history of force or displacement; tissue may relax."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from pydantic import model_validator

from tactsim.contact.coulomb import Coulomb
from tactsim.experiments.indentation.history import history_units
from tactsim.experiments.indentation.pressing import PressingSetup
from tactsim.experiments.indentation.setup import Timed
from tactsim.interfaces import Experiment
from tactsim.materials.library import named_material
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mechanics.paths.loading import AnyLoading, DisplacementLoading
from tactsim.mechanics.paths.step_policy import StepPolicy, TimeSettings, shortest_relaxation_time
from tactsim.progress import Extent
from tactsim.units import Length, Positive, format_quantity

LOAD_STEPS = 20
"""Least number of steps of a ramp, and per period of a sine."""


class TimedIndentation(PressingSetup, Experiment):
    """A rigid body pressed into a cylindrical specimen by a prescribed history.

    >>> import tactsim as ts
    >>> specimen = ts.Specimen(material="icf_stable", thickness="6 mm", radius="12 mm")
    >>> press = ts.TimedIndentation(specimen=specimen, loading=ts.close("0.5 mm", "1 s", hold="4 s"))
    >>> press.extent  # of press.run(), which takes some seconds
    Extent(name='time', end=5.0)
    """

    kind: Literal["timed_indentation"] = "timed_indentation"
    loading: AnyLoading
    """The prescribed history."""
    stop: Literal["end", "touch"] = "end"
    """Whether the run goes on to the end of the history or stops when the tissue touches the inner sensor."""
    deepest: Positive[Length] | None = None
    """Displacement that the mesh must serve; by default the largest prescribed one, or a tenth of the body's radius."""
    time: TimeSettings = TimeSettings()
    """Steps of time."""
    compare: Literal["half_space", "layer"] | None = None
    """Closed form to compare with: the annulus or punch on a half-space, or on a layer as thick as the specimen."""

    history_units: ClassVar[dict[str, str]] = history_units(clock=True, space=False)

    @classmethod
    def example(cls) -> Self:
        """Atrial tissue under the annulus, its displacement held."""
        held = DisplacementLoading.model_validate(
            {"control": "displacement", "pieces": [{"kind": "jump", "to": 0.1e-3, "duration": 1.0}]}
        )
        specimen = Specimen(material=named_material("atrial").material, thickness=10e-3, radius=15e-3)
        return cls(specimen=specimen, contact=Coulomb(friction=0.0), loading=held)

    @property
    def extent(self) -> Extent:
        """The time of the history."""
        return Extent("time", self.loading.duration)

    @property
    def depth(self) -> float:
        """Displacement in m that the mesh must serve."""
        if self.deepest is not None:
            return self.deepest
        return self.prescribed or 0.1 * self.contact_radius

    @property
    def prescribed(self) -> float | None:
        """Largest displacement in m that is prescribed; None if a force is."""
        return self.loading.largest_displacement

    def drive(self) -> Timed:
        """The history, with steps of time."""
        materials, steps = self.specimen.materials, LOAD_STEPS
        return Timed(
            stops_at_touch=self.stop == "touch",
            reached="touched the inner sensor" if self.stop == "touch" else "end of the history",
            missed="the tissue did not touch the inner sensor within the history",
            loading=self.loading,
            policy=StepPolicy(self.time, shortest_relaxation_time(materials), per_ramp=steps, per_period=steps),
            compare=self.compare,
            compared_from=self.time.earliest or 0.0,
        )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        least, most = self.loading.least_and_most()
        if self.loading.control == "force" and least <= 0:
            raise ValueError(
                f"loading: the force falls to {format_quantity(least, 'N')}: it must press all the time, or the contact opens "
                "and no displacement answers it; preload more (at least 1.5 times the amplitude of a sine)"
            )
        if self.loading.control == "displacement" and most <= 0:
            raise ValueError("loading: the displacement never becomes positive: nothing is pressed; positive is into the tissue")
        if self.loading.control == "displacement" and most >= self.specimen.thickness:
            given, thickness = format_quantity(most, "m"), format_quantity(self.specimen.thickness, "m")
            raise ValueError(f"loading: displacement {given} must be smaller than the specimen's thickness {thickness}")
        if self.stop == "touch" and self.recess is None:
            raise ValueError("stop: the touch needs the recess of the inner sensor, like recess: 0.8 mm")
        if self.compare is not None:
            self._check_comparable()
        return self

    def _check_comparable(self) -> None:
        if not self.body.contact_shape.flat:
            raise ValueError(f"compare: a closed form exists for a flat ring or disc, not for a {self.body.kind}")
        if len(self.specimen.materials) > 1 or self.specimen.surface != "flat":
            raise ValueError("compare: a closed form exists for one material and a flat surface")
        if self.specimen.material.bulk_modulus is not None:
            raise ValueError("compare: the closed form is that of incompressible tissue; set bulk_modulus: null")
