"""The probe with leaning sides pressed into tissue in plane strain: force, contact on its sides, and what its switches carry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tactsim.contact.trapezoid import Trapezoid
from tactsim.experiments.contact_equilibrium import ContactEquilibrium
from tactsim.experiments.indentation_model import IndentationModel
from tactsim.experiments.timed_indentation_path import TimedIndentationPath
from tactsim.experiments.timed_indentation_setup import TimedIndentationSetup
from tactsim.fem.space import Measure
from tactsim.sensors.switch_array import SwitchArray

Array = np.ndarray

SAMPLES = 20_000
"""Points between which the contact along the surface is interpolated, so that a strip's ends fall between them."""
REACH = 1.0
"""How far around a corner of the face elements are finest, in half widths of the face: this tissue comes to lie on the side."""
TOUCHED = 1e-3
"""Part of the largest pressure above which a point counts as touched."""


class ProbeIndentation(TimedIndentationSetup):
    """A prism pressed into a block as deep as itself, both much longer than wide; the specimen's radius is half its width."""

    measure: ClassVar[Measure] = "plane_strain"

    def _focus(self) -> tuple[tuple[float, ...], float, float]:
        rims, _, finest = super()._focus()
        return rims, REACH * self.contact_radius, finest


@dataclass(frozen=True)
class ProbeState:
    """An accepted state of the probe: time in s, depth in m, force on the whole probe in N, contact height in m on its sides,
    forces in N on the switches (count,), and ``iterations`` and ``residual`` of Newton."""

    time: float
    depth: float
    force: float
    contact_height: float
    switch_forces: Array
    iterations: int
    residual: float


def probe_states(setup: ProbeIndentation, array: SwitchArray, *, width: float) -> Iterator[ProbeState]:
    """The accepted states of a prescribed history, the probe ``width`` in m out of the plane.

    Raises
    ------
    ConvergenceError
        If the path cannot be followed to its end.
    """
    model = setup.model()
    path = TimedIndentationPath(setup, model)
    for state, _ in path.states():
        yield _probe_state(model, state.contact, array, (state.time, width))


def _probe_state(
    model: IndentationModel, state: ContactEquilibrium, array: SwitchArray, time_and_width: tuple[float, float]
) -> ProbeState:
    time, width = time_and_width
    contact = state.contacts[0]
    traction = contact.at(model.displacement(state.unknowns))
    order = np.argsort(contact.reference[0])
    along = contact.reference[0, order]
    body = contact.pair.body
    corner = body.fillet_height if isinstance(body, Trapezoid) else 0.0
    height, carried = side_forces(along, traction.points[1, order], traction.pressure[order], array)
    force = -2 * width * float(model.surface.total(traction.traction)[1])
    contact_height = height if height > corner else 0.0
    return ProbeState(time, state.load, force, contact_height, width * carried, state.iterations, state.residual)


def side_forces(along: Array, height: Array, pressure: Array, array: SwitchArray) -> tuple[float, Array]:
    """Largest height in m above the face that is touched, and force in N per m of width on each switch (count,).

    Points of the surface by the undeformed place ``along`` (n,) in m, increasing, with their ``height`` in m above the face and
    the ``pressure`` in Pa per undeformed area; the pressure is integrated over the strip of each switch, linear between points.
    """
    fine = np.linspace(along[0], along[-1], SAMPLES)
    z, p = np.interp(fine, along, height), np.interp(fine, along, pressure)
    touched = p > TOUCHED * p.max()
    highest = float(z[touched].max()) if touched.any() else 0.0
    inside = np.abs(z[None] - array.heights[:, None]) <= array.strip / 2
    return max(highest, 0.0), (inside * p).sum(axis=1) * (fine[1] - fine[0])
