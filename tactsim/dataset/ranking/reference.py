"""The tissue without a lump that estimators compare with: what the taxels feel on it at any closing."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.experiments.localization.source import SAME_CLOSING, readings_of, reference_notes, stored_grasp
from tactsim.interfaces.both_jaws import TAXEL_FORCE, jaws_over_time, over_time
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.results import Result
from tactsim.units import format_quantity


@dataclass(frozen=True, eq=False)
class PlainGrasp:
    """The tissue without a lump, closed step by step: what the taxels feel at any closing, and what sensors make of it.

    Attributes
    ----------
    closings : (n,) ascending in m, the first 0
    forces : (n, jaw, row, column) in N
    readings : of its last step, with layout, block and middle
    scene : the block between the jaws
    folder : of the result that closes the furthest
    """

    closings: Array
    forces: Array
    readings: Readings
    scene: GraspScene
    folder: str = ""

    @classmethod
    def of_results(cls, folders: Sequence[str]) -> PlainGrasp:
        """From the folders of grasps without a lump: every step of one, or the last steps of several.

        A result that was closed in the same steps as the samples shares their errors of friction; several of them are several
        closings. Those with an inclusion are warned of.

        Raises
        ------
        StorageError
            If there is no result.
        InputError
            If they differ in block or matrix, or do not close from step to step or result to result.
        """
        if not folders:
            raise InputError("no reference; needed: the folder of a grasp of the tissue without a lump")
        results = [stored_grasp(folder) for folder in folders]
        readings = [readings_of(result, noise=0.0) for result in results]
        for result in results:
            warn_of_inclusions(result)
        histories = [(over_time(result, "displacement"), jaws_over_time(result, TAXEL_FORCE)) for result in results]
        order = [0]
        if len(folders) > 1:
            histories = [(closings[-1:], forces[-1:]) for closings, forces in histories]
            order = np.argsort([closings[-1] for closings, _ in histories]).tolist()
            histories, readings = [histories[k] for k in order], [readings[k] for k in order]
        for other in readings[:-1]:
            check_same(other.block_size, other.layout, readings[-1], "one reference")
        closings, forces = (np.concatenate(parts) for parts in zip(*histories, strict=True))
        if len(closings) < 2 or not (np.diff(closings, prepend=0.0) > 0).all():
            known = ", ".join(format_quantity(float(closing), "m") for closing in closings)
            raise InputError(
                f"the reference is known at closings of {known}; needed: two or more, rising: a plain grasp closed in "
                "several steps (time: {steps: 12}), or several results"
            )
        begun = np.concatenate([[0.0], closings]), np.concatenate([np.zeros_like(forces[:1]), forces])
        return cls(*begun, readings[-1], results[order[-1]].scene_as(GraspScene), folders[order[-1]])

    def at(self, closing: Array | float) -> Array:
        """Forces (..., jaw, row, column) in N at closings in m, by monotone cubic interpolation.

        Raises
        ------
        InputError
            If a closing is negative, no number, or beyond the last of the reference.
        """
        wanted, most = np.asarray(closing, dtype=float), float(self.closings[-1])
        within = (wanted >= 0) & (wanted <= most * (1 + SAME_CLOSING))
        if not within.all():
            refused = format_quantity(float(np.atleast_1d(wanted[~within])[0]), "m")
            raise InputError(
                f"a sample closes by {refused}, the reference from 0 to {format_quantity(most, 'm')}; "
                "needed: a reference that closes at least as far as every sample"
            )
        return scipy.interpolate.PchipInterpolator(self.closings, self.forces, axis=0)(np.minimum(wanted, most))


def warn_of_inclusions(reference: Result) -> None:
    """A warning of a reference that holds what is looked for, such as the grasp itself by a slip of the hand."""
    for note in reference_notes(reference.scene_as(GraspScene).true_inclusions):
        warnings.warn(note, stacklevel=3)


def check_same(size: Array, layout: TaxelLayout, reference: Readings, whose: str) -> None:
    """Refuse a reference of another block, ``size`` (3,) in m, or matrix than ``whose``.

    Raises
    ------
    InputError
        Naming what differs.
    """
    if not np.allclose(size, reference.block_size, rtol=1e-9):
        measured = [" x ".join(format_quantity(float(side), "m") for side in block) for block in (size, reference.block_size)]
        raise InputError(f"the block of {whose} measures {measured[0]}, that of the reference {measured[1]}; needed: the same")
    if layout != reference.layout:
        given, other = layout.in_words, reference.layout.in_words
        raise InputError(f"the matrix of {whose} has {given}, that of the reference {other}; needed: the same")
