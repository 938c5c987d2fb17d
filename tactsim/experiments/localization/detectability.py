"""The smallest lump that matrices of several resolutions can find, over its depth: what a designer of sensors opens first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.analytic.eshelby_ball import eshelby_contrast
from tactsim.array import Array
from tactsim.experiments.grasp.setup import Block, GraspSetup
from tactsim.experiments.localization.detectability_statistics import false_alarm_threshold, smallest_radius, unit_templates
from tactsim.experiments.localization.response_store import kept_response
from tactsim.experiments.localization.scene import DetectabilityScene
from tactsim.interfaces import Experiment
from tactsim.interfaces.readings import ROUNDING_NOISE
from tactsim.interfaces.run import Course, Findings
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.localization.lump_response import LumpResponse, Tabulation
from tactsim.materials.library import named_material
from tactsim.mechanics.paths.loading import close
from tactsim.mesh.block import part_of_usual
from tactsim.progress import elapsed_time
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord
from tactsim.units import Force, Length, NonNegative, Positive, format_quantity

COARSE = Tabulation(np.array([1.5e-3, 2.5e-3, 3.5e-3, 5e-3, 6.5e-3, 8e-3]), spacing=2e-3, most_centres=12_500)
"""Balls that the filter tries."""
AWAY = (0.0, 0.25, 0.5)
"""Places in plan, each way from the middle, in pitches of the coarsest matrix."""
ROOM = 0.5e-3
"""Least distance of a ball from the faces of the block in m; all these lengths are less in a small block."""
FEWEST_ALARMS = 10
"""Draws above the threshold by which it is set: the rate of false alarms is then known within a third."""
NOISES = ("same", "by_area")


@dataclass
class _Outcome:
    """What the matrices computed so far find."""

    steps: list[StepRecord] = field(default_factory=list)
    radii: list[dict[str, list[list[float | None]]]] = field(default_factory=list)
    """Smallest radii in m of each matrix by the name of the noise, [shear ratio][depth]."""


class Detectability(Experiment):
    r"""Smallest radius found with a stated probability at a stated rate of false alarms, by a matched filter.

    The filter knows the response of the tissue, the plain tissue's readings at the same closing (read with the same noise) and
    the noise, but neither place nor radius: it takes the largest match over all of them. All matrices cover the same square.
    Each is judged with the same noise on every reading, and with a noise that is in proportion to the taxel's area, as of a
    sensor whose resolution is one of pressure. To first order in the contrast; that of a small ball is
    ``eshelby_contrast``. A large rigid ball acts up to three times more, so its radius comes out too large.
    """

    kind: Literal["detectability"] = "detectability"
    grasp: GraspSetup
    """Plain tissue between two jaws; its own matrix is not used."""
    matrices: Annotated[tuple[Annotated[int, Field(ge=2, le=32)], ...], Field(min_length=1, max_length=8)] = (3, 8, 16)
    """Taxels along each side of the matrices on both jaws. For each a grasp is solved and the lump moved to every depth: all
    three take some minutes, one of them less than one."""
    side: Positive[Length] = 30e-3
    """Side of the square that every matrix covers: its pitch is this over the number of taxels."""
    share: Annotated[float, Field(gt=0, le=1)] = 0.9
    """Size of a taxel over its pitch."""
    depths: Annotated[tuple[Length, ...], Field(min_length=1)] = (3e-3, 5e-3, 7e-3, 9e-3, 11e-3, 13e-3, 15e-3, 17e-3)
    """Of the centre of the lump below the upper face of the undeformed tissue."""
    shear_ratios: Annotated[tuple[NonNegative[float], ...], Field(min_length=1)] = (1.8, 100.0)
    """Shear modulus of the lump over that of the tissue; 1.8 is the thesis's lump in ICF (erratum E15), 100 a hard ball."""
    noise: Positive[Force] = ROUNDING_NOISE
    """Standard deviation of a reading of the first matrix; the default is what rounding to 0.1 N (thesis 6.2) does."""
    probability: Annotated[float, Field(gt=0, lt=1)] = 0.9
    """With which the smallest lump is found."""
    false_alarms: Annotated[float, Field(gt=0, lt=1)] = 0.05
    """Probability that plain tissue is taken for a lump."""
    draws: Annotated[int, Field(ge=100, le=1_000_000)] = 2000
    """Of errors, by which the threshold is set: at least 10 over ``false_alarms``."""
    seed: NonNegative[int] = 1
    """Of these draws."""

    history_units: ClassVar[dict[str, str]] = {"taxels": "1", "threshold": "1"}

    @classmethod
    def example(cls) -> Self:
        """A block of ICF closed by 1 mm per jaw."""
        block = Block(tissue=named_material("icf_stable").material)
        return cls(grasp=GraspSetup(block=block, loading=close(to=1e-3, duration=1.0)))

    def begin(self) -> Course:
        """One step per matrix."""
        outcome = _Outcome()
        return Course(self._matrices(outcome), lambda: self._findings(outcome))

    def _matrices(self, outcome: _Outcome) -> Iterator[StepRecord]:
        for number, count in enumerate(self.matrices, 1):
            response = self._response(count)
            with elapsed_time(f"{count} x {count} taxels"):
                self._judge(number, count, response, outcome)
            yield outcome.steps[-1]

    def _judge(self, number: int, count: int, response: LumpResponse, outcome: _Outcome) -> None:
        """Add the smallest radii that a matrix with ``count`` taxels along each side finds."""
        templates = unit_templates(response, every=2)
        threshold = false_alarm_threshold(templates, self.false_alarms, draws=self.draws, seed=self.seed)
        contrasts = [float(eshelby_contrast(np.array(ratio))) for ratio in self.shear_ratios]
        deviations = {name: np.sqrt(2) * self._noise(name, count) for name in NOISES}
        depths = [(self._densities(response, below), self._most(below)) for below in self.depths]

        def over_depth(contrast: float, sigma: float) -> list[float | None]:
            sought = {"contrast": contrast, "sigma": sigma, "threshold": threshold, "wanted": self.probability}
            return [smallest_radius(densities, response.radii, most, **sought) for densities, most in depths]

        outcome.radii.append(
            {name: [over_depth(contrast, sigma) for contrast in contrasts] for name, sigma in deviations.items()}
        )
        outcome.steps.append(StepRecord(number, 0, 0.0, {"taxels": count, "threshold": threshold}))

    def _findings(self, outcome: _Outcome) -> Findings:
        return Findings(
            f"{len(self.matrices)} matrices",
            outcome.steps,
            quantities=self._quantities(outcome) if len(outcome.steps) == len(self.matrices) else {},
            assumptions=self._assumptions(),
            scene=DetectabilityScene(
                probability=self.probability, false_alarms=self.false_alarms, noise=self.noise, side=self.side
            ),
        )

    def layout(self, count: int) -> TaxelLayout:
        """The matrix with this many taxels along each side."""
        pitch = self.side / count
        return TaxelLayout(rows=count, columns=count, pitch=pitch, size=self.share * pitch)

    def _noise(self, name: str, count: int) -> float:
        """Standard deviation of a reading in N."""
        return self.noise * (1.0 if name == "same" else (self.matrices[0] / count) ** 2)

    def _response(self, count: int) -> LumpResponse:
        from tactsim.experiments.localization.lump_sensitivity import lump_response  # loads the solver

        setup = self.grasp.model_copy(update={"matrix": self.layout(count)})
        return kept_response(setup, lambda: lump_response(setup, COARSE), how="detectability")

    def _densities(self, response: LumpResponse, below: float) -> Array:
        """Lengths (places, R) in N/m^3 of the responses of the tabulated balls at a depth in m, over the volumes of the balls."""
        width, depth, height = self.grasp.block.size
        away = np.array(AWAY) * self.side / min(self.matrices)
        z = float(np.clip(height - below, *response.axes[2][[0, -1]]))
        centers = np.array([(width / 2 + dx, depth / 2 + dy, z) for dx in away for dy in away])
        signals = np.stack([response.signal(centers, np.full(len(centers), radius)) for radius in response.radii], axis=1)
        return np.linalg.norm(signals.reshape(*signals.shape[:2], -1), axis=2) / (4 / 3 * np.pi * response.radii**3)

    def _most(self, below: float) -> float:
        """Largest radius in m that fits at a depth in m."""
        size = self.grasp.block.size
        return min(below, size[2] - below) - part_of_usual(size) * ROOM

    def _quantities(self, outcome: _Outcome) -> dict[str, Quantity]:
        thresholds = [step.values["threshold"] for step in outcome.steps]
        radii = {name: [list(rows) for rows in zip(*(matrix[name] for matrix in outcome.radii), strict=True)] for name in NOISES}
        order = "[shear ratio][matrix][depth]; null where none that fits is found"
        words = {"same": "the same noise on every reading", "by_area": "noise in proportion to the area of a taxel"}
        return {
            "depths": Quantity(list(self.depths), "m", "of the centre below the upper face of the undeformed tissue [depth]"),
            "matrices": Quantity(list(self.matrices), "1", "taxels along each side [matrix]"),
            "shear_ratios": Quantity(
                list(self.shear_ratios), "1", "shear modulus of the lump over that of the tissue [shear ratio]"
            ),
            "smallest_radius": Quantity(radii["same"], "m", f"smallest radius found, {words['same']}; {order}"),
            "smallest_radius_by_area": Quantity(radii["by_area"], "m", f"smallest radius found, {words['by_area']}; {order}"),
            "thresholds": Quantity(
                thresholds, "1", "largest match of the filter that counts as noise, in standard deviations [matrix]"
            ),
        }

    def _assumptions(self) -> tuple[str, ...]:
        noise, side = format_quantity(self.noise, "N"), format_quantity(self.side, "m")
        return (
            f"noise of a reading {noise} (one standard deviation), the same on the reference, Gaussian and independent",
            f"every matrix covers a square with a side of {side}, its taxels {self.share:g} of their pitch",
            "contrast to first order, that of a small ball (Eshelby); a large hard ball acts more",
            f"probability averaged over {len(AWAY) ** 2} places near the middle of the matrices, mesh of the forward model fixed",
        )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.grasp.inclusions:
            raise ValueError("grasp.inclusions: the tissue must be plain; leave them out")
        height = self.grasp.block.size[2]
        for depth in self.depths:
            if not 0 < depth < height:
                given, most = (format_quantity(value, "m") for value in (depth, height))
                raise ValueError(f"depths: {given} is outside the block; allowed: between 0 and {most}")
        for ratio in self.shear_ratios:
            if ratio == 1:
                raise ValueError("shear_ratios: 1 is plain tissue, which nothing can find; allowed: 0 or more, but not 1")
        if self.draws * self.false_alarms < FEWEST_ALARMS * (1 - 1e-9):
            needed = int(np.ceil(FEWEST_ALARMS / self.false_alarms * (1 - 1e-9)))
            raise ValueError(
                f"draws: of {self.draws}, too few give a false alarm at a rate of {self.false_alarms:g} for a threshold; "
                f"allowed: at least {needed}, or a higher rate"
            )
        widest = min(self.grasp.jaw("upper").width, self.grasp.jaw("upper").depth, *self.grasp.block.size[:2])
        if self.side > widest * (1 + 1e-12):
            given, most = (format_quantity(value, "m") for value in (self.side, widest))
            raise ValueError(f"side: {given} is wider than the block or the jaws; allowed: at most {most}")
        return self
