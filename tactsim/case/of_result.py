"""The case that a result was computed from, which its folder keeps with every default filled in."""

from __future__ import annotations

import os
from pathlib import Path

from pydantic import ValidationError

from tactsim.case.model import Case, case_class, experiment_class
from tactsim.errors import CaseError, StorageError, TactsimError
from tactsim.outside.text import one_line
from tactsim.refusals import first_fault
from tactsim.results.provenance import PROVENANCE_FILE, read_provenance


def is_result(path: Path) -> bool:
    """Whether a path is a folder that keeps a case."""
    return os.path.isfile(path / PROVENANCE_FILE)


def case_of_result(folder: Path) -> Case:
    """The case in the folder of a result.

    Raises
    ------
    CaseError
        If this tactsim cannot run it: its kind is not known here, or it has another form today.
    StorageError
        If the file is damaged.
    """
    place = folder / PROVENANCE_FILE
    try:
        resolved = read_provenance(place)["case"]
        kind = resolved["experiment"]["kind"]
    except (TypeError, LookupError):
        raise StorageError(f"{one_line(place)} is damaged: it holds no case") from None
    try:
        return case_class(experiment_class(kind)).model_validate(resolved)
    except (ValidationError, TactsimError) as error:
        fault = first_fault(error) if isinstance(error, ValidationError) else one_line(error)
        raise CaseError(f"{one_line(place)}: this tactsim cannot read the case of the result: {fault}") from None
