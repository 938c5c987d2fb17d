"""Figures of results as PNG; each experiment's figures are one file here."""

from tactsim.display.result_figures import figures_for

__all__ = ["figures_for"]
