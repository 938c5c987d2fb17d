"""What the taxels of simulated grasps read of lumps, arteries and pulses: thesis, section 6.6."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.case import load_case
from tactsim.errors import InputError, InvalidQuantity
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.history import taxel_columns
from tactsim.interfaces import drawing, quantity
from tactsim.interfaces.taxel_layout import JAWS, JawName
from tactsim.localization.bands import band_intensities
from tactsim.localization.views import SHAPE, views, volume
from tactsim.results.compared_numbers import CLOSE
from tactsim.units import Length, NonNegative, Time, format_quantity
from tactsim.validation.curves import Data, Title
from tactsim.validation.inputs import Inputs, RunName, StudyName
from tactsim.validation.study import RunOutcome

JawOrDifference = JawName | Literal["upper less lower"]
"""A jaw, or the difference of both."""
Taxel = tuple[int, int]
"""Row and column, counted from 1."""


def taxel_history(outcome: RunOutcome, side: str) -> Array:
    """Forces (steps, rows, columns) in N that press on the taxels of a jaw.

    Raises
    ------
    InputError
        If the run has no taxels.
    """
    forces = {place: outcome.history[name] for place, name in taxel_columns(side).items() if name in outcome.history}
    if not forces:
        raise InputError(f"{outcome.id} has no taxels of the {side} jaw")
    return np.array(list(forces.values())).reshape(*max(forces), -1).transpose(2, 0, 1)


def _taxels_at(inputs: Inputs, study: str, run: str, side: str, *, closing: float | None = None) -> Array:
    """Forces (rows, columns) in N on the taxels of a jaw at the end of a run, or at a closing in m that a step ended with."""
    outcome = inputs.converged(study, run)
    forces = taxel_history(outcome, side)
    if closing is None:
        return forces[-1]
    away = np.abs(np.array(outcome.history["displacement"]) - closing)
    if away.min() > CLOSE * closing:
        raise InputError(f"no step of {study}, {run} ended at a closing of {format_quantity(closing, 'm')}")
    return forces[int(away.argmin())]


def _force_on(forces: Array, taxel: Taxel) -> float:
    """The force in N on a taxel."""
    row, column = taxel
    if not (1 <= row <= forces.shape[0] and 1 <= column <= forces.shape[1]):
        raise InputError(f"taxel {row}, {column} of a matrix of {forces.shape[0]} rows and {forces.shape[1]} columns")
    return float(forces[row - 1, column - 1])


@quantity(unit="1")
def taxel_asymmetry(
    inputs: Inputs, study: StudyName, run: RunName, mirror: Literal["left_right", "front_back", "upper_lower"]
) -> float:
    """Largest difference of mirrored taxels over the largest force of a taxel, dimensionless.

    Parameters
    ----------
    mirror : columns, rows or jaws that are exchanged

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge or has no taxels.
    """
    forces = np.stack([_taxels_at(inputs, study, run, side) for side in JAWS])
    axis = {"upper_lower": 0, "front_back": 1, "left_right": 2}[mirror]
    return float(np.abs(forces - np.flip(forces, axis)).max() / np.abs(forces).max())


def _forces_on(
    inputs: Inputs, study: StudyName, runs: tuple[str, ...], *, side: str, taxel: Taxel, closing: float | None
) -> Array:
    """Force in N on a taxel in each of some runs, shape (runs,)."""
    if side == "upper less lower":
        upper, lower = (_forces_on(inputs, study, runs, side=jaw, taxel=taxel, closing=closing) for jaw in JAWS)
        return upper - lower
    return np.array([_force_on(_taxels_at(inputs, study, run, side, closing=closing), taxel) for run in runs])


def _comparable(change: str, runs: tuple[str, ...], bases: tuple[str, ...]) -> None:
    if len(bases) not in (0, 1, len(runs)):
        raise InvalidQuantity(f"{len(bases)} bases for {len(runs)} runs; give none, one, or one for each")
    if "base" in change and not bases:
        raise InvalidQuantity(f"change {change}: there is no base")
    if "along" in change and len(runs) < 2:
        raise InvalidQuantity(f"change {change}: one run makes no change")


@quantity(unit="N", check=_comparable)
def taxel_change(
    inputs: Inputs,
    study: StudyName,
    change: Literal["least along", "greatest along", "least from base", "greatest from base"],
    runs: Annotated[tuple[str, ...], Field(min_length=1)],
    bases: tuple[str, ...] = (),
    *,
    side: JawOrDifference = "upper",
    taxel: Taxel = (2, 2),
    closing: Length | None = None,
) -> float:
    """Least or greatest change of the force in N on a taxel from simulation to simulation.

    ``along`` compares each run with the one before it, the force of its base taken off; ``from base`` each with its base.
    A claim that the force rises holds if the least change is positive; that it falls, if the greatest is negative.

    Parameters
    ----------
    change : which of the changes
    runs : runs in the order of the change
    bases : runs without the inclusion: one for each run (on the same mesh, whose error is then taken off), or one for all
    side : jaw, or the difference of both
    taxel : row and column, counted from 1
    closing : closing of each jaw at an accepted step; by default the last

    Raises
    ------
    InvalidQuantity
        If the runs and bases do not make such a change.
    UnknownName, InputError
        If there is no such run, or one did not converge, has no such taxel, or no step that ended at the closing.
    """
    _comparable(change, runs, bases)
    forces = partial(_forces_on, inputs, study, side=side, taxel=taxel, closing=closing)
    excess = forces(runs) - (forces(bases) if bases else 0.0)
    changes = excess if "base" in change else np.diff(excess)
    return float(changes.min() if "least" in change else changes.max())


@quantity(unit="N")
def taxel_contrast(
    inputs: Inputs,
    study: StudyName,
    run: RunName,
    *,
    side: JawName = "lower",
    taxel: Taxel,
    others: Annotated[tuple[Taxel, ...], Field(min_length=1)],
) -> float:
    """Greatest difference in N of the force on a taxel from that on any of some others: negative if it reads less than each.

    Parameters
    ----------
    side : jaw
    taxel : row and column, counted from 1
    others : rows and columns of those that it is compared with

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge or has no such taxel.
    """
    forces = _taxels_at(inputs, study, run, side)
    return max(_force_on(forces, taxel) - _force_on(forces, other) for other in others)


@quantity(unit="N")
def taxel_pulse(inputs: Inputs, study: StudyName, run: RunName, start: NonNegative[Time]) -> float:
    """Largest difference in N between the greatest and the least force of a taxel, over all taxels of both jaws, from a time on.

    Parameters
    ----------
    start : time at which the pulse begins

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge, has no taxels, or fewer than two steps from this time on.
    """
    outcome = inputs.converged(study, run)
    beating = np.array(outcome.history["time"]) >= start * (1 - CLOSE)
    if beating.sum() < 2:
        raise InputError(f"{run} has {beating.sum()} steps from {start:g} s on; a change needs two")
    return max(float(np.ptp(taxel_history(outcome, side)[beating], axis=0).max()) for side in JAWS)


@quantity(unit="1")
def taxel_count(inputs: Inputs, case: str) -> float:
    """Taxels of both jaws of a grasp.

    Parameters
    ----------
    case : case file, relative to the table

    Raises
    ------
    CaseError, StorageError
        If the case is refused or cannot be read.
    InputError
        If it is no grasp.
    """
    grasp = load_case(inputs.folder / case).experiment
    if not isinstance(grasp, Grasp):
        raise InputError(f"{case} is no grasp")
    return float(len(JAWS) * grasp.matrix.rows * grasp.matrix.columns)


@drawing
def taxel_maps(inputs: Inputs, title: Title, studies: Annotated[tuple[str, ...], Field(min_length=1)]) -> Data:
    """Form ``maps``: the forces in N on the taxels of both jaws at the end of the first run of each study, row 1 below.

    Parameters
    ----------
    studies : studies of the table from left to right

    Raises
    ------
    UnknownName, InputError
        If there is no such study, or its run did not converge or has no taxels.
    """

    def forces(study: str, side: str) -> list[list[float]]:
        return _taxels_at(inputs, study, inputs.study(study)[0].id, side).tolist()

    columns = [
        {"title": study.replace("figure_", "Fig. ").replace("_", "."), **{s: forces(study, s) for s in JAWS}} for study in studies
    ]
    return {"form": "maps", "title": title, "unit": "N", "columns": columns}


@drawing
def tactile_pictures(
    inputs: Inputs,
    title: Title,
    study: StudyName,
    pictures: Literal["views", "layers"],
    *,
    reference: StudyName | None = None,
    shape: tuple[int, int] = SHAPE,
    layers: Annotated[int, Field(ge=2, le=9)] = 5,
) -> Data:
    """Form ``images``: what both matrices read at the end of the first run of a study, as the display of section 6.3 draws it.

    Parameters
    ----------
    pictures : front, left and top view, or the 3D image cut at equal depths from the upper jaw to the lower
    reference : study of plain tissue, whose readings are taken off: without that, tissue under even jaws is all that is seen
    shape : rows and columns of each picture
    layers : cuts of the 3D image

    Raises
    ------
    UnknownName, InputError
        If there is no such study, or its run did not converge or has no taxels.
    """

    def read(name: str) -> Array:
        return np.stack([_taxels_at(inputs, name, inputs.study(name)[0].id, side) for side in JAWS])

    forces = read(study) if reference is None else np.maximum(read(study) - read(reference), 0.0)
    if pictures == "views":
        seen = views(forces, shape)
        images = {"front view, upper jaw above": seen.front, "left view, the back at the left": seen.left, "top view": seen.top}
    else:
        cuts = volume(forces, (layers, *shape))[:, ::-1]  # the back above, as in the top view
        depths = [
            f"{round(100 * k / (layers - 1))} % of the thickness below the upper jaw, seen from above" for k in range(layers)
        ]
        images = dict(zip(depths, cuts, strict=True))
    largest = {words: float(image.max()) for words, image in images.items()}
    common = max(largest.values()) if pictures == "layers" else None  # layers are compared, views are not
    panels = [
        {
            "title": f"{words}; white is {format_quantity(float(f'{common or largest[words]:.3g}'), 'N')}",
            "grey": band_intensities(image, common or largest[words] or 1.0).tolist(),
        }
        for words, image in images.items()
    ]
    return {"form": "images", "title": title, "axis": "pixel", "panels": panels}
