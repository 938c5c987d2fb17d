"""The cases of a specimen: drawn, checked like any case file, and drawn again if one of them is refused."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tactsim.case.loading import validated_case
from tactsim.case.model import Case
from tactsim.case.yaml_reading import Path
from tactsim.dataset.designs import design_point, grid_point, redrawn_point
from tactsim.dataset.places import Place, filled
from tactsim.dataset.sweep import Sweep, sizes_of
from tactsim.errors import InputError
from tactsim.experiments.recording import seed_place

Array = np.ndarray
SAME_REFUSALS = 4
SPECIMENS, SAMPLES, NOISE = 0, 1, 2
"""Streams of random numbers of a sweep."""


@dataclass(frozen=True)
class Drawn:
    """One sample: its number, its case (None if every draw was refused), and what was drawn in SI by place."""

    sample: int
    specimen: int
    case: Case | None
    values: dict[Path, float]
    redraws: int
    refusal: str = ""


def drawn_specimen(sweep: Sweep, specimen: int) -> list[Drawn]:
    """Every sample of a specimen, also those beyond the sweep's last; what is drawn depends on the seed and their numbers only.

    A specimen is accepted as a whole: if the case of one of its samples is refused, all are drawn again. What results is the
    design's distribution under the condition that the cases are possible.
    """
    first = specimen * sweep.per_specimen
    numbers = range(first, first + sweep.per_specimen)
    most = 0 if sweep.settings.design == "grid" else sweep.settings.redraws
    refusal = ""
    for attempt in range(most + 1):
        try:
            return [_accepted(sweep, specimen, number, attempt) for number in numbers]
        except InputError as error:
            refusal = str(error).replace("\n", "; ")
    told = f"no case was accepted in {most + 1} draws, the last because: {refusal}"
    return [Drawn(number, specimen, None, {}, most, told) for number in numbers]


def fault_of(sweep: Sweep) -> str:
    """Why no case is possible, if several draws of the first specimen are refused with the same words: a fault of the file."""
    refusals = set()
    for attempt in range(SAME_REFUSALS):
        try:
            _accepted(sweep, 0, 0, attempt)
        except InputError as error:
            refusals.add(str(error))
        else:
            return ""
    return refusals.pop() if len(refusals) == 1 else ""


def noise_generator(sweep: Sweep, sample: int) -> np.random.Generator:
    """Random numbers for the noise of one sample."""
    return np.random.default_rng(noise_seed(sweep, sample))


def noise_seed(sweep: Sweep, sample: int) -> int:
    """Seed of one sample's noise, 64 bits, from the seed of the sweep and the number of the sample."""
    return int(np.random.SeedSequence([sweep.settings.seed, NOISE, sample]).generate_state(1, np.uint64)[0])


def _accepted(sweep: Sweep, specimen: int, sample: int, attempt: int) -> Drawn:
    within = sample - specimen * sweep.per_specimen if sweep.settings.design == "grid" else sample
    drawn = _values(sweep, SPECIMENS, sweep.specimen_places, specimen, attempt)
    drawn |= _values(sweep, SAMPLES, sweep.sample_places, within, attempt)
    used: dict[Path, float] = {}
    value = filled(sweep.document.value, (), drawn, used)
    _seed_noise(value["experiment"], seed_place(sweep.kind), noise_seed(sweep, sample))
    document = replace(sweep.document, value=value)
    return Drawn(sample, specimen, validated_case(document, sweep.where), used, attempt)


def _seed_noise(experiment: Any, place: tuple[str, ...], seed: int) -> None:
    """Gives the noise of an experiment a seed, if it has noise and its file names none: samples must not share their noise."""
    for key in place[:-1]:
        experiment = experiment.get(key) if isinstance(experiment, dict) else None
    if place and isinstance(experiment, dict):
        experiment.setdefault(place[-1], seed)


def used_seed(sweep: Sweep, drawn: Drawn) -> int:
    """The seed from which the noise of a sample was drawn."""
    place = seed_place(sweep.kind)
    found: Any = drawn.case.experiment if drawn.case and place else None
    for key in place:
        found = getattr(found, key, None)
    return noise_seed(sweep, drawn.sample) if found is None else int(found)


def _values(sweep: Sweep, stream: int, places: tuple[Place, ...], number: int, attempt: int) -> dict:
    settings = sweep.settings
    seed = (settings.seed, stream)
    if attempt:
        point = redrawn_point(seed, number, attempt, len(places))
    elif settings.design == "grid":
        point = grid_point(sizes_of(places), number)
    else:
        specimens = -(-sweep.samples // sweep.per_specimen)
        count = specimens * (1 if stream == SPECIMENS else sweep.per_specimen)
        point = design_point(settings.design, seed, number, count=count, dimensions=len(places))
    return {place.path: place.distribution.value(float(share)) for place, share in zip(places, point, strict=True)}
