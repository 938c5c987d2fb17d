"""The case file: its closed schema, its safe reading, its identity."""

from tactsim.case.json_schema import case_json_schema
from tactsim.case.loading import load_case
from tactsim.case.model import SCHEMA, Case, Output

__all__ = ["SCHEMA", "Case", "Output", "case_json_schema", "load_case"]
