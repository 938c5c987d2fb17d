"""What figures share: canvas, off-screen window, cuts; each experiment's own figures stand in its folder."""

from tactsim.plotting.result_figures import figures_for

__all__ = ["figures_for"]
