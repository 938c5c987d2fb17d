"""Rendering of a result's figures; a figure that cannot be drawn never costs the numbers."""

from __future__ import annotations

from pathlib import Path

from tactsim.outside.library_warnings import collected_warnings
from tactsim.outside.text import one_line
from tactsim.results import Result


def rendered_figures(result: Result) -> tuple[dict[str, bytes], list[str]]:
    """File name -> PNG bytes, the main figure first, and a warning for each that could not be drawn."""
    drawn: dict[str, bytes] = {}
    warnings: list[str] = []
    try:
        from tactsim.plotting import figures_for  # type: ignore[attr-defined,unused-ignore]

        with collected_warnings() as said:
            for name, draw in figures_for(result).items():
                drawn[name if Path(name).suffix else f"{name}.png"] = draw()
        warnings += said.lines()
    except Exception as error:  # noqa: BLE001  whatever drawing does wrong, the numbers must still be written
        warnings.append(f"not every figure could be drawn: {type(error).__name__}: {one_line(error)}")
    return drawn, warnings
