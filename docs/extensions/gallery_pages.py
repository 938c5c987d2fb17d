"""How the gallery is drawn: the order of its examples, and the figures that end a cell."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

ORDER = (
    "story_threshold_sensor",
    "story_lump_detector",
    "indentation",
    "indentation_3d",
    "timed_indentation",
    "closed_form",
    "annulus_design",
    "durometer",
    "elastomer_ranking",
    "dma_identification",
    "thermogravimetry",
    "film_test",
    "film_creep",
    "calibration",
    "sensor_response",
    "threshold_trial",
    "catheter_tip",
    "switch_probe",
    "boundary_value_problem",
    "grasp",
    "matrix_readout",
    "localization",
    "detectability",
    "confusion",
    "tactile_bands",
)
RESOLUTION = 130
"""In dots per inch."""


class InOrder:
    """Sorts examples as ``ORDER`` lists them; what is not listed comes last."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def __call__(self, file: str) -> tuple[int, str]:
        name = Path(file).stem.removeprefix("plot_")
        return (ORDER.index(name) if name in ORDER else len(ORDER), name)


def last_figure(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """The image of a cell whose last expression is a figure without a window, as those of results are."""
    value = block_vars["example_globals"].get("___")
    if not isinstance(value, Figure) or getattr(value, "in_gallery", False):
        return ""
    value.in_gallery = True  # type: ignore[attr-defined]
    place = Path(next(block_vars["image_path_iterator"]))
    value.savefig(place, dpi=RESOLUTION)
    return figure_rst([str(place)], gallery_conf["src_dir"])
