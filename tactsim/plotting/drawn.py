"""Drawing of figures; one that cannot be drawn never costs the numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from tactsim import plotting
from tactsim.errors import TactsimError
from tactsim.interfaces.drawing import begin_all
from tactsim.outside.defect_place import place_of
from tactsim.outside.library_warnings import collected_warnings
from tactsim.outside.text import one_line
from tactsim.results import Result


def rendered_figures(result: Result, form: str = "png", *, main_only: bool = False) -> tuple[dict[str, bytes], list[str]]:
    """File name -> content of a result's figures, the main one first or alone, and warnings."""

    def drawings() -> Mapping[str, Callable[..., bytes]]:
        figures: Mapping[str, Callable[..., bytes]] = plotting.figures_for(result)
        return dict(list(figures.items())[:1]) if main_only else figures

    return drawn_figures(drawings, form)


def drawn_figures(
    drawings: Callable[[], Mapping[str, Callable[..., bytes]]], form: str = "png"
) -> tuple[dict[str, bytes], list[str]]:
    """File name -> content of those figures that could be drawn, and warnings: of libraries, and why others could not."""
    drawn: dict[str, bytes] = {}
    warnings: list[str] = []
    with collected_warnings() as caught:
        try:
            chosen = drawings()
            begin_all(chosen.values())
            for name, draw in chosen.items():
                try:
                    drawn[str(Path(name).with_suffix(f".{form}"))] = draw() if form == "png" else draw(form)
                except TactsimError as error:
                    warnings.append(f"{name} is left out: {error}")
        except Exception as error:  # noqa: BLE001  whatever drawing does wrong, the numbers must still be written
            warnings.append(f"not every figure could be drawn: {type(error).__name__}: {one_line(error)}; from {place_of(error)}")
    return drawn, caught.lines() + warnings
