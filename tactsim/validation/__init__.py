"""How the software stands against the thesis: its tables as data, the comparison, the report."""

from tactsim.validation.comparison import RowOutcome, TableOutcome, compare
from tactsim.validation.execution import StudyRunner
from tactsim.validation.loading import LoadedTables, load_tables
from tactsim.validation.report import json_report, markdown_report, terminal_report

__all__ = [
    "LoadedTables",
    "RowOutcome",
    "StudyRunner",
    "TableOutcome",
    "compare",
    "json_report",
    "load_tables",
    "markdown_report",
    "terminal_report",
]
