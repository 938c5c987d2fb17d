"""Whether a grasp is its own mirror image, and how far the forces of its taxels are from theirs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tactsim.array import Array
from tactsim.contact.mirrored import SAME_PLACE, SAMPLES
from tactsim.experiments.grasp.readings import JawReading
from tactsim.experiments.grasp.setup import Embedded, GraspSetup
from tactsim.materials.mirrored import law_mirrors


def mirror_axes(grasp: GraspSetup) -> tuple[int, ...]:
    """Axes, 0 for x and 1 for y, whose middle planes mirror block, materials, inclusions, jaws and taxels onto themselves."""
    conditions = (_jaws_mirror, _inclusions_mirror, _laws_mirror)
    return tuple(axis for axis in (0, 1) if all(mirror(grasp, axis) for mirror in conditions))


def mirror_asymmetry(readings: Mapping[str, JawReading], axes: tuple[int, ...]) -> float:
    """Largest difference of a taxel's force from that on its mirror image, over the largest force, for ``axes`` of symmetry."""
    forces = np.array([reading.taxels.taxels[2] for reading in readings.values()])
    largest = float(np.abs(forces).max())
    if not largest > 0:
        return 0.0
    return max(float(np.abs(forces - np.flip(forces, axis=2 - axis)).max()) for axis in axes) / largest


def _jaws_mirror(grasp: GraspSetup, axis: int) -> bool:
    """Whether both jaws stand in the middle and lean only along the plane: a rotation about x lowers a jaw along y."""
    tilt = ("tilt_y", "tilt_x")[axis]
    return all(jaw.offset[axis] == 0 and getattr(jaw, tilt) == 0 for jaw in (grasp.upper, grasp.lower))


def _laws_mirror(grasp: GraspSetup, axis: int) -> bool:
    """Whether tissue and inclusions have no preferred direction oblique to the plane."""
    return all(law_mirrors(material, axis) for material in grasp.materials)


def _inclusions_mirror(grasp: GraspSetup, axis: int) -> bool:
    """Whether every inclusion unlike the tissue has one of the same material and pressure at its mirrored place."""
    size = np.array(grasp.block.size)
    points = np.random.default_rng(0).uniform(0.0, 1.0, (SAMPLES, 3)) * size
    mirrored = points.copy()
    mirrored[:, axis] = size[axis] - points[:, axis]
    here = [(embedded, _distances(embedded, size, points)) for embedded in grasp.unlike_tissue]
    there = [_distances(embedded, size, mirrored) for embedded in grasp.unlike_tissue]
    return all(
        any(_alike(one, other) and _near(distances, image, size) for (other, _), image in zip(here, there, strict=True))
        for one, distances in here
    )


def _alike(one: Embedded, other: Embedded) -> bool:
    return one.material == other.material and one.lumen == other.lumen


def _near(first: Array, second: Array, size: Array) -> bool:
    return first.shape == second.shape and bool(np.abs(first - second).max() <= SAME_PLACE * size.max())


def _distances(embedded: Embedded, size: Array, points: Array) -> Array:
    """Distances in m of points from every surface of an inclusion (surfaces, n)."""
    return np.array([solid.signed_distance(points) for solid in embedded.shape.solids(size)])
