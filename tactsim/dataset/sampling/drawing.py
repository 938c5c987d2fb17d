"""The cases of a specimen: points of the design, drawn values, checked like any case file and drawn again if one is refused."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import scipy
from pydantic import BaseModel

from tactsim.array import Array
from tactsim.case.loading import validated_case
from tactsim.case.model import Case
from tactsim.case.yaml_reading import Path
from tactsim.dataset.sampling.places import Place, filled, sizes_of
from tactsim.dataset.sampling.settings import DesignName
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.errors import InputError, StorageError
from tactsim.experiments.recording import seed_place
from tactsim.interfaces.seeds import SEED, entries, seeds_in

SAME_REFUSALS = 4
"""Draws of the first specimen that are refused with the same words if the file is at fault."""
CHANNELS = "scatter"
"""Name of fields that say how the channels of a sensor differ; their seed is that of the sensor, not of its noise."""
SPECIMENS, SAMPLES, NOISE = 0, 1, 2
"""Streams of random numbers of a sweep."""
WITHIN = 1
"""Stream, within SAMPLES, of what all specimens share."""
SOBOL_BITS = 30
"""Binary digits of the coordinates of a Sobol point."""
BLOCK = 1024
"""Sobol points that are made together; a power of two keeps their balance."""


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
    reason = f"no case was accepted in {most + 1} draws, the last because: {refusal}"
    return [Drawn(number, specimen, None, {}, most, reason) for number in numbers]


def stored_cases(sweep: Sweep, samples: Iterable[int], identities: Iterable[str], where: str) -> Iterator[Case]:
    """The case of each of some samples of the store ``where``, given the identity of what was computed, empty if nothing was.

    Raises
    ------
    InputError
        If no draw of a sample was possible.
    StorageError
        If this tactsim draws another case than was computed.
    """
    specimen, drawn = -1, list[Drawn]()
    for sample, identity in zip(map(int, samples), map(str, identities), strict=True):
        if sample // sweep.per_specimen != specimen:
            specimen = sample // sweep.per_specimen
            drawn = drawn_specimen(sweep, specimen)
        one = drawn[sample % sweep.per_specimen]
        if one.case is None:
            raise InputError(f"sample {sample}: {one.refusal}")
        if identity not in ("", one.case.case_id):
            raise StorageError(f"{where}: sample {sample} was computed from another case than this tactsim draws")
        yield one.case


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
    case = validated_case(replace(sweep.document, value=value), sweep.where)
    if not seed_place(sweep.kind):
        experiment = _seeded(case.experiment, value["experiment"], noise_seed(sweep, sample))
        case = case.model_copy(update={"experiment": experiment})
    return Drawn(sample, specimen, case, used, attempt)


def _seed_noise(experiment: Any, place: tuple[str, ...], seed: int) -> None:
    """Gives the noise of an experiment a seed, if it has noise and its file names none: samples must not share their noise."""
    for key in place[:-1]:
        experiment = experiment.get(key) if isinstance(experiment, dict) else None
    if place and isinstance(experiment, dict):
        experiment.setdefault(place[-1], seed)


def _seeded(model: BaseModel, written: Any, seed: int) -> BaseModel:
    """A model with this seed wherever it has one that its file does not name; other channels would be other sensors."""
    changes: dict[str, Any] = {}
    for name, item in entries(model):
        given = written.get(name) if isinstance(written, dict) else None
        if name == SEED and given is None and isinstance(item, int):
            changes[name] = seed
        elif isinstance(item, BaseModel) and name != CHANNELS:
            changes[name] = _seeded(item, given, seed)
    return model.model_copy(update=changes) if changes else model


def used_seed(sweep: Sweep, drawn: Drawn) -> int:
    """The seed from which the noise of a sample was drawn."""
    if drawn.case is None:
        return noise_seed(sweep, drawn.sample)
    place = ".".join(seed_place(sweep.kind))
    seeds = dict(seeds_in(drawn.case.experiment))
    noise = [seed for path, seed in seeds.items() if (path == place if place else CHANNELS not in path.split("."))]
    return noise[0] if noise else noise_seed(sweep, drawn.sample)


def _values(sweep: Sweep, stream: int, places: tuple[Place, ...], number: int, attempt: int) -> dict[Path, tuple[Any, float]]:
    settings = sweep.settings
    seed = (settings.seed, stream)
    if attempt:
        point = redrawn_point(seed, number, attempt, len(places))
    elif settings.design == "grid":
        point = grid_point(sizes_of(places), number)
    elif settings.design == "sobol" and stream == SAMPLES:
        within = divmod(number, sweep.per_specimen)
        point = point_within(seed, *within, dimensions=len(places), beside=len(sweep.specimen_places))
    else:
        specimens = -(-sweep.samples // sweep.per_specimen)
        count = specimens * (1 if stream == SPECIMENS else sweep.per_specimen)
        point = design_point(settings.design, seed, number, count=count, dimensions=len(places))
    return {place.path: place.distribution.value(float(share)) for place, share in zip(places, point, strict=True)}


def design_point(design: DesignName, seed: tuple[int, ...], number: int, *, count: int, dimensions: int) -> Array:
    """Point (dimensions,) in [0, 1) of a sample.

    Sobol points (scrambled) and random ones depend on the seed and the number alone; of a Latin hypercube, which is defined by
    the number of its points, they depend on ``count`` as well. A grid has no points: see `grid_point`.
    """
    if dimensions == 0:
        return np.zeros(0)
    if design == "random":
        return np.random.default_rng([*seed, number]).random(dimensions)
    if design == "latin_hypercube":
        return _latin_hypercube(seed, count, dimensions)[number]
    return _sobol(seed, number // BLOCK, dimensions)[number % BLOCK]


def point_within(seed: tuple[int, ...], specimen: int, within: int, *, dimensions: int, beside: int) -> Array:
    """Sobol point (dimensions,) in [0, 1) of one sample of a specimen, independent of the ``beside`` coordinates of the specimen.

    Two Sobol sequences begin with the same digits, whatever their scrambling, so that a sequence over the samples would follow
    that over the specimens. Instead, the specimen has a point in further dimensions of its own sequence, which is shifted, digit
    by digit, by the points of a short sequence over the samples of any specimen: the first, the second, ... samples of the
    specimens cover the cube evenly, and so do the samples of each specimen.
    """
    if dimensions == 0:
        return np.zeros(0)
    of_specimen = _sobol(seed, specimen // BLOCK, beside + dimensions)[specimen % BLOCK, beside:]
    of_sample = _sobol((*seed, WITHIN), within // BLOCK, dimensions)[within % BLOCK]
    digits = [np.ldexp(point, SOBOL_BITS).astype(np.int64) for point in (of_specimen, of_sample)]
    return np.ldexp((digits[0] ^ digits[1]).astype(float), -SOBOL_BITS)


def redrawn_point(seed: tuple[int, ...], number: int, attempt: int, dimensions: int) -> Array:
    """Point (dimensions,) of a sample whose case was refused ``attempt`` times before: random, whatever the design."""
    return np.random.default_rng([*seed, number, attempt]).random(dimensions)


def grid_point(sizes: tuple[int, ...], number: int) -> Array:
    """Point (n,) in the middle of the cell of a number in a grid of n sizes; the last place varies fastest."""
    index = np.array(np.unravel_index(number, sizes) if sizes else (), dtype=float)
    return (index + 0.5) / np.array(sizes, dtype=float)


@lru_cache(maxsize=4)
def _latin_hypercube(seed: tuple[int, ...], count: int, dimensions: int) -> Array:
    return scipy.stats.qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(count)


@lru_cache(maxsize=8)
def _sobol(seed: tuple[int, ...], block: int, dimensions: int) -> Array:
    engine = scipy.stats.qmc.Sobol(dimensions, bits=SOBOL_BITS, rng=np.random.default_rng(seed))
    if block:
        engine.fast_forward(block * BLOCK)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of balance, which whole blocks keep
        return engine.random(BLOCK)
