"""The cut of tissue in 3D under a rigid body: along x, or along y if it leans that way."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from tactsim.array import Array
from tactsim.experiments.indentation.figures.contact_section import SHOWN_RADII, PressedSection, moment_in_words, top_of_words
from tactsim.experiments.indentation.figures.section import Section
from tactsim.experiments.indentation.scene import Indentation3dScene
from tactsim.mesh.quadratic import MIRROR
from tactsim.plotting.plane_cut import FACES
from tactsim.results import FieldFrame, Result
from tactsim.results.fields import DISPLACEMENT, REGION

_ASCENDING = np.where(FACES[:, [1]] < FACES[:, [2]], FACES, FACES[:, MIRROR[2]])
"""Nodes (4, 6) of the faces of a tetrahedron, those of its corners ascending."""


ROUND_OFF = 1e-12
"""Distance in m from the plane of a cut of a node that lies on it."""


def cut(frame: FieldFrame, along: int = 0) -> FieldFrame:
    """The faces of elements that lay in the plane y = 0, or x = 0 if it goes ``along`` y (1), as six-node triangles of (x, z, 0)
    or (y, z, 0).
    """
    flat = np.abs(frame.points[:, 1 - along]) < ROUND_OFF
    faces = frame.cells["tetra10"][:, _ASCENDING].reshape(-1, 6)
    owner = np.repeat(np.arange(len(frame.cells["tetra10"])), len(_ASCENDING))
    inside = flat[faces].all(axis=1)
    _, first = np.unique(np.sort(faces[inside][:, :3], axis=1), axis=0, return_index=True)
    faces, owner = faces[inside][first], owner[inside][first]
    used, numbers = np.unique(faces, return_inverse=True)
    fields = {name: np.asarray(values)[used] for name, values in frame.point_data.items()}
    fields[DISPLACEMENT] = _in_plane(fields[DISPLACEMENT], along)
    regions = {REGION: np.asarray(frame.cell_data[REGION]).ravel()[owner]} if frame.cell_data else {}
    return FieldFrame(frame.time, _in_plane(frame.points[used], along), {"triangle6": numbers.reshape(-1, 6)}, fields, regions)


def draw_cut(axis: Axes, result: Result) -> None:
    """The deformed cut of the last frame with its pressure, the body and the sensor's plane in the hole."""
    frame, scene = result.frames[-1], result.scene_as(Indentation3dScene)
    turn = scene.body.rotation
    leans_along_y = scene.symmetry == "whole" and abs(turn[1, 2]) > abs(turn[0, 2])
    along = int(leans_along_y and scene.offset == 0.0)  # off the axis no faces of elements fill the plane x = 0
    section, height = Section(cut(frame, along)), 1e3 * (scene.starting_height - frame.time)
    sides = (-1.0, 1.0) if scene.symmetry == "quarter" else (1.0,)
    limits = _window(section, 1e3 * scene.body.contact_shape.reach, height, mirrored=len(sides) > 1)
    limits = limits[0], (limits[1][0], max(limits[1][1], top_of_words(scene, height, limits[0][1])))
    shown = PressedSection(section, scene, height, limits, sides=sides, meshed=sides, turn=turn, along=along)
    words = f"cut {'yx'[along]} = 0 {moment_in_words(result, frame.time)}"
    shown.draw(axis, f"{'xy'[along]} from the axis of the body in mm", words, at_rest=result.at_rest)


def _in_plane(points: Array, along: int) -> Array:
    return np.stack([points[:, along], points[:, 2], np.zeros(len(points))], axis=1)


def _window(section: Section, radius: float, height: float, *, mirrored: bool) -> tuple[tuple[float, float], tuple[float, float]]:
    """Limits in mm of the picture along the cut and along z, under a body of a radius and at a height in mm."""
    x, z = section.places.T
    right = min(1.03 * float(x.max()), SHOWN_RADII * radius)
    left = -right if mirrored else max(1.03 * float(x.min()), -SHOWN_RADII * radius)
    deepest = max(float(z.min()), -SHOWN_RADII * radius)
    top = max(float(z[(x >= left) & (x <= right)].max()), height) + 0.4 * min(right, radius)
    margin = 0.03 * (top - deepest)
    return (left, right), (deepest - margin, top + margin)
