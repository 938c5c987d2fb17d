"""What a localization reports beside its quantities: the grasp that was read, the estimated inclusions, the trusted taxels."""

from __future__ import annotations

from typing import Literal

import numpy as np

from tactsim.array import Array
from tactsim.experiments.grasp.scene import GraspScene, Point
from tactsim.interfaces.estimate import EstimatedInclusion
from tactsim.localization.region import OutlinedRegion, shadows
from tactsim.model import FrozenModel
from tactsim.results.scene import Scene

Line = list[tuple[float, float]]


class EstimatedShape(FrozenModel):
    """An inclusion as an estimator gives it."""

    kind: str
    """"sphere", "tube", or "unknown" if the estimator does not say."""
    center: Point
    """In m in the undeformed block."""
    radius: float | None = None
    """In m; null if not estimated."""
    line: tuple[Point, Point] | None = None
    """Both ends of the centre line of a tube in m; null if it is no tube."""
    region: dict[str, list[Line]] | None = None
    """By view, closed lines in m around where the centre lies with a probability of 90 %; null if not estimated."""

    @classmethod
    def of(cls, inclusion: EstimatedInclusion) -> EstimatedShape:
        """The shape of an estimated inclusion."""
        region = None if inclusion.region is None else shadows(inclusion.region)
        known = {name: getattr(inclusion, name) for name in ("kind", "center", "radius", "line")}
        return cls.model_validate(known | {"region": region})

    def inclusion(self, contrast: float | None = None, covariance: Array | None = None) -> EstimatedInclusion:
        """The estimated inclusion, with the contrast and the covariance that are given: the quantities of a result hold them.

        ``covariance`` has the shape that `EstimatedInclusion` says.
        """
        kept = self.region
        region = None if kept is None else OutlinedRegion({view: [np.array(line) for line in kept[view]] for view in kept})
        return EstimatedInclusion(self.kind, self.center, self.radius, contrast, covariance, region, self.line)


class LocalizedGrasp(GraspScene):
    """A grasp with what an estimator located in it."""

    kind: Literal["localization"] = "localization"
    estimates: tuple[EstimatedShape, ...]
    """The strongest first."""
    estimator: str
    """Kind of the estimator."""
    noise: float
    """Standard deviation of a reading in N."""
    valid: tuple[tuple[tuple[bool, ...], ...], ...] | None = None
    """Which taxels [jaw][row][column] can be trusted, the others are interpolated; null if all can."""
    words: tuple[str, ...] = ()
    """The estimates in words."""
    reference_unused: bool = False
    """Whether the estimator read the forces as they are, although there is a reference, which the figures take off."""


class JudgedGrasp(FrozenModel):
    """One of the grasps whose class was estimated."""

    grasp: str
    """Name of the folder of its result."""
    true: str
    """Its true class."""
    classes: tuple[dict[str, float] | None, ...]
    """For every draw of the noise the probability of each class; null if the estimator gives none."""


class ConfusionScene(Scene):
    """What a confusion table was counted from."""

    kind: Literal["confusion"] = "confusion"
    classes: tuple[str, ...]
    """Names of the classes, in the order of the table."""
    grasps: tuple[JudgedGrasp, ...]
    """In the order of the case."""
    estimator: str
    """Kind of the estimator."""


class DetectabilityScene(Scene):
    """Under which conditions the smallest lump was sought."""

    kind: Literal["detectability"] = "detectability"
    probability: float
    """With which a lump is found, 0 to 1."""
    false_alarms: float
    """Share of alarms without a lump."""
    noise: float
    """Standard deviation of a reading in N."""
    side: float
    """Side of the matrices in m."""


class BandsScene(Scene):
    """Arrays of sensors that were drawn as bands."""

    kind: Literal["tactile_bands"] = "tactile_bands"
    arrays: tuple[str, ...]
    """``upper``, and ``lower`` if there are two."""
    normalising: float
    """Force in N of the brightest level."""
