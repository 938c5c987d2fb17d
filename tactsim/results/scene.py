"""What later stages read of a run beside its quantities and history: a typed model for each kind of experiment."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import ValidationError

from tactsim.errors import TactsimError, shown
from tactsim.kind import Kind
from tactsim.model import FrozenModel
from tactsim.outside.text import one_line
from tactsim.refusals import first_fault
from tactsim.registry import kind_class
from tactsim.results.quantity import Coordinate

EARLIER = "it was written by an earlier version of tactsim (schema_version 1), which described it in another form"


class Scene(Kind):
    """What a kind of experiment reports for figures, data sets and later experiments; lengths and all else in SI.

    Subclass it in the module ``scene`` of the folder of that kind, with the kind as default.
    """

    package: ClassVar[str] = "tactsim.experiments"
    modules: ClassVar[str] = r"\w+\.scene"

    @property
    def disc_share(self) -> float:
        """Area that a pressure is taken over, over that of the full disc of its outer radius: 1 for a body without a hole."""
        return 1.0

    def coordinates(self, quantity: str) -> dict[str, Coordinate]:
        """What lies along the axes of a quantity of the result, by name, where its quantities do not hold it."""
        return {}


class SolverReport(FrozenModel):
    """What a solution by finite elements took: for diagnosis, not for later stages."""

    unknowns: int
    """Number of unknowns of the model."""
    elements: int
    """Number of its elements."""
    linear_solver: str
    """Name of the linear solver."""
    rejected_steps: int
    """Steps that did not converge and were repeated with a smaller length."""
    newton_iterations: int
    """Newton iterations of all accepted steps."""
    mesh_adaptations: int = 0
    """How often the mesh was adapted."""

    @property
    def size_in_words(self) -> str:
        """Elements and unknowns, as a picture of the mesh names them."""
        return f"{self.elements} elements, {self.unknowns} unknowns"


@dataclass(frozen=True)
class UnreadableScene:
    """A stored scene that cannot be read, the reason, and what to do."""

    reason: str
    remedy: str = "run the case again"

    @property
    def in_words(self) -> str:
        """That it cannot be read, why, and what to do."""
        return f"the scene of the result cannot be read: {self.reason}; {self.remedy}"


def read_scene(kind: str, described: Any) -> Scene | UnreadableScene | None:
    """The scene of an experiment of a kind, from the mapping that `written_scene` made; None from None."""
    if described is None:
        return None
    try:
        model = kind_class(Scene, str(described.get("kind", kind)))
        scene: Scene = model.model_validate_json(json.dumps(described), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        if first["type"] == "union_tag_invalid":
            place = ".".join(map(str, ("scene", *first["loc"])))
            unknown = f"{one_line(place)}: the kind {shown(first['ctx']['tag'])} is not known here"
            return UnreadableScene(unknown, "import the module that defines it first, or run the case again")
        return UnreadableScene(f"scene.{first_fault(error)}")
    except (TactsimError, ArithmeticError) as error:
        return UnreadableScene(f"scene: {one_line(error)}")
    return scene


def written_scene(scene: Scene, kind: str) -> dict[str, Any]:
    """The scene as plain JSON values, without its kind if that is the result's: a user's subclass has the scene of its base."""
    return scene.model_dump(mode="json", exclude={"kind"} if scene.kind == kind else set())
