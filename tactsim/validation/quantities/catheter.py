"""Sensors around the tip of a catheter that search the mitral annulus: thesis, chapter 7, section 7.3."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.experiments.threshold.catheter_tip import CatheterTip
from tactsim.interfaces import drawing, quantity
from tactsim.interfaces.run import returned_by, run_within_another
from tactsim.results.result import Result
from tactsim.units import NonNegative
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.inputs import Inputs

MOSTLY = 0.5
"""Part of a sensor's disc on a tissue above which it lies on it."""

CasePath = Annotated[str, Field(description="Case of a catheter tip, relative to the table.")]
Tissue = Annotated[str, Field(description="Name of the tissue that is searched, between two others.")]
Sensors = Annotated[int, Field(ge=2, le=64, description="Sensors around the tip.")]
Places = Annotated[
    int, Field(ge=1, le=1000, description="Places of the tip, drawn along the band; its orientation is drawn too.")
]
Touches = Annotated[int, Field(ge=1, le=10_000, description="Touches at each place.")]
Number = Literal["reached", "found", "found_where_reached", "named", "bias"]


@quantity(unit="1")
def catheter_search(
    inputs: Inputs,
    number: Number,
    case: CasePath,
    tissue: Tissue,
    *,
    sensors: Sensors,
    places: Places = 12,
    touches: Touches = 20,
    seed: NonNegative[int] = 1,
) -> float:
    """How well a tip with so many sensors finds a tissue, over places where its circle of sensors meets it; dimensionless.

    ``reached`` is the part of the places at which a sensor lies mostly on the tissue; ``found`` the part of the touches in which
    the sensor that is named as being on the hardest tissue does, ``found_where_reached`` the same over those places; ``named``
    the part in which the sensor with the highest true threshold is named; ``bias`` the mean relative difference of the reported
    thresholds from the true ones.

    Parameters
    ----------
    number : which of them
    seed : of places and noise

    Raises
    ------
    CaseError, InputError
        If the case is no catheter tip, or has no such tissue between two others.
    """
    values = [
        _counted(number, result, band)
        for result, band in _runs(inputs, case, tissue, sensors=sensors, places=places, touches=touches, seed=seed)
    ]
    return float(np.nanmean(values))


@drawing
def catheter_search_over_sensors(
    inputs: Inputs,
    title: Title,
    case: CasePath,
    tissue: Tissue,
    *,
    sensors: Annotated[tuple[Sensors, ...], Field(min_length=2)] = (3, 4, 5, 6, 8),
    places: Places = 12,
    touches: Touches = 20,
) -> Data:
    """Chances of ``catheter_search`` over the number of sensors.

    Parameters
    ----------
    sensors : numbers of sensors around the tip

    Raises
    ------
    CaseError, InputError
        If the case is no catheter tip, or has no such tissue between two others.
    """
    numbers: dict[Number, str] = {
        "reached": "a sensor lies on it",
        "found": "the sensor named lies on it",
        "named": "the right sensor is named",
    }
    columns: dict[Number, list[float]] = {number: [] for number in numbers}
    for count in sensors:
        runs = list(_runs(inputs, case, tissue, sensors=count, places=places, touches=touches, seed=1))
        for number, column in columns.items():
            column.append(float(np.mean([_counted(number, result, band) for result, band in runs])))
    x = np.array(sensors, dtype=float)
    curves = [series(words, x, np.array(columns[number])) for number, words in numbers.items()]
    return curves_figure(title, "sensors around the tip", "", [panel("part of the places or touches", "", curves)])


def _runs(
    inputs: Inputs, case: str, tissue: str, *, sensors: int, places: int, touches: int, seed: int
) -> Iterator[tuple[Result, int]]:
    """A run at each place with the number of the tissue."""
    from tactsim.case import load_case

    tip: Any = load_case(inputs.folder / case).experiment
    if not isinstance(tip, CatheterTip):
        raise InputError(f"{case} is a {tip.kind}; needed: a catheter_tip")
    names = [one.name for one in tip.surface.tissues]
    if tissue not in names[1:-1]:
        raise InputError(f"{case} has the tissues {', '.join(names)}; needed: {tissue} between two others")
    band = names.index(tissue)
    inner, outer = tip.surface.borders[band - 1], tip.surface.borders[band]
    generator = np.random.default_rng(seed)
    for number in range(places):
        ring = tip.ring.model_copy(update={"count": sensors, "orientation": float(generator.uniform(0, 2 * np.pi / sensors))})
        distance = float(generator.uniform(inner - ring.radius, outer + ring.radius))
        update = {"ring": ring, "place": (distance, 0.0), "trials": touches, "seed": seed + number}
        yield returned_by(run_within_another(tip.model_copy(update=update))), band


def _counted(number: Number, result: Result, band: int) -> float:
    """A number of ``catheter_search`` at one place."""
    share = result.quantities["tissue_share"].numbers[:, band]
    reached = bool((share > MOSTLY).any())
    if number == "reached":
        return float(reached)
    if number == "found_where_reached" and not reached:
        return np.nan
    true = result.quantities["threshold_force"].numbers
    if number == "bias":
        return float(np.nanmean(result.quantities["reported_force"].numbers / true - 1))
    wrong, elsewhere, undecided = (
        float(result.quantities[f"chance_of_{name}"].value) for name in ("wrong", "wrong_tissue", "no_answer")
    )
    if number == "named":
        return 1 - wrong - undecided
    return float(share[int(true.argmax())] > MOSTLY) * (1 - elsewhere - undecided)
