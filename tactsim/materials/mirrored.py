"""Whether a law is its own mirror image, as a model of half a body or of a section takes it to be."""

from __future__ import annotations

import numpy as np

from tactsim.errors import InputError
from tactsim.interfaces import Material
from tactsim.materials.kinematics import sampled_deformations

STATES = 8
"""Deformations at which stresses are compared: an oblique fibre shows in any of them."""
SAME_STRESS = 1e-6
"""Difference of two stresses over the largest that counts as none."""


def law_mirrors(material: Material, axis: int) -> bool:
    """Whether a mirrored deformation has the mirrored stress, for a plane normal to an axis 0, 1 or 2 of the law.

    Compared at a few deformations. Isotropic laws do, and those with fibres along the axis or normal to it.
    """
    F = sampled_deformations(STATES)
    signs = np.ones(3)
    signs[axis] = -1.0
    flip = np.multiply.outer(signs, signs)[:, :, None]
    pressure = np.zeros(STATES)
    stress, image = (material.first_piola_kirchhoff(state, pressure) for state in (F, flip * F))
    return bool(np.abs(flip * image - stress).max() <= SAME_STRESS * np.abs(stress).max())


def check_in_plane(material: Material) -> None:
    """Refuse a law that shears a section out of its plane: the motion across the plane is not computed.

    Raises
    ------
    InputError
        If a section is not its own mirror image with this material.
    """
    if not law_mirrors(material, 2):
        raise InputError(
            f"material {material.kind} shears a section out of its plane, within which all is computed; its third axis is the "
            "hoop, or the depth in plane strain: turn the axes of the material, or take a body in 3D"
        )
