"""A rigid body pressed into tissue; for the annulus, up to the threshold where the tissue touches the inner sensor."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.experiments.indentation.displaced import DisplacedSetup
from tactsim.experiments.indentation.history import history_units
from tactsim.interfaces import Experiment
from tactsim.mechanics.models.specimen import Specimen


class Indentation(DisplacedSetup, Experiment):
    """A rigid body pressed into a cylindrical specimen along its axis.

    >>> import tactsim as ts
    >>> specimen = ts.Specimen(material="icf_stable", thickness="6 mm", radius="12 mm")
    >>> press = ts.Indentation(specimen=specimen, recess="0.4 mm", displacement="2 mm")
    >>> press.extent  # what ends press.run(), which takes some seconds: the touch of the inner sensor
    Extent(name='tissue_rise', end=0.0004)
    """

    kind: Literal["indentation"] = "indentation"

    history_units: ClassVar[dict[str, str]] = history_units(clock=False, space=False)

    @classmethod
    def example(cls) -> Self:
        """A thin specimen under the sensor of chapter 3."""
        return cls(specimen=Specimen(material="icf_stable", thickness=4e-3, radius=8e-3), recess=0.8e-3, displacement=2e-3)
