"""The files and folders that a case names: found before anything is computed, reported when they lie elsewhere."""

from __future__ import annotations

from tactsim.case.loading import Place, in_words
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
    warnings = []
    for key, path in input_paths(case.experiment, ("experiment",)):
        try:
            place_of_file = located(path)
        except Unreadable as error:
            first = f"; run first\n{document.first}" if str(path) in document.first else ""
            raise StorageError(in_words(Problem(key, document.line(key), f"{error}{first}"), place)) from None
        if place_of_file == "elsewhere":
            warnings.append(f"{'.'.join(map(str, key))}: {one_line(path)} lies neither beside the case nor in the working folder")
    return warnings
