"""Stress in the section of simulated indentations, at the threshold: thesis, Fig. 3.9."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.case import load_case
from tactsim.errors import InputError
from tactsim.experiments.indentation.scene import PressedBodyScene
from tactsim.interfaces import drawing
from tactsim.interfaces.run import returned_by, run_within_another
from tactsim.model import FrozenModel
from tactsim.results import Result, Status
from tactsim.results.fields import AXIAL_STRESS, DISPLACEMENT
from tactsim.units import format_quantity
from tactsim.validation.curves import Data, Title
from tactsim.validation.inputs import Inputs
from tactsim.validation.study import Override, overrides


class DrawnSection(FrozenModel):
    """An indentation whose section is drawn, run when the figure is made: the outcomes of studies hold no fields."""

    title: str
    """Words above the panel."""
    case: str
    """Case file, relative to the table."""
    set: dict[str, Override] = {}
    """Key path in the case -> value, as with ``tactsim run --set``."""


@drawing
def section_stresses(inputs: Inputs, title: Title, sections: Annotated[tuple[DrawnSection, ...], Field(min_length=1)]) -> Data:
    """Form ``sections``: the normal stress along the axis in Pa of deformed sections at the end of indentations by an annulus.

    Parameters
    ----------
    sections : indentations, a panel each

    Raises
    ------
    CaseError, StorageError
        If a case is refused or cannot be read.
    InputError
        If one is no indentation of a section by an annulus, or did not converge.
    """
    panels = []
    for one in sections:
        result = returned_by(run_within_another(load_case(inputs.folder / one.case, overrides(one.set)).experiment))
        panels.append(section_panel(result, one.title))
    return {"form": "sections", "title": title, "unit": "Pa", "label": "normal stress along the axis", "panels": panels}


def section_panel(result: Result, title: str) -> Data:
    """A panel of ``sections``: triangles of the deformed section in m, the stress of each in Pa, face and inner sensor as lines.

    Raises
    ------
    InputError
        If the result is not that of an indentation by an annulus which converged, with the fields of a section.
    """
    scene = result.scene
    if result.status is not Status.CONVERGED:
        raise InputError(f"{title} did not converge: {result.reason}")
    if not (isinstance(scene, PressedBodyScene) and scene.body.contact_shape.hole and result.frames):
        raise InputError(f"{title} is no indentation by an annulus")
    frame = result.frames[-1]
    if AXIAL_STRESS not in frame.cell_data:
        raise InputError(f"{title} is no indentation of a section")
    moved = float(result.quantities["displacement"].value)
    face, shape = scene.starting_height - moved, scene.body.contact_shape
    lines = [[[shape.hole, face], [shape.reach, face]]]
    if scene.recess is not None:
        lines.append([[0.0, face + scene.recess], [shape.hole, face + scene.recess]])
    places = (frame.points + frame.point_data[DISPLACEMENT])[:, :2]
    return {
        "title": f"{title}: {format_quantity(moved, 'm')}",
        "points": places.tolist(),
        "triangles": frame.cells["triangle6"][:, :3].tolist(),
        "values": np.asarray(frame.cell_data[AXIAL_STRESS]).ravel().tolist(),
        "lines": lines,
    }
