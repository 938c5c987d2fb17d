"""Motions of the whole body that nothing prescribed holds: without resistance, so that their size would be arbitrary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.experiments.boundary_value.motions import Held
from tactsim.experiments.boundary_value.parts import Parts

HOLDS = 1e-9
"""Least resistance to a motion, over the largest, that is no round-off."""


def free_motions(parts: Parts, held: Sequence[Held]) -> list[str]:
    """Small motions as a rigid body that leave every prescribed displacement zero, in words; none if the body is held."""
    names, modes = _rigid_motions(parts)
    fixed = [one.motion.unknowns for one in held]
    unknowns = np.unique(np.concatenate(fixed)).astype(np.int64) if fixed else np.zeros(0, np.int64)
    sliding = [one.motion.slides(1.0) for one in held]  # at the end of its turn
    turned = [one.normals[0, :, None] * modes[one.first] + one.normals[1, :, None] * modes[one.first + 1] for one in sliding]
    rows = np.vstack([modes[unknowns], *turned, np.zeros((len(names), len(names)))])  # at least as many rows as motions
    _, resistance, motions = np.linalg.svd(rows, full_matrices=False)
    free = motions[resistance <= HOLDS * max(1.0, resistance[0])]
    straight = [name for name in names if name.startswith("moving")]
    # A turn about any axis along a coordinate counts, so that only the parts of turning are compared.
    _, sizes, turns = np.linalg.svd(free[:, len(straight) :], full_matrices=False)
    share = np.linalg.norm(free[:, : len(straight)], axis=0), np.linalg.norm(turns[sizes > HOLDS], axis=0)
    named = [name for name, part in zip(names, np.concatenate(share), strict=True) if part > 1 - HOLDS]
    return named if len(named) == len(free) else [*named, "turning about an axis through what is held"]


def in_words(motions: Sequence[str]) -> str:
    """Motions one after the other, the last after ``and``."""
    return " and ".join([", ".join(motions[:-1]), motions[-1]] if len(motions) > 1 else motions)


def _rigid_motions(parts: Parts) -> tuple[list[str], Array]:
    """The motions of a body of this dimension and their displacements (unknowns, motions), turns over half the body's size."""
    nodes, count = parts.domain.mesh.nodes, len(parts.axes)
    if parts.axes[0] == "r":
        return ["moving along z"], np.tile([0.0, 1.0], len(nodes))[:, None]
    moved = [np.tile(direction, (len(nodes), 1)) for direction in np.eye(count)]
    arms = np.zeros((len(nodes), 3))
    arms[:, :count] = (nodes - (nodes.min(axis=0) + nodes.max(axis=0)) / 2) / (parts.size / 2)
    axes = np.eye(3) if count == 3 else np.eye(3)[2:]
    turned = [np.cross(axis, arms)[:, :count] for axis in axes]
    names = [f"moving along {name}" for name in parts.axes] + [f"turning about {name}" for name in "xyz"[-len(axes) :]]
    return names, np.stack([motion.ravel() for motion in (*moved, *turned)], axis=1)
