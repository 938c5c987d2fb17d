"""A grasp as figures, page, data sets and localization see it: block, inclusions, jaws in their places, taxels."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator

from tactsim.array import Array
from tactsim.contact.jaw import Jaw
from tactsim.errors import StorageError
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.interfaces import Inclusion
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.mesh.any_inclusion import AnyInclusion, inclusion_name
from tactsim.model import FrozenModel
from tactsim.results.axes import centred
from tactsim.results.quantity import Coordinate
from tactsim.results.scene import Scene, SolverReport

Point = tuple[float, float, float]


def _of_both_jaws(value: dict[str, Any]) -> dict[str, Any]:
    if value.keys() != set(JAWS):
        raise ValueError(f"an entry for each of {', '.join(sorted(value))}; needed: for each of {', '.join(JAWS)}")
    return value


BothJaws = AfterValidator(_of_both_jaws)


class ChangedShape(StorageError):
    """The file of a shape holds another one than was grasped."""


class EmbeddedShape(FrozenModel):
    """An inclusion of the block."""

    shape: AnyInclusion
    """Its shape and place."""
    unlike_tissue: bool
    """Whether its material is another than that of the tissue, so that it can be felt."""
    file_content: str | None = None
    """Of the shape when it was grasped (`Inclusion.file_content`); None in results that do not know it."""

    def check_unchanged(self, name: str) -> None:
        """Refuse a shape that its file no longer holds, which would stand for the truth with forces of another.

        Raises
        ------
        ChangedShape
            If the file has changed since.
        StorageError
            If it cannot be read.
        """
        if self.file_content is not None and self.file_content != self.shape.file_content():
            raise ChangedShape(f"{name}: its file has changed since it was grasped; bring it back, or run the grasp again")


class GraspScene(Scene):
    """The block in its undeformed form, which begins at the origin, and the jaws at the last accepted step."""

    block_size: Point
    """Along x, y and z in m."""
    inclusions: tuple[EmbeddedShape, ...]
    """In the order of the case."""
    jaws: Annotated[dict[str, Jaw], BothJaws]
    """By side."""
    jaw_places: Annotated[dict[str, Point], BothJaws]
    """Place in m of the middle of each jaw's face."""
    matrix: TaxelLayout
    """Taxels on each jaw."""

    @property
    def size(self) -> Array:
        """Size (3,) of the undeformed block in m."""
        return np.array(self.block_size)

    @property
    def places(self) -> Array:
        """Place (2, 3) in m of the middle of each jaw's face, the upper jaw first."""
        return np.array([self.jaw_places[side] for side in JAWS])

    def place(self, side: str) -> Array:
        """Place (3,) in m of the middle of a jaw's face."""
        return self.places[JAWS.index(side)]

    @property
    def middle(self) -> Array:
        """Middle (2,) of both matrices in m, along x and y."""
        return self.places[:, :2].mean(axis=0)

    @property
    def true_inclusions(self) -> tuple[Inclusion, ...]:
        """The inclusions but those that are nothing but tissue.

        Raises
        ------
        StorageError
            If the file of a shape has changed since it was grasped, or cannot be read.
        """
        for number, one in enumerate(self.inclusions, 1):
            one.check_unchanged(inclusion_name(number, one.shape))
        return tuple(one.shape for one in self.inclusions if one.unlike_tissue)

    def named_inclusion(self, number: int) -> str:
        """What the inclusion of a number, counted from 1, is called, such as "sphere 1"."""
        if number > len(self.inclusions):
            return f"inclusion {number}"
        return inclusion_name(number, self.inclusions[number - 1].shape)

    def coordinates(self, quantity: str) -> dict[str, Coordinate]:
        """The middles of rows and columns of the jaw that the quantity's name ends with; of both if it names none."""
        x, y, _ = next((self.place(side) for side in JAWS if side in quantity.split("_")), np.append(self.middle, 0))
        rows, columns = self.matrix.borders("y"), self.matrix.borders("x")
        return {
            "row": centred("row", rows, y, "y of the middle of the taxels, from the front"),
            "column": centred("column", columns, x, "x of the middle of the taxels"),
        }

    def borders(self, along: str, side: str | None = None) -> Array:
        """Lower and upper border (n, 2) in mm of every column ("x") or row ("y") of taxels on a jaw, or between both."""
        middle = self.middle if side is None else self.place(side)
        return 1e3 * (self.matrix.borders(along) + middle["xy".index(along)])


def untouched_scene(setup: GraspSetup) -> GraspScene:
    """The scene of a grasp whose jaws touch the block but do not press it."""
    size, tissue, places = setup.block.size, setup.block.tissue, {}
    for side, height in zip(JAWS, (size[2], 0.0), strict=True):
        along, across = getattr(setup, side).middle(size).tolist()
        places[side] = (along, across, height)
    return GraspScene(
        kind="grasp",
        block_size=size,
        inclusions=tuple(EmbeddedShape(shape=one.shape, unlike_tissue=one.unlike(tissue)) for one in setup.inclusions),
        jaws={side: setup.jaw(side) for side in JAWS},
        jaw_places=places,
        matrix=setup.matrix,
    )


class MeshReport(FrozenModel):
    """The mesh of a block."""

    content: str
    """Hash of what it was made from."""
    origin: str
    """Where it comes from."""
    least_quality: float
    """Quality of the worst element, 1 for a regular one."""
    mean_quality: float
    """Mean quality of the elements."""
    least_curvature: float | None
    """Least ratio of the volume at a point of a curved element to that of its straight form."""
    straightened_edges: int
    """Edges that are straight where the surface is curved, so that no element is folded."""
    volume_errors: tuple[float | None, ...]
    """Relative error of the volume of each region."""
    regions: tuple[str, ...]
    """Names of the regions."""


class SimulatedGrasp(GraspScene):
    """A grasp that was simulated."""

    kind: Literal["grasp"] = "grasp"
    solver: SolverReport
    """What the solution took."""
    mesh: MeshReport
    """The mesh."""
    control: Literal["displacement", "force"]
    """What of the jaws is prescribed."""
    moment: str = ""
    """The moment of forces and places in words, where it is not the last accepted step."""


class ReadGrasp(GraspScene):
    """A grasp whose matrices were read through sensors afterwards."""

    kind: Literal["matrix_readout"] = "matrix_readout"

    @classmethod
    def of(cls, grasp: GraspScene) -> ReadGrasp:
        """The same grasp."""
        return cls(**grasp_fields(grasp))


def grasp_fields(grasp: GraspScene) -> dict[str, object]:
    """What every scene of a grasp has, by name."""
    return {name: getattr(grasp, name) for name in GraspScene.model_fields if name != "kind"}
