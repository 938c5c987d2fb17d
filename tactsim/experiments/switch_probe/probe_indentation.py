"""The probe with leaning sides pressed into tissue in plane strain: force, contact on its sides, and what its switches carry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from tactsim.array import Array
from tactsim.contact.trapezoid import Trapezoid
from tactsim.experiments.indentation.course import HistoryPath
from tactsim.experiments.indentation.graded_section import GradedSection
from tactsim.experiments.indentation.record import IndentationRecord
from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.fem.assembly.space import Measure
from tactsim.mechanics.models.pressed_model import PressedModel
from tactsim.mechanics.outcome.contact_quality import ContactQuality
from tactsim.mechanics.paths.history_path import TimedState
from tactsim.results.result import StepRecord
from tactsim.sensors.switch_array import SwitchArray

SAMPLES = 20_000
"""Points between which the contact along the surface is interpolated, so that a strip's ends fall between them."""
REACH = 1.0
"""How far around a corner of the face elements are finest, in half widths of the face: this tissue comes to lie on the side."""
DEEP = 6
"""Elements over half the width of the face in the depth beneath it, a third of the usual fillet each. Only those on the surface
shrink with the fillet: the tissue in the depth bends over the face. At a sharp corner they do not shrink either: the strain is
singular there, and the smaller they are the sooner they collapse. With a fiftieth of half the face they do at a depth of 0.8 mm;
with these the default probe comes to 5 mm, with the force that fillets of 0.1 and 0.05 mm tend to, to 0.01 %."""
TOUCHED = 1e-3
"""Part of the largest pressure above which a point counts as touched."""


class ProbeIndentation(TimedIndentation):
    """A prism pressed into a block as deep as itself, both much longer than wide; the specimen's radius is half its width."""

    measure: ClassVar[Measure] = "plane_strain"

    def section(self) -> GradedSection:
        """The section, its elements smallest on what comes to lie on the face and beside its corners, and small beneath."""
        section, deep = super().section(), self.contact_radius / DEEP
        usual = section.usual if section.shape.fillet else deep
        return replace(section, reach=REACH * self.contact_radius, usual=usual, deep=deep)


@dataclass(frozen=True)
class ProbeState:
    """An accepted state of the probe: time in s, depth in m, force on the whole probe in N, contact height in m on its sides,
    forces in N on the switches (count,), and the ``record`` of the step by which success is judged."""

    time: float
    depth: float
    force: float
    contact_height: float
    switch_forces: Array
    record: StepRecord


def probe_states(
    setup: ProbeIndentation, array: SwitchArray, *, width: float, quality: ContactQuality | None = None
) -> Iterator[ProbeState]:
    """The accepted states of a prescribed history, the probe ``width`` in m out of the plane, followed by ``quality``.

    Raises
    ------
    ConvergenceError
        If the path cannot be followed to its end.
    """
    model = setup.model()
    path = HistoryPath(setup, setup.drive(), model)
    record = IndentationRecord(setup, model, path)
    if quality is not None:
        record.quality = quality
    for state, _ in path.states():
        yield _probe_state(model, state, array, width=width, record=record.accept(state))


def _probe_state(model: PressedModel, state: TimedState, array: SwitchArray, *, width: float, record: StepRecord) -> ProbeState:
    contact = state.contact.contacts[0]
    traction = contact.at(model.displacement(state.contact.unknowns))
    order = np.argsort(contact.reference[0])
    along = contact.reference[0, order]
    body = contact.pair.body
    corner = body.fillet_height if isinstance(body, Trapezoid) else 0.0
    height, side_force = side_forces(along, traction.points[1, order], traction.pressure[order], array)
    force = 2 * width * float(model.force(traction.traction)[1])
    contact_height = height if height > corner else 0.0
    return ProbeState(state.time, state.contact.load, force, contact_height, width * side_force, record)


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
