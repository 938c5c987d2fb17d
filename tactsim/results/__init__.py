"""What a run returns, and its form on disk."""

from tactsim.results.quantity import Quantity
from tactsim.results.reading import StoredResult, read_result
from tactsim.results.result import FieldFrame, Result, Status, StepRecord
from tactsim.results.scene import Scene, SolverReport
from tactsim.results.writing import write_result

__all__ = [
    "FieldFrame",
    "Quantity",
    "Result",
    "Scene",
    "SolverReport",
    "Status",
    "StepRecord",
    "StoredResult",
    "read_result",
    "write_result",
]
