"""What a grasp reports: history, forces of the taxels, fields, assumptions and warnings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.experiments.grasp.history import AXES, MOST_COLUMNS, taxel_columns
from tactsim.experiments.grasp.lumen_pressure import PulsePressure
from tactsim.experiments.grasp.path import stiffest_block
from tactsim.experiments.grasp.quantities import final_quantities, history_quantities
from tactsim.experiments.grasp.readings import JawReading, jaw_readings
from tactsim.experiments.grasp.scene import EmbeddedShape, MeshReport, SimulatedGrasp
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.experiments.grasp.symmetry import mirror_asymmetry, mirror_axes
from tactsim.experiments.grasp.taxel_voltages import readout_assumptions, readout_quantities, readout_warnings, single_step
from tactsim.experiments.grasp.tissue_alone import why_not_tissue
from tactsim.experiments.grasp.warnings import ragged, smaller_elements, suction, uneven
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.interfaces.run import Findings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.block_source import SourcedBlock
from tactsim.mechanics.outcome.contact_history import LAST
from tactsim.mechanics.outcome.contact_record import (
    ERROR_IN_TIME,
    UNPRINTED,
    ContactRecord,
    penetration_allowed,
    solver_report,
)
from tactsim.mechanics.outcome.wrinkles import wrinkled
from tactsim.mechanics.paths.history_path import TimedPath, TimedState
from tactsim.results.quantity import Quantity
from tactsim.results.result import Status, StepRecord
from tactsim.sensors.matrix_readout import MatrixReading
from tactsim.units import format_quantity


def _closing_reached(step: StepRecord) -> str:
    """How far the jaws have closed in a step, in words."""
    return f"a closing of {format_quantity(step.values['displacement'], 'm')} per jaw"


class GraspRecord(ContactRecord[GraspModel]):
    """Collects the accepted steps of a grasp, with what the taxels of both jaws read."""

    def __init__(self, experiment: GraspSetup, model: GraspModel, sourced: SourcedBlock, path: TimedPath):
        super().__init__(
            model,
            path,
            tolerance=experiment.tolerance,
            stiffest=stiffest_block(experiment),
            finer=experiment.mesh.finer,
            reached=_closing_reached,
        )
        self.experiment, self._sourced = experiment, sourced
        self.readings: list[dict[str, JawReading]] = []
        self._read: MatrixReading | None = None
        self._unread: str | None = None

    def values(self, state: TimedState) -> dict[str, float]:
        """History values of a state in SI; its readings are kept.

        Raises
        ------
        ConvergenceError
            If the forces of the taxels do not add up to that of the jaw.
        """
        layout = self.experiment.matrix
        readings = jaw_readings(self.model, state.contact, layout)
        self.readings.append(readings)
        values = {"time": state.time, "displacement": state.contact.load, "reaction_force": readings["upper"].normal}
        for side, reading in readings.items():
            values |= {f"jaw_force_{side}_{axis}": float(part) for axis, part in zip(AXES, reading.force, strict=True)}
            values[f"gap_force_{side}"] = float(reading.taxels.gaps[2])
            values[f"outside_force_{side}"] = float(reading.taxels.outside[2])
        values["max_penetration"] = state.contact.penetration
        values |= self.quality.values(self.model.body, state.contact)
        values |= {f"lumen_pressure_{k}": p for k, p in zip(self.experiment.lumens, state.loads[1:], strict=True)}
        if max(layout.rows, layout.columns) <= MOST_COLUMNS:
            for side, reading in readings.items():
                names = taxel_columns(side)
                for (row, column), force in np.ndenumerate(reading.taxels.taxels[2]):
                    values[names[row + 1, column + 1]] = float(force)
        return values

    def kept_as(self, state: TimedState, event: bool) -> list[str]:
        """The first and the last state, and that of the largest sum of all pressures in lumens."""
        names = ["last"] if self._kept else ["first", "last"]
        strongest = self._kept["strongest"].state if "strongest" in self._kept else state
        if self.experiment.lumens and sum(state.loads[1:]) >= sum(strongest.loads[1:]):
            names.append("strongest")
        return names

    def verdict(self) -> tuple[Status, str]:
        """Success: a grasp has no event to look for on its way."""
        return Status.CONVERGED, "end of the history"

    def findings(self) -> Findings:
        """What everything that was accepted says, the voltages included."""
        readout, layout = self.experiment.readout, self.experiment.matrix
        if readout is not None and self.steps:
            times = np.array([step.values["time"] for step in self.steps])
            forces = np.array([[reading[side].taxels.taxels[2] for side in JAWS] for reading in self.readings])
            try:
                self._read = readout.read(times, forces, layout.area)
            except InvalidQuantity as error:  # the simulation is kept: another readout can be made of it
                self._unread = f"no voltages: {error}; set another readout in a case of kind matrix_readout on this result"
        findings = super().findings()
        timing = {} if self._sourced.made_before else {"meshing": self._sourced.block.seconds}
        return replace(findings, quantities=findings.quantities or self._unknowns, timing=timing)

    @property
    def _unknowns(self) -> dict[str, Quantity]:
        return {"unknowns": Quantity(self.model.space.size, "1", "unknowns of the finite element model")}

    def quantities(self) -> dict[str, Quantity]:
        """Quantities at the last step, of all steps, and of the readout."""
        values = [step.values for step in self.steps]
        quantities = final_quantities(values, self.readings[-1], self.experiment) | super().quantities()
        if (asymmetry := self._asymmetry()) is not None:
            text = "largest difference of a taxel's force from that on its mirror image, over the largest force" + LAST
            quantities["mirror_asymmetry"] = Quantity(asymmetry, "1", text)
        quantities |= history_quantities(values, self.readings, self.experiment) | self._unknowns
        return quantities if self._read is None else quantities | readout_quantities(self._read)

    def assumptions(self) -> list[str]:
        """Sizes, shapes and laws that the sources do not print and the case chooses, a sentence for each."""
        experiment, block = self.experiment, self._sourced.block
        size = " x ".join(format_quantity(side, "m") for side in experiment.block.size)
        assumptions = [f"block of {size} {UNPRINTED}"]
        for side in JAWS:
            jaw = experiment.jaw(side)
            width, depth = format_quantity(jaw.width, "m"), format_quantity(jaw.depth, "m")
            edges = format_quantity(jaw.fillet, "m")
            assumptions.append(f"{side} jaw of {width} x {depth}, edges rounded by {edges} {UNPRINTED}")
        pitch, taxel = format_quantity(experiment.matrix.pitch, "m"), format_quantity(experiment.matrix.size, "m")
        assumptions.append(f"taxels of {taxel} at a pitch of {pitch} {UNPRINTED}")
        for number, lumen in experiment.lumens.items():
            if isinstance(lumen, PulsePressure):
                least, most = (format_quantity(value, "Pa") for value in lumen.limits)
                reading = f"reading {lumen.reading} (erratum E14)" if lumen.diastole is lumen.systole is None else "as given"
                assumptions.append(f"lumen {number}: {reading}, {least} to {most} at {lumen.rate:g} Hz, a raised cosine")
        if any(material.bulk_modulus is None for material in experiment.materials):
            assumptions.append("exactly incompressible materials (section 6.5)")
        made = f"{'once ' if self._sourced.made_before else ''}made in {block.seconds:.1f} s"
        assumptions.append(
            f"mesh {self._sourced.content} ({self._sourced.origin}): {self.model.space.size} unknowns, "
            f"least quality {block.quality.minimum:.2g}, {made}"
        )
        assumptions += smaller_elements(block)
        if (copies := self.model.problem.copies) > 1:
            assumptions.append(
                f"the grasp is its own mirror image: one part of {copies} is solved, and every solution looked at in the whole"
            )
        assumptions += self._solver_assumptions()
        assumptions.append(penetration_allowed(experiment.tolerance))
        if "last" in self._kept and (last := self._kept["last"].state.contact.regularisation.tolerance) < experiment.tolerance:
            assumptions.append(f"penetration below {format_quantity(last, 'm')} at the end, for the error of the force")
        if any(material.relaxation is not None for material in experiment.materials):
            assumptions.append(ERROR_IN_TIME.format(experiment.time.tolerance))
        if experiment.readout is not None:
            assumptions += readout_assumptions(experiment.readout, experiment.matrix.area)
        return assumptions

    def _solver_assumptions(self) -> list[str]:
        """What the case chooses of the solver, if it is not the usual, and whether it acts."""
        solver, assumptions = self.experiment.solver, []
        if solver.first_guess == "tissue":
            hindrance = why_not_tissue(self.experiment)
            begins = f"as usual, for {hindrance}" if hindrance else "in the tissue without its inclusions, if that converges"
            assumptions.append(f"solver.first_guess: Newton begins {begins}")
        if solver.balance > NewtonOptions.tolerance:
            assumptions.append(f"solver.balance: unbalanced forces of up to {solver.balance:g} of the largest nodal force")
        return assumptions

    def warnings(self) -> list[str]:
        """Warnings about readout, mesh, readings, free faces and volumes."""
        readout, warnings = self.experiment.readout, []
        if readout is not None and self._read is not None:
            read = readout, self._read, self.experiment.matrix.area
            warnings = [*(single_step(*read) if len(self.steps) == 1 else ()), *readout_warnings(*read)]
        if self._unread:
            warnings.append(self._unread)
        warnings += [*ragged(self._sourced.block), *suction(self.readings), *uneven(self._asymmetry())]
        closed = 2 * max(step.values["displacement"] for step in self.steps)
        warnings += wrinkled(1 - closed / self.experiment.block.size[2])
        return [*warnings, *super().warnings()]

    def _asymmetry(self) -> float | None:
        """How far the last forces are from their mirror images, None if the grasp is not its own."""
        axes = mirror_axes(self.experiment)
        return mirror_asymmetry(self.readings[-1], axes) if axes and self.readings else None

    def scene(self) -> SimulatedGrasp:
        """The parts of the grasp and where they stand."""
        block, experiment = self._sourced.block, self.experiment
        tissue = experiment.block.tissue
        return SimulatedGrasp(
            block_size=experiment.block.size,
            inclusions=tuple(
                EmbeddedShape(shape=one.shape, unlike_tissue=one.unlike(tissue), file_content=one.shape.file_content())
                for one in experiment.inclusions
            ),
            jaws={side: experiment.jaw(side) for side in JAWS},
            jaw_places=self._places(),
            matrix=experiment.matrix,
            solver=solver_report(self),
            mesh=MeshReport(
                content=self._sourced.content,
                origin=self._sourced.origin,
                least_quality=block.quality.minimum,
                mean_quality=block.quality.mean,
                least_curvature=block.quality.curvature,
                straightened_edges=block.quality.straightened,
                volume_errors=block.volume_errors.tolist(),
                regions=block.region_names,
            ),
            control=experiment.loading.control,
        )

    def _places(self) -> dict[str, Any]:
        """Where the middle of each jaw's face stands in m at the last accepted step."""
        if "last" not in self._kept:
            return {side: self.model.touching_place(side).tolist() for side in JAWS}
        last = self._kept["last"].state
        return {side: contact.place.tolist() for side, contact in zip(JAWS, last.contact.contacts, strict=True)}
