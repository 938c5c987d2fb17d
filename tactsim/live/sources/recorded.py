"""The recordings that a stored result holds: forces of the solution, and those read through sensors."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError, StorageError, TactsimError, shown
from tactsim.experiments.grasp.scene import ChangedShape, GraspScene
from tactsim.experiments.localization.scene import LocalizedGrasp
from tactsim.interfaces.both_jaws import READ_FORCE, SATURATED, TAXEL_FORCE, has_taxels, jaws_over_time, saturated_taxels
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.live.sources.noise import RESOLVED, ReadingNoise, solution_noise
from tactsim.live.sources.scene import LARGEST_FORCE, LATEST, PageScene, Recording, check_extent
from tactsim.outside.files import Unreadable
from tactsim.outside.text import one_line
from tactsim.results.reading import read_basis
from tactsim.results.result import Result
from tactsim.results.scene import UnreadableScene

SOURCES: dict[str, str] = {TAXEL_FORCE: "forces of the solution", READ_FORCE: "forces read through the sensors"}
"""Name of the forces -> what they are, in words."""
_TIMES: dict[str, str] = {TAXEL_FORCE: "time_history", READ_FORCE: "readout_time"}
DAMAGE = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, MemoryError, TactsimError)
"""What a result raises whose quantities no run writes: another type, a missing part, numbers that do not fit."""


def result_recordings(folder: str | Path) -> dict[str, Recording]:
    """The recordings of the result in a folder by the name of their forces, those of the solution first.

    Raises
    ------
    InputError
        If the result has no taxels.
    StorageError
        If there is no result, it is damaged, or the file of an inclusion's surface is gone or has changed.
    """
    stored = read_basis(folder)
    result = stored.result
    if not isinstance(result.scene, GraspScene | UnreadableScene) or not has_taxels(result, TAXEL_FORCE):
        raise InputError(
            f"{folder} holds the result of {result.kind}, which has no forces of taxels to show; "
            "needed: the result of a grasp, a matrix_readout or a localization, or a data set of grasps"
        )
    title = result.title or stored.case_title or Path(folder).resolve().name
    incomplete = f"{one_line(folder)}/result.json is not a complete result of a grasp"
    try:
        grasp = result.scene_as(GraspScene)
    except StorageError as error:
        raise StorageError(f"{incomplete}: {one_line(error)}") from None
    try:
        scene = _scene(result, grasp, title)
        return {name: _recording(result, scene, name) for name in SOURCES if has_taxels(result, name)}
    except Unreadable as error:
        remedy = "the result names its path alone: bring it back, or start in the folder in which it stands"
        raise StorageError(f"{one_line(folder)}/result.json: {one_line(error)}; {remedy}") from None
    except ChangedShape as error:
        raise StorageError(f"{one_line(folder)}/result.json: {error}") from None
    except DAMAGE as error:
        raise StorageError(f"{incomplete}: {one_line(error)}; run the grasp again") from None


def _scene(result: Result, grasp: GraspScene, title: str) -> PageScene:
    check_extent(grasp.size)
    displacement = result.quantities.get("displacement")
    return PageScene(
        title,
        grasp,
        closing=0.0 if displacement is None else float(displacement.value),
        notes=_notes(result),
    )


def _notes(result: Result) -> tuple[str, ...]:
    end = result.early_end
    return (*(() if end is None else (f"the run {end}",)), *result.warnings)


def _recording(result: Result, scene: PageScene, name: str) -> Recording:
    quantities, forces = result.quantities, jaws_over_time(result, name)
    if has_taxels(result, name, history=True):
        times = quantities[_TIMES[name]].numbers
    else:
        times = np.array([float(quantities["time"].value) if "time" in quantities else 0.0])
    saturated = saturated_taxels(result) if name == READ_FORCE and has_taxels(result, SATURATED) else None
    valid = checked_validity(forces, times, scene, saturated)
    stored = scene.grasp.noise if isinstance(scene.grasp, LocalizedGrasp) else 0.0
    noise = ReadingNoise(stored, "as stored with the localization") if stored else source_noise(name, forces, valid)
    return Recording(scene, times, forces, valid, _closings(result, times), name, noise)


def source_noise(name: str, forces: Array, valid: Array) -> ReadingNoise:
    """Of simulated forces (n, jaw, row, column) in N by their name in ``SOURCES``."""
    return solution_noise(np.where(valid, forces, 0.0)) if name == TAXEL_FORCE else RESOLVED


def checked_validity(forces: Array, times: Array, scene: PageScene, saturated: Array | None = None) -> Array:
    """Which of forces (n, jaw, row, column) in N can be trusted: finite, no mistaken unit, and not ``saturated`` (n or 1, ...).

    Raises
    ------
    InputError
        If shapes do not agree.
    """
    needed = (len(times), len(JAWS), scene.layout.rows, scene.layout.columns)
    if forces.shape != needed or not len(times):
        raise InputError(f"the forces of the taxels have the shape {forces.shape}; needed: (step, jaw, row, column) = {needed}")
    if not ((np.abs(times) <= LATEST).all() and (np.diff(times) > 0).all()):
        raise InputError(f"the times {shown(times.tolist())} do not increase, or not all are within {LATEST:g} s")
    valid = np.isfinite(forces) & (np.abs(np.nan_to_num(forces)) <= LARGEST_FORCE)
    return valid if saturated is None else valid & ~saturated


def _closings(result: Result, times: Array) -> Array | None:
    """Closing of each jaw at some times in m, None if the result does not hold it."""
    quantities = result.quantities
    if "displacement_history" in quantities:
        known = quantities["time_history"].numbers
        return np.interp(times, known, quantities["displacement_history"].numbers)
    if "displacement" in quantities and len(times) == 1:
        return np.array([float(quantities["displacement"].value)])
    return None
