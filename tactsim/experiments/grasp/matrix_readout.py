"""The matrices of a grasp that was run before, through film and electronics."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError, StorageError, TactsimError
from tactsim.experiments.grasp.scene import GraspScene, ReadGrasp
from tactsim.experiments.grasp.taxel_voltages import readout_assumptions, readout_quantities, readout_warnings
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.outside.input_path import InputPath
from tactsim.results.reading import read_result
from tactsim.results.result import Result, Status, rows
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
        stored = read_result(self.grasp, fields=False).result
        times, forces = _history(stored, self.grasp)
        scene = _scene(stored, self.grasp)
        reading = self.readout.read(times, forces, scene.matrix.area)
        voltage, force = reading.filtered.max(axis=(2, 3)), reading.force.sum(axis=(2, 3))
        true = {name: stored.quantities[name] for side in JAWS for name in (f"taxel_force_{side}", f"taxel_pressure_{side}")}
        return Course.computed(
            Findings(
                "end of the grasp",
                rows(self.history_units, (reading.time, *voltage.T, *force.T)),
                quantities=readout_quantities(reading) | true,
                assumptions=readout_assumptions(self.readout, scene.matrix.area),
                warnings=readout_warnings(self.readout, reading, scene.matrix.area) + _unfinished(stored),
                scene=ReadGrasp.of(scene),
            )
        )


def _scene(stored: Result, folder: str) -> GraspScene:
    try:
        return stored.scene_as(GraspScene)
    except TactsimError as error:
        raise _incomplete(folder, error) from None


def _incomplete(folder: str, error: Exception) -> StorageError:
    return StorageError(f"{folder}/result.json is not a complete result of a grasp ({error!r:.200}); run the grasp again")


def _history(stored: Result, folder: str) -> tuple[Array, Array]:
    """Times (n,) in s and forces (n, jaw, row, column) in N of a stored grasp."""
    if stored.kind != "grasp" or not stored.steps:
        raise InputError(f"{folder} holds the result of {stored.kind} with {len(stored.steps)} steps; needed: a grasp with steps")
    names: Any = [f"taxel_force_{side}" for side in JAWS]
    try:
        if len(stored.steps) > 1:
            times = stored.quantities["time_history"].numbers
            forces = [stored.quantities[f"{name}_history"].numbers for name in names]
        else:
            times = np.array([stored.quantities["time"].value], dtype=float)
            forces = [stored.quantities[name].numbers[None] for name in names]
    except KeyError as error:
        raise _incomplete(folder, error) from None
    return times, np.stack(forces, axis=1)


def _unfinished(stored: Result) -> tuple[str, ...]:
    if stored.status is Status.CONVERGED:
        return ()
    return (f"the grasp ended as {stored.status.value} ({stored.reason}); what it had accepted is read",)
