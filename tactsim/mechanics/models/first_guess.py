"""What Newton starts from in a block that is still undeformed: tissue without lumps, but for lumps that resist it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.analytic.eshelby_ball import displacement_by_ball
from tactsim.array import Array
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mesh.quadratic import QuadraticMesh

FIRST_PART = 0.6
"""Part of a closing by which the first guess compresses the block: of the parts from 0.5 to 1, Newton takes the fewest
iterations from this one."""
LEAST_STRETCH = 0.5
"""Of the guess."""
COMPACT = 1.5
"""Distance of a lump's farthest node from its middle over the radius of a ball of its volume, below which it is taken for one."""


@dataclass(frozen=True)
class FirstGuess:
    """Where Newton begins: at ``unknowns`` (size,), in the step from a ``state`` whose contacts expect forces."""

    state: ContactEquilibrium
    unknowns: Array


def compressed(mesh: QuadraticMesh, shear_moduli: Array, closing: float) -> Array:
    """Displacements (n, 3) in m of a block under uniform compression at constant volume, each face closed by ``closing`` in m,
    but for lumps, by the ``shear_moduli`` (E,) of the elements in Pa.

    Newton starts there: from the undeformed block, its first step would turn thin cells at the free edges inside out.
    """
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    stretch = max(1 - 2 * closing / (high - low)[2], LEAST_STRETCH)
    growth = np.array([stretch**-0.5, stretch**-0.5, stretch]) - 1
    return with_lumps(mesh, shear_moduli, (mesh.nodes - (low + high) / 2) * growth)


def with_lumps(mesh: QuadraticMesh, shear_moduli: Array, displacement: Array) -> Array:
    """Displacements (n, 3) in m of tissue with lumps, given those (n, 3) of tissue alone.

    Compact lumps are strained as balls in a large body are, by the ``shear_moduli`` (E,) of the elements in Pa.

    Why: a lump of 130 times the tissue's stiffness that is compressed with it is under a stress that makes it turn over, like a
    column beyond Euler's load: Newton's first step turned it by 0.3 rad, and four systems more were solved to turn it back.
    """
    added = np.zeros_like(mesh.nodes)
    for region in np.unique(mesh.regions)[1:]:
        added += _by_lump(mesh, mesh.regions == region, shear_moduli, displacement)
    return displacement + added


def _by_lump(mesh: QuadraticMesh, inside: Array, shear_moduli: Array, displacement: Array) -> Array:
    """Displacement (n, 3) in m that a region adds, given its elements (E,): a ball of its volume's in the mean strain that the
    tissue has there, none if it is not compact."""
    corners = mesh.nodes[mesh.elements[inside, :4]]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    center = (volumes[:, None] * corners.mean(axis=1)).sum(axis=0) / volumes.sum()
    radius = float(np.cbrt(volumes.sum() / (4 / 3 * np.pi)))
    nodes, places = np.unique(mesh.elements[inside]), mesh.nodes - center
    if np.linalg.norm(places[nodes], axis=1).max() > COMPACT * radius:
        return np.zeros_like(mesh.nodes)
    gradient = np.linalg.lstsq(np.column_stack([places[nodes], np.ones(len(nodes))]), displacement[nodes], rcond=None)[0][:3]
    strain = (gradient + gradient.T) / 2
    strain -= np.trace(strain) / 3 * np.eye(3)
    ratio = float(shear_moduli[inside][0] / shear_moduli[mesh.regions == 0][0])
    added = displacement_by_ball(places, radius, strain, ratio)
    added[nodes] = displacement_by_ball(places[nodes], np.inf, strain, ratio)  # which strains all of the lump alike
    return added
