"""Readings of a grasp that was run before, from its folder, and where its inclusions truly lie."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from tactsim.array import Array
from tactsim.errors import InputError, StorageError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.interfaces import Inclusion
from tactsim.interfaces.both_jaws import READ_FORCE, TAXEL_FORCE, Source, has_taxels, jaws_at_end, saturated_taxels
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.materials.homogeneous import stiffness_ratio
from tactsim.outside.text import one_line
from tactsim.refusals import first_fault
from tactsim.results.reading import read_basis, read_result
from tactsim.results.result import Result
from tactsim.results.scene import UnreadableScene
from tactsim.units import format_quantity

SAME_CLOSING = 1e-3
"""Largest relative difference of two closings that are the same."""
SAME_JAW = 1e-6
"""Difference in m, or in rad, of two jaws that are the same."""
JAW_LENGTHS, JAW_ANGLES = ("width", "depth", "fillet"), ("tilt_x", "tilt_y")
"""What of a jaw the tissue feels."""


def stored_grasp(folder: str) -> Result:
    """The result of a grasp in a folder, without its fields.

    Raises
    ------
    StorageError
        If there is no result, or its scene cannot be read.
    InputError
        If it is not that of a grasp with taxels.
    """
    result = read_basis(folder).result
    if isinstance(result.scene, UnreadableScene):
        raise StorageError(f"{one_line(folder)}: {result.scene.in_words}")
    if not isinstance(result.scene, GraspScene) or not has_taxels(result, TAXEL_FORCE):
        raise InputError(
            f"{folder} holds the result of {result.kind} without forces of taxels; needed: a grasp or a matrix_readout with steps"
        )
    return result


def computed_grasp(folder: str) -> Grasp:
    """The grasp that the result in a folder was computed from.

    Raises
    ------
    StorageError
        If there is no result.
    InputError
        If it does not keep the case of a grasp that this version can read.
    """
    experiment = read_result(folder, fields=False).provenance.get("case", {}).get("experiment", {})
    cls = Grasp.registered_as(experiment.get("kind"))
    if cls is None:
        raise InputError(f"{folder} does not hold the case of a grasp; give the folder that `tactsim run` wrote for a grasp")
    try:
        return cls.model_validate_json(json.dumps(experiment), strict=True)
    except ValidationError as error:
        raise InputError(f"the case in {folder} is not one of this version of tactsim: {first_fault(error)}") from None


def readings_of(result: Result, source: Source = TAXEL_FORCE, *, noise: float, dead: Array | None = None) -> Readings:
    """What the matrices of a stored grasp read at its last accepted step.

    ``dead`` (jaw, row, column) marks taxels that are not to be trusted; of ``read_force`` a taxel whose voltage is outside the
    range of the converter at that step is not trusted either.

    Raises
    ------
    InputError
        If the result was not read through sensors, or its matrices do not face each other.
    """
    if not has_taxels(result, source):
        raise InputError(f"the result has no {source}; give the grasp a readout, run matrix_readout on it, or take {TAXEL_FORCE}")
    scene = result.scene_as(GraspScene)
    layout = scene.matrix
    valid = np.ones((2, layout.rows, layout.columns), bool) if dead is None else ~dead
    if source == READ_FORCE:
        valid = valid & ~saturated_taxels(result)[-1]
    closing = result.quantities.get("displacement")
    return Readings(
        jaws_at_end(result, source),
        layout,
        scene.size,
        noise=noise,
        valid=None if valid.all() else valid,
        middle=_middle(scene),
        closing=None if closing is None else float(closing.value),
    )


def with_reference(readings: Readings, reference: Readings) -> Readings:
    """The readings with those of a grasp without a lump.

    Raises
    ------
    InputError
        If block, matrix or closing differ.
    """
    if readings.layout != reference.layout or not np.allclose(readings.block_size, reference.block_size, rtol=1e-9):
        raise InputError("the reference has another block or another matrix; needed: the same grasp without the lump")
    if readings.closing is not None and reference.closing is not None and not same_closing(reference.closing, readings.closing):
        here, there = (format_quantity(value, "m") for value in (readings.closing, reference.closing))
        raise InputError(f"the jaws have closed by {here}, those of the reference by {there}; needed: the same closing")
    valid = [part.valid for part in (readings, reference) if part.valid is not None]
    mask = np.logical_and.reduce(valid) if valid else None
    return replace(readings, reference=reference.forces, valid=mask)


def same_closing(closing: Array | float, other: float) -> bool:
    """Whether closings in m, one or (n,), are all the same as another one, but for steps and round-off."""
    return bool((np.abs(np.subtract(closing, other)) <= SAME_CLOSING * abs(other)).all())


def stiffness_ratios(folder: str, closing: float | None) -> tuple[tuple[float, float], ...]:
    """Stiffness of each inclusion of a stored grasp over that of its tissue: at the working strain, and at rest.

    The working strain is the mean one of plain tissue, both jaws closed by ``closing`` in m. Empty if the grasp does not keep the
    case that it was computed from, or its closing is not known.
    """
    if closing is None:
        return ()
    try:
        grasp = computed_grasp(folder)
    except InputError:
        return ()
    tissue, stretch = grasp.block.tissue, 1 - 2 * closing / float(grasp.block.size[2])
    return tuple(
        (stiffness_ratio(one.material, tissue, stretch), stiffness_ratio(one.material, tissue, 1.0))
        for one in grasp.unlike_tissue
    )


def reference_notes(inclusions: Sequence[Inclusion]) -> tuple[str, ...]:
    """What the user must know of a reference that was computed with these inclusions."""
    if not inclusions:
        return ()
    what = "an inclusion" if len(inclusions) == 1 else f"{len(inclusions)} inclusions"
    return (f"the reference holds {what} of another material than the tissue: only what differs from it can be found",)


def jaw_notes(grasp: GraspScene, reference: GraspScene) -> tuple[str, ...]:
    """What the user must know of a reference that was grasped by jaws of another form, tilt or place."""
    notes = []
    for side in JAWS:
        here, there = grasp.jaws[side], reference.jaws[side]
        pairs = {name: (getattr(here, name), getattr(there, name)) for name in JAW_LENGTHS + JAW_ANGLES}
        pairs |= {f"middle along {'xy'[k]}": (grasp.place(side)[k], reference.place(side)[k]) for k in range(2)}
        for name, values in pairs.items():
            if abs(values[0] - values[1]) > SAME_JAW:
                own, other = (format_quantity(float(value), "rad" if name in JAW_ANGLES else "m") for value in values)
                notes.append(f"{name} of the {side} jaw is {own}, in the reference {other}")
    return (f"{'; '.join(notes)}: what this changes in the readings is taken for lumps",) if notes else ()


def unfinished_notes(grasp: Result, folder: str) -> tuple[str, ...]:
    """What the user must know of a stored grasp that did not come to its end."""
    end = grasp.early_end
    return () if end is None else (f"the grasp in {folder_words(folder)} {end}",)


def away_from_truth(center: Array, places: Array) -> tuple[Array, float, float]:
    """The true place (3,) nearest in plan among ``places`` (n, 3), and the distances of a centre (3,) from it, all in m.

    The distances are that in plan, and that in height, positive if the centre is nearer to the upper jaw.
    """
    away = center - places
    nearest = int(np.hypot(*away[:, :2].T).argmin())
    return places[nearest], float(np.hypot(*away[nearest, :2])), float(away[nearest, 2])


def _middle(scene: GraspScene) -> Array:
    """Middle (2,) of both matrices in m; refuses matrices that do not face each other."""
    upper, lower = scene.places[:, :2]
    away, pitch = float(np.abs(upper - lower).max()), scene.matrix.pitch
    if away > pitch / 2:
        raise InputError(
            f"the matrices of both jaws are {format_quantity(away, 'm')} apart sideways; the views need taxels that face each "
            f"other: at most half the pitch, {format_quantity(pitch / 2, 'm')}"
        )
    return scene.middle


def folder_words(folder: str) -> str:
    """Name of a folder for a message, without where it lies on this machine."""
    return Path(folder).name
