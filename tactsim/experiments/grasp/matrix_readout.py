"""The matrices of a grasp that was run before, through film and electronics."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.array import Array
from tactsim.errors import InputError, StorageError, TactsimError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.scene import GraspScene, ReadGrasp
from tactsim.experiments.grasp.taxel_voltages import readout_assumptions, readout_quantities, readout_warnings, single_step
from tactsim.interfaces import Experiment
from tactsim.interfaces.both_jaws import TAXEL_FORCE, TAXEL_PRESSURE, jaws_over_time, over_time
from tactsim.interfaces.run import Course, Findings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.outside.input_path import InputPath
from tactsim.results.reading import read_basis
from tactsim.results.result import Result, rows
from tactsim.sensors.matrix_readout import MatrixReadout


class MatrixReadoutRun(Experiment):
    """Voltages and read forces of all taxels over the time of a stored grasp."""

    kind: Literal["matrix_readout"] = "matrix_readout"
    grasp: InputPath
    """Folder of the result of a grasp, beside the case or in the working folder."""
    readout: MatrixReadout = MatrixReadout()
    """Sensors and electronics."""

    history_units: ClassVar[dict[str, str]] = {"time": "s"} | {
        f"{name}_{side}": unit for name, unit in (("largest_voltage", "V"), ("total_read_force", "N")) for side in JAWS
    }

    @classmethod
    def example(cls) -> Self:
        """The grasp of a lump whose result is shipped."""
        return cls(grasp="cases/stored/grasp_lump")

    def begin(self) -> Course:
        """Read the stored forces; one step for every sample.

        Raises
        ------
        StorageError
            If the stored result is damaged or not that of a grasp.
        """
        stored = read_basis(self.grasp).result
        scene, times, forces = _read(stored, self.grasp)
        reading = self.readout.read(times, forces, scene.matrix.area)
        warnings = readout_warnings(self.readout, reading, scene.matrix.area) + _unfinished(stored)
        if len(times) == 1:
            warnings += single_step(self.readout, reading, scene.matrix.area)
        voltage, force = reading.filtered.max(axis=(2, 3)), reading.force.sum(axis=(2, 3))
        true = {name: stored.quantities[name] for side in JAWS for name in (f"{TAXEL_FORCE}_{side}", f"{TAXEL_PRESSURE}_{side}")}
        return Course.computed(
            Findings(
                "end of the grasp",
                rows(self.history_units, (reading.time, *voltage.T, *force.T)),
                quantities=readout_quantities(reading) | true,
                assumptions=readout_assumptions(self.readout, scene.matrix.area),
                warnings=warnings,
                scene=ReadGrasp.of(scene),
            )
        )


def _read(stored: Result, folder: str) -> tuple[GraspScene, Array, Array]:
    """The scene of a stored grasp, the times (n,) of its steps in s, and the forces (n, jaw, row, column) of its taxels in N."""
    if Grasp.registered_as(stored.kind) is None or not stored.steps:
        raise InputError(f"{folder} holds the result of {stored.kind} with {len(stored.steps)} steps; needed: a grasp with steps")
    try:
        scene, times, forces = stored.scene_as(GraspScene), over_time(stored, "time"), jaws_over_time(stored, TAXEL_FORCE)
        if not len(times) == len(forces) == len(stored.steps):
            raise InputError(f"{len(stored.steps)} steps, {len(times)} times, {len(forces)} forces of every taxel")
    except TactsimError as error:
        what = f"{folder}/result.json is not a complete result of a grasp"
        raise StorageError(f"{what} ({error!r:.200}); run the grasp again") from None
    return scene, times, forces


def _unfinished(stored: Result) -> tuple[str, ...]:
    end = stored.early_end
    return () if end is None else (f"the grasp {end}; what it had accepted is read",)
