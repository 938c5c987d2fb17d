"""What the three views of a grasp show: the signal of the taxels, where they lie, true inclusions, and estimates if there are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import TactsimError
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.interfaces import Inclusion
from tactsim.interfaces.both_jaws import TAXEL_DIFFERENCE, TAXEL_FORCE, has_taxels, jaws_at_end
from tactsim.interfaces.estimate import EstimatedInclusion
from tactsim.interfaces.readings import shown_change
from tactsim.interfaces.solid import Solid
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.results import Result

SAMPLES = 40
"""Points along each side of an inclusion's bounds from which its outline in a view is traced."""
APART = 1e-9
"""Distance in m in plan from which on jaws are not above each other."""
BARE_FORCES = (
    "The images of section 6.3 of the thesis, of the forces as read.",
    "Plain tissue shows the same bright bands: they are no lump.",
    "An inclusion shows in what exceeds a reference of plain tissue:",
    "tactsim new localization. Beyond the centres of the outer taxels",
    "the images are continued as they are there.",
)


@dataclass(frozen=True, eq=False)
class ViewedGrasp:
    """What is drawn.

    Attributes
    ----------
    scene : block, jaws and true inclusions
    signal : (jaw, row, column) in N
    meaning : what the signal is, in words
    valid : (jaw, row, column), False for interpolated taxels
    true : bodies of the true inclusions
    estimates : estimated inclusions
    findings : lines of text on the estimates
    """

    scene: GraspScene
    signal: Array
    meaning: str
    valid: Array
    true: tuple[Solid, ...]
    estimates: tuple[EstimatedInclusion, ...] = ()
    findings: tuple[str, ...] = BARE_FORCES

    @property
    def taxels_in_words(self) -> str:
        """Which taxels are drawn: of jaws that are not above each other those in the middle."""
        places = np.array([self.scene.place(side)[:2] for side in JAWS])
        return "taxels, midway between the jaws;" if np.ptp(places, axis=0).max() > APART else "taxels,"


def viewed(result: Result) -> ViewedGrasp:
    """The grasp that a result describes; with a reference, what the taxels read beyond it."""
    scene = result.scene_as(GraspScene)
    if has_taxels(result, TAXEL_DIFFERENCE):
        signal, meaning = shown_change(jaws_at_end(result, TAXEL_DIFFERENCE))
    else:
        signal, meaning = jaws_at_end(result, TAXEL_FORCE), "force"
    return ViewedGrasp(scene, signal, meaning, np.ones(signal.shape, bool), tuple(true_bodies(scene)))


def true_bodies(scene: GraspScene) -> Iterator[Solid]:
    """Bodies of the inclusions that are not tissue themselves; one whose surface file is not at hand is left out."""
    for shape in scene.true_inclusions:
        try:
            yield shape.solids(scene.size)[0]
        except (TactsimError, OSError):
            continue


def estimated_bodies(grasp: ViewedGrasp, unknown: float | None = None) -> Iterator[Solid]:
    """Balls and tubes as estimated; one of unknown radius is a ball of the radius ``unknown`` in m, or left out."""
    for estimate in grasp.estimates:
        size = unknown if estimate.radius is None else estimate.radius
        if size is None:
            continue
        body: Inclusion = Sphere(center=estimate.center, radius=size)
        if estimate.line is not None:
            body = Tube(centre_line=estimate.line, inner_radius=size / 2, wall=size / 2)
        yield body.solids(grasp.scene.size)[0]


def outline(body: Solid, size: Array, away: int) -> tuple[Array, Array, Array]:
    """Outline of a body in the block, seen along the axis ``away``: where the last of three arrays is zero.

    Coordinates in mm along the other two axes, and least distance (second, first) in m from the body, negative where it lies.
    """
    low, high = np.clip(body.bounds(), 0.0, size)
    step = (high - low) / SAMPLES
    grid = [low[k] + step[k] * np.arange(-1.5, SAMPLES + 1.5) for k in range(3)]
    points = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1)
    beyond_block = (np.abs(points - size / 2) - size / 2).max(axis=-1)
    distance = np.maximum(body.signed_distance(points.reshape(-1, 3)).reshape(points.shape[:3]), beyond_block)
    first, second = (k for k in range(3) if k != away)
    return 1e3 * grid[first], 1e3 * grid[second], distance.min(axis=away).T
