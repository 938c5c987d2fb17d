"""What the three views of a result show: the signal of the taxels, where they lie, the true and the estimated inclusions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from tactsim.errors import TactsimError
from tactsim.experiments.grasp.figures.parts import SIDES
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import Solid
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.localization.views import AWAY
from tactsim.mesh.any_inclusion import AnyInclusion, shapes_unlike_tissue
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.results import Result

Array = np.ndarray
SAMPLES = 40
"""Points along each side of an inclusion's bounds from which its outline in a view is traced."""
NO_LINE = [[np.nan] * 3] * 2
NEEDED = ("block_size", "matrix")


@dataclass(frozen=True, eq=False)
class ViewedGrasp:
    """What is drawn.

    Attributes
    ----------
    signal : (jaw, row, column) in N
    meaning : what the signal is, in words
    valid : (jaw, row, column), False for interpolated taxels
    layout : of the taxels on each jaw
    size : (3,) of the undeformed block in m
    middle : (2,) of both matrices in m
    true : bodies of the true inclusions
    estimates : (n, 3) of estimated centres in m
    radii : (n,) of estimated radii in m, NaN where there is none
    lines : (n, 2, 3) of both ends of the centre lines of estimated tubes in m, NaN of what is no tube
    regions : by the axis of the view, closed lines (m, 2) in mm around where the estimated centres lie with a probability of 90 %
    """

    signal: Array
    meaning: str
    valid: Array
    layout: TaxelLayout
    size: Array
    middle: Array
    true: tuple[Solid, ...]
    estimates: Array
    radii: Array
    lines: Array
    regions: dict[int, list[Array]]

    def borders(self, along: str) -> Array:
        """Lower and upper border (n, 2) in mm of every column ("x") or row ("y") of taxels."""
        return 1e3 * (self.layout.borders(along) + self.middle["xy".index(along)])


def has_views(result: Result) -> bool:
    """Whether a result has taxels with their places."""
    return all(name in result.details for name in NEEDED) and "taxel_force_upper" in result.quantities


def viewed(result: Result) -> ViewedGrasp:
    """The grasp or localization that a result describes; with a reference, what the taxels read beyond it."""
    details = result.details
    name = "taxel_difference" if "taxel_difference_upper" in result.quantities else "taxel_force"
    signal = np.array([result.quantities[f"{name}_{side}"].value for side in SIDES], dtype=float)
    meaning = "force"
    if name == "taxel_difference":
        sums = signal.sum(axis=0)
        softer = bool(-sums.min() > sums.max())
        signal = -signal if softer else signal
        meaning = f"force {'below' if softer else 'above'} that of the reference"
    size = np.asarray(details["block_size"], dtype=float)
    valid = details.get("valid")
    estimates = details.get("estimates") or []
    return ViewedGrasp(
        signal,
        meaning,
        np.ones(signal.shape, bool) if valid is None else np.asarray(valid, dtype=bool),
        TaxelLayout.model_validate(details["matrix"]),
        size,
        _middle(details, size),
        tuple(_bodies(details, size)),
        np.array([found["center"] for found in estimates], dtype=float).reshape(-1, 3),
        np.array([np.nan if found["radius"] is None else found["radius"] for found in estimates], dtype=float),
        np.array([found.get("line") or NO_LINE for found in estimates], dtype=float).reshape(-1, 2, 3),
        {away: [1e3 * np.array(line) for line in lines] for away, lines in _regions(estimates).items()},
    )


def _regions(estimates: list[dict[str, Any]]) -> dict[int, list[Any]]:
    """Outlines in m of all regions, by the axis of the view."""
    told = [found.get("region") or {} for found in estimates]
    return {away: [line for region in told for line in region.get(view, ())] for view, away in AWAY.items()}


def _middle(details: dict[str, Any], size: Array) -> Array:
    told = details.get("jaw_places")
    return size[:2] / 2 if told is None else np.mean([np.asarray(told[side], dtype=float)[:2] for side in SIDES], axis=0)


def _bodies(details: dict[str, Any], size: Array) -> Iterator[Solid]:
    """Bodies of the inclusions that are not tissue themselves; one whose surface file is not at hand is left out."""
    adapter = TypeAdapter(AnyInclusion)
    for shape in shapes_unlike_tissue(details):
        try:
            yield adapter.validate_python(shape).solids(size)[0]
        except (TactsimError, OSError):
            continue


def estimated_bodies(grasp: ViewedGrasp, unknown: float | None = None) -> Iterator[Solid]:
    """Balls and tubes as estimated; one of unknown radius is a ball of the radius ``unknown`` in m, or left out."""
    for center, radius, line in zip(grasp.estimates, grasp.radii, grasp.lines, strict=True):
        size = float(radius) if np.isfinite(radius) else unknown
        if size is None:
            continue
        x, y, z = map(float, center)
        body: Inclusion = Sphere(center=(x, y, z), radius=size)
        if np.isfinite(line).all():
            first, last = (tuple(map(float, end)) for end in line)
            body = Tube(centre_line=(first, last), inner_radius=size / 2, wall=size / 2)
        yield body.solids(grasp.size)[0]


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
