"""The report as one HTML file that opens from disk: figures inside, errata in words where they are used."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

from tactsim.interfaces.drawing import png_source
from tactsim.validation.comparison import RowOutcome, TableOutcome
from tactsim.validation.pictures import PlacedPicture, placed_pictures
from tactsim.validation.report import (
    CLASSES,
    COUNT_HEADER,
    MEANINGS,
    ORIGIN_HEADER,
    RUN_HEADER,
    Validation,
    cells,
    count_origins,
    count_rows,
    run_cells,
)
from tactsim.version import __version__

COLOURS = {
    "reproduced": "#0072b2",
    "reproduced after an erratum": "#56b4e9",
    "confirmed": "#009e73",
    "inside a range": "#cc79a7",
    "outside": "#e69f00",
    "contradicted": "#d55e00",
    "transcribed": "#999999",
    "regression": "#555555",
    "not testable": "#cccccc",
    "repeated": "#e6e6e6",
    "left": "#000000",
}
"""Colours that the colour-blind can tell apart (Okabe and Ito 2008, jfly.uni-koeln.de/color), greys for what proves nothing."""
ERRATUM = re.compile(r"\b(E[0-9]+)\b")


def html_report(validations: Sequence[Validation], figures: Mapping[str, Mapping[str, bytes]]) -> str:
    """The content of ``validation.html``; ``figures`` are PNG files by table and name, and ``overview``."""
    import jinja2

    environment = jinja2.Environment(autoescape=True, trim_blocks=False, undefined=jinja2.StrictUndefined)
    template = environment.from_string(files("tactsim.validation").joinpath("report.html.j2").read_text(encoding="utf-8"))
    overview = next(iter(figures.get("overview", {}).values()), None)
    return template.render(
        version=__version__,
        wrong=[name for validation in validations for name in validation.wrong],
        overview=None if overview is None else png_source(overview),
        meanings={label: MEANINGS[label] for label in CLASSES},
        colours=COLOURS,
        run_header=RUN_HEADER,
        pieces=ERRATUM.split,
        groups=[_group(validation, figures) for validation in validations],
    )


def _group(validation: Validation, figures: Mapping[str, Mapping[str, bytes]]) -> dict[str, Any]:
    return {
        "name": validation.name,
        "faults": validation.loaded.faults,
        "count_header": COUNT_HEADER,
        "counts": count_rows(validation),
        "origin_header": ORIGIN_HEADER,
        "origins": count_origins(validation.rows),
        "errata": validation.loaded.manifest.errata,
        "tables": [_table(outcome, figures.get(outcome.name, {})) for outcome in validation.outcomes],
    }


def _table(outcome: TableOutcome, figures: Mapping[str, bytes]) -> dict[str, Any]:
    drawn = [picture for picture in placed_pictures(outcome) if picture.name in figures]
    return {
        "name": outcome.name,
        "title": outcome.table.title,
        "source": outcome.table.source,
        "rows": [_row(row, drawn) for row in outcome.rows],
        "pictures": {picture.name: png_source(figures[picture.name]) for picture in drawn},
        "studies": [{"name": name, "runs": run_cells(runs)} for name, runs in outcome.inputs.studies.items()],
    }


def _row(outcome: RowOutcome, pictures: Sequence[PlacedPicture]) -> dict[str, Any]:
    names = ("id", "origin", "expected", "computed", "ratio", "allowed", "ended")
    shown = dict(zip(names, cells(outcome), strict=True))
    row = outcome.row
    words = {"quantity": row.quantity, "place": row.place, "label": outcome.label, "why": outcome.reason}
    seen_in = [picture.name for picture in pictures if any(row.id in rows for rows in picture.rows.values())]
    return {**shown, **words, "seen_in": seen_in, "below": [picture for picture in pictures if picture.below == row.id]}
