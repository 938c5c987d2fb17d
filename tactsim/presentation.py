"""What a result shows of itself and how it is kept: figures, fields for pyvista, HTML for a notebook, its folder on disk."""

from __future__ import annotations

import html as markup
import warnings
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactsim.case.model import SCHEMA, Case
from tactsim.case.writing import case_text
from tactsim.errors import InputError, UnknownName
from tactsim.interfaces import Experiment
from tactsim.interfaces.drawing import begin_all
from tactsim.outside.files import named_path
from tactsim.outside.text import one_line
from tactsim.plotting import figures_for
from tactsim.plotting.canvas import Figures, checked_figure, picture
from tactsim.plotting.drawn import rendered_figures
from tactsim.results import Quantity, Result, read_result, write_result
from tactsim.results.quantity import format_values

if TYPE_CHECKING:
    import pyvista
    from matplotlib.figure import Figure

CELL_TYPES = {"triangle": "TRIANGLE", "triangle6": "QUADRATIC_TRIANGLE", "tetra": "TETRA", "tetra10": "QUADRATIC_TETRA"}
"""Name of cells in a frame, as meshio has it -> as VTK has it."""
LONGEST_TABLE = 12
"""Quantities that a notebook lists at once; the others unfold."""
ANSWER = "threshold_pressure"
"""What a run that has it was made for: it stands first."""


def load_result(directory: str | Path) -> Result:
    """The result in a folder that `Result.save` or ``tactsim run`` wrote, fields included.

    >>> import tactsim as ts
    >>> result = ts.ClosedForm.example().run()
    >>> ts.load_result(result.save("pressed")) == result
    True

    Raises
    ------
    StorageError
        If a file is missing, damaged, or of a newer version of tactsim.
    InputError
        If the directory is neither a path nor a text.
    """
    return read_result(named_path(directory, "the folder of a result")).complete


def figures(result: Result, name: str | None = None) -> dict[str, Figure] | Figure:
    """One figure of a result by its name, or name -> figure of all of them, the main one first.

    Raises
    ------
    UnknownName
        If there is no such figure, with the names of those there are.
    InvalidQuantity
        If what draws a figure of a kind of one's own returns something else.
    """
    drawings: dict[str, Any] = {Path(file).stem: draw for file, draw in figures_for(result).items()}
    if name is None:
        begin_all(drawings.values())
        return Figures({stem: checked_figure(draw.figure(), stem) for stem, draw in drawings.items()})
    if name not in drawings:
        raise UnknownName("figure", str(name), drawings)
    return checked_figure(drawings[name].figure(), name)


def field_mesh(result: Result) -> pyvista.UnstructuredGrid:
    """The deformed body at the last kept state with its fields.

    Raises
    ------
    InputError
        If the run kept no fields.
    """
    if not result.frames:
        raise InputError(f"the result of {result.kind} holds no fields; a case keeps them with output: {{fields: all}}")
    import pyvista

    frame = result.frames[-1]
    cells = {getattr(pyvista.CellType, CELL_TYPES[name]): corners for name, corners in frame.cells.items()}
    grid = pyvista.UnstructuredGrid(cells, frame.points)
    grid.point_data.update(frame.point_data)
    grid.cell_data.update(frame.cell_data)
    return grid


def save(result: Result, directory: str | Path, *, force: bool = False, fields: bool = True) -> Path:
    """Write the folder of a result, its fields only if they are asked for, and return its path.

    A figure that cannot be drawn is left out, with a warning here and in the folder.

    Raises
    ------
    InputError
        If the result was not run from a case or an experiment.
    StorageError
        If the place is taken or cannot be written.
    """
    place = named_path(directory, "the folder of a result")
    origin = result.provenance
    if not origin:
        if result.experiment is None:
            raise InputError("the result does not know the case that it comes from; run a case or an experiment")
        case = Case(schema=SCHEMA, title=result.title, experiment=result.experiment)
        origin = case.provenance()
    drawn, faults = rendered_figures(result)
    for fault in faults:
        warnings.warn(fault, stacklevel=3)
    kept = replace(result, warnings=(*result.warnings, *faults), frames=result.frames if fields else ())
    return write_result(kept, place, case_id=str(origin["case_id"]), provenance=origin, force=force, figures=drawn)


def case_html(case: Case | Experiment) -> str:
    """A case as its file would be written: what was given, with units."""
    return f"<pre>{markup.escape(case_text(case))}</pre>"


def html(result: Result) -> str:
    """Status, quantities, warnings and the main figure."""
    title = markup.escape(result.title or result.kind.replace("_", " "))
    lines = [f"<h4>{title}</h4>", f"<p><b>{result.status}</b>: {markup.escape(one_line(result.reason))}</p>"]
    rows = [_row(name, quantity) for name, quantity in sorted(result.quantities.items(), key=lambda item: item[0] != ANSWER)]
    lines.append(f"<table>{''.join(rows[:LONGEST_TABLE])}</table>")
    if more := rows[LONGEST_TABLE:]:
        lines.append(
            f"<details><summary>{len(more)} more in <code>quantities</code></summary><table>{''.join(more)}</table></details>"
        )
    lines += [f"<p>warning: {markup.escape(one_line(warning))}</p>" for warning in result.warnings]
    first = next(iter(figures_for(result).values()), None)
    if first is not None:
        lines.append(picture(result.title or result.kind, first()))
    return "\n".join(lines)


def _row(name: str, quantity: Quantity) -> str:
    """Name, number with unit or range, and meaning of a quantity as a row of a table."""
    left = "<td style='text-align:left'>"
    words = (markup.escape(one_line(text)) for text in (format_values(quantity), quantity.description))
    return f"<tr>{left}<code>{markup.escape(name)}</code></td>{''.join(f'{left}{word}</td>' for word in words)}</tr>"
