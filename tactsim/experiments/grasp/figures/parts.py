"""What the figures of a grasp need of its result: its scene, and the pressures and forces of the taxels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import Normalize

from tactsim.array import Array
from tactsim.experiments.grasp.scene import GraspScene, SimulatedGrasp
from tactsim.interfaces.both_jaws import TAXEL_FORCE, TAXEL_PRESSURE, jaws_at_end
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import scale_of
from tactsim.plotting.plane_cut import regions_of
from tactsim.results import FieldFrame, Result
from tactsim.units import format_quantity

TITLE, WHERE = "Grasp", "; the last accepted step is shown"
"""Title of a grasp without one, and what is said of one that did not end as it should."""
LETTERS = {"upper": "U", "lower": "L"}
"""How the thesis's Fig. 6.3 calls the taxels of each jaw."""
READ_IN_NEWTONS = 0.01
"""Force in N on the taxel that carries most from which on forces are written in N."""
TAXEL_COLOUR = "#e69f00"
USUAL_SIDE = 40e-3
"""Longest side in m of a block in whose pictures lengths are drawn as they are given."""


def drawn_millimetre(size: Array) -> float:
    """Length in mm that is drawn for a millimetre around a block of sides (3,) in m: in proportion to its longest one."""
    return float(np.max(size)) / USUAL_SIDE


@dataclass(frozen=True)
class PressureScale:
    """The unit in which the pressures of taxels are shown, the factor from Pa to it, and the ends of their colours in it."""

    factor: float
    unit: str
    norm: Normalize


@dataclass(frozen=True)
class LoadedTaxels:
    """The taxels of a grasp in one state.

    Attributes
    ----------
    scene : block and jaws, where they are then
    pressures : (rows, columns) in Pa of the taxels, by side
    forces : (rows, columns) in N that press into the taxels, by side
    """

    scene: GraspScene
    pressures: Mapping[str, Array]
    forces: Mapping[str, Array]

    @property
    def force_scale(self) -> tuple[float, str]:
        """Factor and unit in which the force on all taxels of a jaw reads well."""
        return scale_of(max(float(np.abs(self.forces[side].sum())) for side in JAWS), "N")

    @property
    def taxel_force_scale(self) -> tuple[float, str]:
        """Factor and unit in which the largest force on any taxel reads well; from 10 mN on it is N."""
        largest = max(float(np.max(self.forces[side])) for side in JAWS)
        return (1.0, "N") if READ_IN_NEWTONS <= largest < 1e3 else scale_of(largest, "N")

    @property
    def largest_pressure(self) -> float:
        """Largest pressure in Pa on any taxel, and never zero, so that a scale can end there."""
        return max(1e-12, *(float(np.max(self.pressures[side])) for side in JAWS))

    @property
    def smallest_pressure(self) -> float:
        """Smallest pressure in Pa on any taxel, at most zero."""
        return min(0.0, *(float(np.min(self.pressures[side])) for side in JAWS))

    @property
    def pressure_scale(self) -> PressureScale:
        """One scale for the taxels of both jaws."""
        factor, unit = scale_of(self.largest_pressure, "Pa")
        return PressureScale(factor, unit, Normalize(factor * self.smallest_pressure, factor * self.largest_pressure))


def loaded_taxels(result: Result) -> LoadedTaxels:
    """The taxels at the last accepted step, or at the moment that the scene names.

    Raises
    ------
    InputError
        If the result does not hold pressures and forces of taxels as numbers in arrays of one shape.
    """
    pressures, forces = (dict(zip(JAWS, jaws_at_end(result, name), strict=True)) for name in (TAXEL_PRESSURE, TAXEL_FORCE))
    return LoadedTaxels(result.scene_as(GraspScene), pressures, forces)


def ending(result: Result) -> str:
    """What is shown in words: how far the jaws have closed, and which moment it is if not the last."""
    closing, moment = result.quantities["displacement"].value, moment_of(result)
    return f"each jaw closed by {format_quantity(float(closing), 'm')}" + (f"; {moment}" if moment else "")


def moment_of(result: Result) -> str:
    """The moment that is shown in words, empty if it is the last accepted step."""
    return result.scene.moment if isinstance(result.scene, SimulatedGrasp) else ""


def named_lines(count: int, *, every: bool) -> list[int]:
    """Numbers of the rows or columns of taxels that are named: all if there is room, else the first and the last."""
    return list(range(1, count + 1)) if every else sorted({1, count})


def inclusions_of(frame: FieldFrame) -> dict[int, Array]:
    """Numbers (n,) of the nodes of every inclusion, by its number."""
    regions, elements = regions_of(frame), frame.cells["tetra10"]
    return {int(k): np.unique(elements[regions == k]) for k in np.unique(regions) if k > 0}
