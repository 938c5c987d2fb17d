"""What the durometer and the ranking of elastomers report beside quantities and history."""

from __future__ import annotations

from typing import Literal

from tactsim.analytic.durometer import DurometerScale
from tactsim.experiments.durometer.elastomers import Elastomer, Shape
from tactsim.experiments.indentation.scene import PressedBodyScene
from tactsim.results.scene import Scene


class DurometerScene(PressedBodyScene):
    """The indentor of a durometer on a specimen."""

    kind: Literal["durometer"] = "durometer"
    scale: DurometerScale
    """Spring and travel."""
    youngs_modulus: float
    """Small-strain Young's modulus of the specimen in Pa."""


class ElastomerRankingScene(Scene):
    """What was ranked, and with which energies."""

    kind: Literal["elastomer_ranking"] = "elastomer_ranking"
    elastomers: tuple[Elastomer, ...]
    """In the order of the case."""
    shapes: tuple[Shape, ...]
    """Those that were finished."""
    threshold_displacement: tuple[float | None, ...]
    """For every shape, in m."""
