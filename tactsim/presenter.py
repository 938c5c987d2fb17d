"""Where results and cases find what draws, keeps and shows them: a room far above, named by the package's face, loaded late."""

from __future__ import annotations

import importlib
from typing import Any

_place = ""


def presented_by(module: str) -> None:
    """Name the module: ``figures``, ``field_mesh``, ``save`` and ``html`` of a result, ``case_html`` of a case."""
    global _place
    _place = module


def presenter() -> Any:
    """That module."""
    return importlib.import_module(_place)
