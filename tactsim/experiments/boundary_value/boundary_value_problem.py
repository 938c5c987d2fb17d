"""A boundary value problem of a body of one or several materials."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, Self

from tactsim.experiments.boundary_value.asked import AskedForce, AskedStress, unit_of
from tactsim.experiments.boundary_value.conditions import ClampCondition, DisplacementCondition
from tactsim.experiments.boundary_value.geometry import BlockGeometry, Span
from tactsim.experiments.boundary_value.motions import motions_of
from tactsim.experiments.boundary_value.rigid_motions import free_motions, in_words
from tactsim.experiments.boundary_value.setup import RECORDED, BoundaryValueSetup
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.progress import Extent


def _history_units(problem: BoundaryValueProblem) -> dict[str, str]:
    """Unit of every value that a step records."""
    return RECORDED | {name: unit_of(one, problem.dimension) for name, one in problem.asked.items()}


class BoundaryValueProblem(BoundaryValueSetup, Experiment):
    """A body of a simple shape under what is prescribed on its faces, and the numbers that are asked of it.

    >>> import tactsim as ts
    >>> disc = ts.BoundaryValueProblem(
    ...     dimension="axisymmetric",
    ...     geometry={"kind": "cylinder", "radial": [{"length": "5 mm", "cells": 1}], "axial": [{"length": "4 mm", "cells": 1}]},
    ...     material=ts.NeoHookean(c10="10 kPa"),
    ...     conditions=[
    ...         {"kind": "displacement", "face": "bottom", "z": 0.0},
    ...         {"kind": "displacement", "face": "top", "z": "-1 mm"},
    ...     ],
    ...     asked={"force": {"kind": "force", "face": "top", "component": "z"}},
    ... )
    >>> f"{disc.run()['force'].to('N'):.3f}"  # pi r^2 2 c10 (l - 1 / l^2) at the stretch l = 3/4
    '-1.614 N'
    """

    kind: Literal["boundary_value_problem"] = "boundary_value_problem"

    # The units follow from what is asked for, so that they replace the fixed ones of the interface.
    history_units: ClassVar[Any] = property(_history_units)

    @classmethod
    def example(cls) -> Self:
        """A block of rubber between glued plates, sheared by half its height in plane strain."""
        span = (Span(length=10e-3, cells=4),)
        return cls(
            dimension="plane_strain",
            geometry=BlockGeometry(x=span, y=span),
            material=MooneyRivlin2(c10=1e5, c01=0.25e5),
            conditions=(
                ClampCondition(kind="clamped", face="bottom"),
                DisplacementCondition(kind="displacement", face="top", x=5e-3, y=0.0),
            ),
            asked={
                "shear_force": AskedForce(kind="force", face="top", component="x"),
                "shear_stress": AskedStress(kind="stress", at=(5e-3, 5e-3), component="xy"),
            },
        )

    def begin(self) -> Course:
        """Follow the amplitudes to their end."""
        from tactsim.experiments.boundary_value.record import boundary_value_course

        return boundary_value_course(self)

    def unloaded(self) -> Findings:
        """The body, and the rigid bodies at first touch."""
        from tactsim.experiments.boundary_value.record import unloaded_problem

        return unloaded_problem(self)

    def doubts(self) -> list[str]:
        """A material without compiled form, and whether nothing but rigid bodies holds the body against some motion."""
        from tactsim.fem.assembly.material_forms import interpreted_warnings

        return [*interpreted_warnings(self.materials), *self._arbitrary_motions()]

    def _arbitrary_motions(self) -> list[str]:
        """Motions that nothing but rigid bodies holds."""
        if not self.contacts:
            return []  # a body that is free then is refused
        parts = self.parts
        if not (free := free_motions(parts, motions_of(parts, self.conditions))):
            return []
        return [
            f"nothing but rigid bodies holds the body against {in_words(free)}: where they do not, without friction or before "
            "they touch, such displacements are arbitrary; prescribe one of a face or a point"
        ]

    @property
    def extent(self) -> Extent:
        """The time."""
        return Extent("time", self.duration)
