"""What a schema refused of a file, with its lines."""

from __future__ import annotations

from pydantic import BaseModel, ValidationError

from tactsim.case.yaml_reading import Document, Problem
from tactsim.refusals import refusals_of


def problems_of(error: ValidationError, document: Document, model: type[BaseModel]) -> list[Problem]:
    """One problem for every key path that the model refused."""
    refusals = refusals_of(error, document.value, model)
    return [Problem(path, document.line(path), message) for path, message in refusals.items()]
