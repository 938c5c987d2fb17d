"""What a run returns, and its form on disk."""

from tactsim.results.result import FieldFrame, Quantity, Result, Status, StepRecord

__all__ = ["FieldFrame", "Quantity", "Result", "Status", "StepRecord"]
