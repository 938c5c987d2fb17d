"""Where a result finds what draws, keeps and shows it: a room far above, named by the package's face, loaded when it is asked."""

from __future__ import annotations

import importlib
from typing import Any

_place = ""


def presented_by(module: str) -> None:
    """Name the module that shows results; it has the functions ``figures``, ``field_mesh``, ``save`` and ``html`` of a result."""
    global _place
    _place = module


def presenter() -> Any:
    """That module."""
    return importlib.import_module(_place)
