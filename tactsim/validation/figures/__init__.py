"""Figures of the validation report: those of tables from plain data, and the overview of all rows."""

from tactsim.validation.figures.forms import validation_figure
from tactsim.validation.figures.overview import overview

__all__ = ["overview", "validation_figure"]
