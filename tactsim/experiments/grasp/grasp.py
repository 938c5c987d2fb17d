"""A block of tissue with lumps and arteries between two jaws that carry matrices of force sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal, Self

from tactsim.experiments.grasp.history import UNITS
from tactsim.experiments.grasp.setup import Block, GraspSetup
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.materials.library import named_material
from tactsim.mechanics.models.block_source import StructuredSource
from tactsim.mechanics.paths.loading import close

if TYPE_CHECKING:
    from tactsim.experiments.grasp.record import GraspRecord
    from tactsim.mechanics.paths.history_path import TimedPath


class Grasp(GraspSetup, Experiment):
    """A block of tissue between two jaws with matrices of taxels.

    >>> import tactsim as ts
    >>> ball = ts.Sphere(center=("20 mm", "20 mm", "12 mm"), radius="4 mm")
    >>> grasp = ts.Grasp(
    ...     block=ts.Block(size=("40 mm", "40 mm", "20 mm"), tissue="icf_stable"),
    ...     inclusions=[ts.Embedded(shape=ball, material="lump")],
    ...     loading=ts.close(to="1 mm", duration="1 s"),
    ... )
    >>> grasp.extent  # of grasp.run(), which takes some seconds
    Extent(name='time', end=1.0)

    Source: thesis, sections 6.3 and 6.5.
    """

    kind: Literal["grasp"] = "grasp"

    history_units: ClassVar[dict[str, str]] = UNITS

    @classmethod
    def example(cls) -> Self:
        """A plain block on few elements, closed by 1 mm per jaw."""
        return cls(
            block=Block(tissue=named_material("icf_stable").material),
            loading=close(to=1e-3, duration=1.0),
            mesh=StructuredSource(kind="structured", cells=(4, 4, 2)),
        )

    @classmethod
    def starting_case(cls) -> Self:
        """The example on the default mesh."""
        example = cls.example()
        return cls(block=example.block, loading=example.loading)

    def doubts(self) -> list[str]:
        """Taxels beside the block, and sizes and materials that look like a wrong unit."""
        from tactsim.experiments.grasp.warnings import doubts

        return doubts(self)

    def begin(self) -> Course:
        """Close the jaws through the whole history; see ``GraspRecord`` for what is reported."""
        from tactsim.experiments.grasp.warnings import let_go

        path, record = self._begun()
        steps = (record.accept(state) for state, _ in path.states())
        return Course(steps, record.findings, setup_is_timed=True, advice=lambda error: let_go(record.steps))

    def unloaded(self) -> Findings:
        """The block between jaws that just touch it."""
        path, record = self._begun()
        return record.unloaded(path.start)

    def _begun(self) -> tuple[TimedPath, GraspRecord]:
        """The path at its start, and what will record it."""
        from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
        from tactsim.experiments.grasp.path import grasp_path
        from tactsim.experiments.grasp.record import GraspRecord

        sourced = grasp_mesh(self)
        model = grasp_model(self, sourced)
        path = grasp_path(self, model)
        return path, GraspRecord(self, model, sourced, path)
