"""Which element a solution fails in, in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body, Kinematics
from tactsim.fem.assembly.external_forces import AnyInterface

COLLAPSED = 0.4
"""Part of the volume that the pressure asks for, below which an element is about to turn inside out: the worst elements of grasps
that converge keep 0.41 at least; in a fold beside a hollow tube it falls from 0.35 to 0.2 while steps only shrink."""


def element_in_words(body: Body, element: int) -> str:
    """Number, undeformed centroid and region of an element."""
    corners = body.space.nodes[body.space.elements[element, : body.space.dim + 1]]
    place = ", ".join(f"{1e3 * coordinate:.4g}" for coordinate in corners.mean(axis=0))
    return f"element {body.numbers[element]} at ({place}) mm in region {body.regions[element]}"


def inside_out_in_words(body: Body, kinematics: Kinematics) -> str:
    """The element that is turned farthest inside out, with its volume ratio; the first without a deformation comes before it."""
    undefined = np.flatnonzero(~np.isfinite(kinematics.J).all(axis=1))
    if len(undefined):
        return f"{element_in_words(body, int(undefined[0]))}, whose deformation is no finite number"
    least = body.oriented_volume_ratio(kinematics).min(axis=1)
    element = int(least.argmin())
    if least[element] < kinematics.J[element].min():
        return f"{element_in_words(body, element)}, which passes the axis of revolution"
    return f"{element_in_words(body, element)}, volume ratio {least[element]:.3g}"


def collapsed_in_words(body: Body, kinematics: Kinematics, unknowns: Array) -> str | None:
    """The element that has kept the least part of the volume that the pressure asks for, if that is less than ``COLLAPSED``.

    ``unknowns`` (size,) have this deformation.
    """
    asked = 1 + body.compliance[:, None] * body.pressure(unknowns)
    meant = ~body.linear & (asked > 0).all(axis=1)  # where a pressure asks for no volume, no part of it is kept
    kept = np.where(meant, (kinematics.J / np.where(asked > 0, asked, np.inf)).min(axis=1), np.inf)
    element = int(kept.argmin())
    if kept[element] >= COLLAPSED:
        return None
    return f"{element_in_words(body, element)} has kept {100 * kept[element]:.0f} % of its volume"


def not_finite_in_words(
    body: Body, kinematics: Kinematics, internal: Array, interfaces: Sequence[AnyInterface], tractions: Sequence[Array]
) -> str:
    """The first element whose deformation, nodal force or contact traction is no finite number, and which of these it is.

    ``internal`` (size,) is in N, the traction (d, n) of each interface in Pa.
    """
    for what, finite in (("deformation", kinematics.F), ("stress", body.energy_slopes(kinematics, second=False))):
        bad = np.flatnonzero(~np.isfinite(finite).all(axis=(*range(finite.ndim - 2), finite.ndim - 1)))
        if len(bad):
            return f"the {what} of {element_in_words(body, int(bad[0]))}"
    nodal = np.isfinite(internal[: body.space.displacement_size]).reshape(-1, body.space.dim).all(axis=1)
    if not nodal.all():
        return f"the nodal force on {_element_at(body, ~nodal)}"
    for interface, traction in zip(interfaces, tractions, strict=True):
        bad = np.flatnonzero(~np.isfinite(traction).all(axis=0))
        if len(bad):
            touched = np.zeros(len(body.space.nodes), bool)
            touched[interface.surface.points.nodes[bad[0]]] = True
            return f"the contact traction on {_element_at(body, touched)}"
    return "the volume constraint"


def _element_at(body: Body, chosen: Array) -> str:
    """The first of the elements that have most of the chosen nodes (n,)."""
    return element_in_words(body, int(chosen[body.space.elements].sum(axis=1).argmax()))
