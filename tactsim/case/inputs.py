"""The files and folders that a case names: found before anything is computed, told when they lie elsewhere."""

from __future__ import annotations

from tactsim.case.loading import Place
from tactsim.case.model import Case
from tactsim.case.yaml_reading import Document, Problem
from tactsim.errors import StorageError
from tactsim.outside.files import Unreadable, located
from tactsim.outside.input_path import input_paths
from tactsim.outside.text import one_line


def check_inputs(case: Case, document: Document, place: Place) -> list[str]:
    """A sentence for every file of the case that lies neither beside it nor in the working folder.

    Raises
    ------
    StorageError
        If one is missing, with the file, the line and the key of the case that name it.
    """
    told = []
    for key, path in input_paths(case.experiment, ("experiment",)):
        where, name = place(Problem(key, document.line(key), "")), ".".join(map(str, key))
        where = where if where == f"--set {name}" else f"{where}: {name}"
        try:
            found = located(path)
        except Unreadable as error:
            raise StorageError(f"{where}: {error}") from None
        if found == "elsewhere":
            told.append(f"{name}: {one_line(path)} lies neither beside the case nor in the working folder")
    return told
