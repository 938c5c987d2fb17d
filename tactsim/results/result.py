"""The result of an experiment as plain values, independent of how it was computed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, overload

import numpy as np

from tactsim.errors import INTERRUPTED, ConvergenceError, InputError, InvalidQuantity, StorageError, UnknownName, shown
from tactsim.presenter import presenter
from tactsim.results.axes import coordinates, dimensions
from tactsim.results.checked import checked_texts
from tactsim.results.quantity import Quantity
from tactsim.results.scene import Scene, UnreadableScene
from tactsim.units import is_unit

if TYPE_CHECKING:
    import pyvista
    import xarray
    from matplotlib.figure import Figure

AnyScene = TypeVar("AnyScene", bound=Scene)


class Status(StrEnum):
    """How a run ended; exit code, banner and data-set index derive from it."""

    CONVERGED = "converged"
    FAILED = "failed"
    INTERRUPTED = "interrupted"

    @property
    def exit_code(self) -> int:
        """Exit code of the command line."""
        return {"converged": 0, "failed": ConvergenceError.exit_code, "interrupted": INTERRUPTED}[self.value]


@dataclass(frozen=True)
class StepRecord:
    """One accepted step: its number, what it took, and the history values (name -> SI float) that it committed."""

    step: int
    newton_iterations: int
    residual: float
    values: dict[str, float]


def rows(units: Iterable[str], columns: Iterable[Iterable[float]]) -> tuple[StepRecord, ...]:
    """The history of what is computed without load steps: a record for each row of ``columns``, named as ``units`` are.

    Raises
    ------
    InvalidQuantity
        If there is not one column for each unit, or they are not of the same length.
    """
    names, lists = list(units), [list(map(float, column)) for column in columns]
    lengths = [len(column) for column in lists]
    if len(names) != len(lists) or len(set(lengths)) > 1:
        raise InvalidQuantity(
            f"a history of {', '.join(names)} has columns of the lengths {lengths}; needed: one each, equally long"
        )
    return tuple(
        StepRecord(number, 0, 0.0, dict(zip(names, values, strict=True)))
        for number, values in enumerate(zip(*lists, strict=True), 1)
    )


@dataclass(frozen=True)
class FieldFrame:
    """Fields at one accepted step, ``time`` in s, as meshio writes them.

    ``points`` (n, 3) in m, ``cells`` name -> connectivity, ``point_data`` and ``cell_data`` name -> array (unit in the name).
    """

    time: float
    points: np.ndarray
    cells: dict[str, np.ndarray]
    point_data: dict[str, np.ndarray]
    cell_data: dict[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """What a run computed.

    >>> import tactsim as ts
    >>> result = ts.load_case("annulus_dynamic_load", {"experiment.points": 20}).run()
    >>> str(result.status), f"{result['largest_force'].to('mN'):.0f}"
    ('converged', '450 mN')
    >>> result.history["force"].attrs["units"]
    'N'

    Attributes
    ----------
    kind : that of the experiment
    units : unit of every history value
    title : that of the case, empty without one
    scene : further data for later stages; see `scene_as`
    experiment : what was run; None if the result was loaded from disk
    provenance : the case with its id, versions, seeds and the identity of the code, where known

    Raises
    ------
    InvalidQuantity
        If something else than a quantity is among them, or one has an unknown unit, or if assumptions or warnings are no texts.
    """

    kind: str
    status: Status
    reason: str
    quantities: dict[str, Quantity] = field(default_factory=dict)
    assumptions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    timing: dict[str, float] = field(default_factory=dict)
    steps: tuple[StepRecord, ...] = ()
    units: dict[str, str] = field(default_factory=dict)
    frames: tuple[FieldFrame, ...] = ()
    title: str = ""
    scene: Scene | UnreadableScene | None = None
    experiment: Any = field(default=None, compare=False)
    provenance: Mapping[str, Any] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        for name in ("assumptions", "warnings"):
            object.__setattr__(self, name, checked_texts(getattr(self, name), f"{name} of a result of {self.kind}"))
        for name, one in self.quantities.items():
            if not isinstance(one, Quantity):
                raise InvalidQuantity(f"{name} is a {type(one).__name__}; needed: Quantity(value, unit, description)")
        for name, unit in [*((name, one.unit) for name, one in self.quantities.items()), *self.units.items()]:
            if not isinstance(unit, str) or not is_unit(unit):
                raise InvalidQuantity(
                    f"{name} has the unknown unit {shown(unit)}; needed: an SI unit as text, such as 'N', or '1'"
                )

    def __getitem__(self, name: str) -> Quantity:
        """A quantity by its name.

        Raises
        ------
        UnknownName
            With the nearest name.
        """
        if name not in self.quantities:
            of_what = "" if self.status is Status.CONVERGED else f" of this {self.status} run"
            raise UnknownName(f"quantity{of_what}", str(name), self.quantities)
        quantity = self.quantities[name]
        dims, shape = dimensions(name, quantity), quantity.numbers.shape
        placed = self.scene.coordinates(name) if isinstance(self.scene, Scene) else {}
        along = coordinates(self.quantities, placed, dict(zip(dims, shape, strict=True))) if dims else {}
        return replace(quantity, dims=dims, coordinates=along)

    def __contains__(self, name: object) -> bool:
        return name in self.quantities

    def __iter__(self) -> Iterator[str]:
        return iter(self.quantities)

    def __eq__(self, other: object) -> bool:
        """Whether every number, text and field is the same to the last bit; times that a run took count too."""
        return isinstance(other, Result) and all(
            identical(getattr(self, one.name), getattr(other, one.name)) for one in fields(self) if one.compare
        )

    __hash__ = None  # type: ignore[assignment]

    @property
    def early_end(self) -> str | None:
        """How the run ended before its end, such as ``"ended as failed (...)"``; None if it came to its end."""
        return None if self.status is Status.CONVERGED else f"ended as {self.status.value} ({self.reason})"

    @property
    def at_rest(self) -> bool:
        """Whether it shows what a run would begin with and nothing is computed: it has fields, and no step."""
        return bool(self.frames) and not self.steps

    @property
    def history(self) -> xarray.Dataset:
        """Every history value over the accepted steps, unit in ``attrs``, with what each step took.

        The times and displacements of the steps are coordinates, so that whatever is plotted or selected has them.
        """
        import xarray

        names = dict.fromkeys(name for record in self.steps for name in record.values)
        columns: dict[str, Any] = {
            name: ("step", self.history_values(name), {"units": self.units.get(name, "1")}) for name in names
        }
        columns["newton_iterations"] = ("step", [record.newton_iterations for record in self.steps], {"units": "1"})
        columns["residual"] = ("step", [record.residual for record in self.steps], {"units": "1"})
        attributes = {"kind": self.kind, "status": str(self.status), "title": self.title}
        history = xarray.Dataset(columns, {"step": [record.step for record in self.steps]}, attributes)
        return history.set_coords([name for name in ("time", "displacement") if name in names])

    def history_values(self, name: str) -> np.ndarray:
        """A history value at every accepted step, shape (steps,) in SI, NaN where a step has none."""
        return np.array([step.values.get(name, np.nan) for step in self.steps], dtype=float)

    def fields(self) -> pyvista.UnstructuredGrid:
        """The deformed body at the last kept state with its fields, their units in the names.

        Raises
        ------
        InputError
            If the run kept no fields.
        """
        mesh: pyvista.UnstructuredGrid = presenter().field_mesh(self)
        return mesh

    @overload
    def plot(self) -> dict[str, Figure]: ...

    @overload
    def plot(self, name: str) -> Figure: ...

    def plot(self, name: str | None = None) -> dict[str, Figure] | Figure:
        """One figure of the run by its name, or name -> `matplotlib.figure.Figure` of all of them, the main one first.

        Raises
        ------
        UnknownName
            If there is no such figure, with the names of those there are.
        """
        figures: dict[str, Figure] | Figure = presenter().figures(self, name)
        return figures

    def save(self, directory: str | Path, *, force: bool = False, fields: bool = True) -> Path:
        """Writes the folder that ``tactsim run`` writes and returns its path; `tactsim.load_result` reads it.

        Without ``fields`` the deformed bodies, most of what a folder holds, stay out of it; its figures are drawn with them.

        Raises
        ------
        StorageError
            If the place is taken (``force`` replaces an earlier result of tactsim), or cannot be written.
        InputError
            If the result was not run from a case or an experiment.
        """
        place: Path = presenter().save(self, directory, force=force, fields=fields)
        return place

    def _repr_html_(self) -> str:
        text: str = presenter().html(self)
        return text

    def __repr__(self) -> str:
        return f"<Result of {self.kind}: {self.status}, {len(self.steps)} steps, {len(self.quantities)} quantities>"

    def scene_as(self, model: type[AnyScene]) -> AnyScene:
        """The scene as a kind of scene.

        Raises
        ------
        StorageError
            If the stored scene cannot be read.
        InputError
            If the result has no scene, or another one.
        """
        if isinstance(self.scene, model):
            return self.scene
        if isinstance(self.scene, UnreadableScene):
            raise StorageError(self.scene.in_words)
        raise InputError(f"the result of {shown(self.kind)} holds no {model.__name__}")


def identical(one: Any, other: Any) -> bool:
    """Whether two plain values are the same to the last bit; NaN is NaN, and a list is a tuple or an array of the same."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(identical(one[key], other[key]) for key in one)
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.shape == other.shape and bool(((one == other) | ((one != one) & (other != other))).all())
    if isinstance(one, list | tuple | np.ndarray) and isinstance(other, list | tuple | np.ndarray):
        return len(one) == len(other) and all(map(identical, one, other))
    if is_dataclass(one) and type(one) is type(other):
        return all(identical(getattr(one, part.name), getattr(other, part.name)) for part in fields(one) if part.compare)
    if isinstance(one, float | np.floating) and isinstance(other, float | np.floating):
        return bool(one == other or (one != one and other != other))
    return bool(one == other)
