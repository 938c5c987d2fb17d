"""Writes a result as a folder that is either complete or absent."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tactsim.errors import StorageError
from tactsim.results.document import document_text, plain_json
from tactsim.results.fields import write_fields
from tactsim.results.folder import RESULT_FILE, OutputFolder, claimed
from tactsim.results.provenance import PROVENANCE_FILE
from tactsim.results.result import Result
from tactsim.storage.files import naming, write_bytes


def write_result(
    result: Result,
    directory: str | Path,
    *,
    case_id: str,
    provenance: Mapping[str, Any],
    force: bool = False,
    figures: Mapping[str, bytes] | None = None,
) -> Path:
    """Writes the folder of a result and returns its path.

    Parameters
    ----------
    figures
        File name in ``figures/`` -> content.
    force
        Whether an earlier result of tactsim in that place may give way.

    Raises
    ------
    StorageError
        If the place is taken, in use or cannot be written; nothing is then left there and nothing earlier is lost.
    """
    with claimed(directory, replace=force) as folder:
        fill(folder, result, case_id=case_id, provenance=provenance, figures=figures or {})
        folder.publish()
        return folder.path


def fill(
    folder: OutputFolder, result: Result, *, case_id: str, provenance: Mapping[str, Any], figures: Mapping[str, bytes]
) -> None:
    """Writes all files of a result where they wait to be published.

    Raises
    ------
    StorageError
        If a file cannot be written, the name of a figure is not plain, or the scene of the result cannot be read.
    InvalidQuantity
        If a quantity or the history could not be read again.
    TypeError
        If JSON cannot hold a value of the provenance.
    """
    with naming(folder.path):
        target = folder.start()
        write_fields(result.frames, target)
        write_bytes(target / "history.csv", history_table(result).encode())
        origin = json.dumps(plain_json(dict(provenance), (), []), indent=1, allow_nan=False)
        write_bytes(target / PROVENANCE_FILE, f"{origin}\n".encode())
        if figures:
            (target / "figures").mkdir()
        for name, content in figures.items():
            write_bytes(_inside(target / "figures", name), content)
        write_bytes(target / RESULT_FILE, document_text(result, case_id).encode())
    folder.finish()


def write_files(files: Mapping[str, bytes], directory: str | Path) -> Path:
    """Writes files, by their paths with ``/``, as a folder that is complete or absent; an earlier folder of tactsim gives way.

    Raises
    ------
    StorageError
        If the place holds anything else, is in use or cannot be written; nothing is then changed.
    """
    with claimed(directory, replace=True) as folder:
        publish_files(files, folder)
        return folder.path


def publish_files(files: Mapping[str, bytes], folder: OutputFolder) -> None:
    """Writes files, by their paths with ``/``, into a claimed folder and moves it into place.

    Raises
    ------
    StorageError
        If they cannot be written; nothing is then changed.
    """
    with naming(folder.path):
        target = folder.start()
        for name, content in files.items():
            (target / name).parent.mkdir(exist_ok=True)
            write_bytes(target / name, content)
    folder.finish()
    folder.publish()


def history_table(result: Result) -> str:
    """CSV text with one row per accepted step; the header names the units, a value that is not finite is left empty."""
    names = list(dict.fromkeys(name for record in result.steps for name in record.values))
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(["step", *(_headed(name, result.units.get(name, "")) for name in names), "newton_iterations", "residual"])
    for record in result.steps:
        values = [_cell(record.values.get(name, math.nan)) for name in names]
        writer.writerow([record.step, *values, record.newton_iterations, _cell(record.residual)])
    return table.getvalue()


def _headed(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def _cell(value: float) -> str:
    return repr(float(value)) if math.isfinite(value) else ""


def _inside(folder: Path, name: str) -> Path:
    if Path(name).name != name:
        raise StorageError(f"{name!r} is not a plain file name for a figure")
    return folder / name
