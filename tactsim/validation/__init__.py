"""How the software stands against the thesis and against published problems: tables as data, the comparison, the report."""

from tactsim.validation.comparison import RowOutcome, TableOutcome, compare
from tactsim.validation.execution import StudyRunner
from tactsim.validation.html import html_report
from tactsim.validation.loading import LoadedTables, load_groups, load_tables
from tactsim.validation.report import Validation, json_report, markdown_report, summary_text, table_text

__all__ = [
    "LoadedTables",
    "RowOutcome",
    "StudyRunner",
    "TableOutcome",
    "Validation",
    "compare",
    "html_report",
    "json_report",
    "load_groups",
    "load_tables",
    "markdown_report",
    "summary_text",
    "table_text",
]
