"""Rendering of a result's figures; a figure that cannot be drawn never costs the numbers."""

from __future__ import annotations

from pathlib import Path

from tactsim.results import Result


def rendered_figures(result: Result) -> tuple[dict[str, bytes], list[str]]:
    """File name -> PNG bytes, the main figure first, and a warning for each that could not be drawn."""
    drawn: dict[str, bytes] = {}
    warnings: list[str] = []
    try:
        from tactsim.display import figures_for  # type: ignore[attr-defined,unused-ignore]

        for name, draw in figures_for(result).items():
            drawn[name if Path(name).suffix else f"{name}.png"] = draw()
    except Exception as error:  # noqa: BLE001  whatever drawing does wrong, the numbers must still be written
        warnings.append(f"not every figure could be drawn: {type(error).__name__}: {error}")
    return drawn, warnings
