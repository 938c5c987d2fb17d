"""What estimators are judged on: the samples of a store as readings with their truth, and the reference that belongs to each."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tactsim.array import Array
from tactsim.dataset.ranking.reference import PlainGrasp, check_same
from tactsim.dataset.ranking.sensing import Sensing, noises
from tactsim.dataset.sampling.drawing import stored_cases
from tactsim.dataset.sampling.layout import first_case
from tactsim.dataset.sampling.stored import UNUSABLE, stored_sweep
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.opening import Store
from tactsim.dataset.use.loading import load
from tactsim.errors import InputError, StorageError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.scene import untouched_scene
from tactsim.experiments.localization.source import SAME_CLOSING, jaw_notes
from tactsim.interfaces.both_jaws import READ_FORCE, TAXEL_FORCE, Source
from tactsim.interfaces.readings import ROUNDING_NOISE, Readings
from tactsim.interfaces.seeds import SEED
from tactsim.localization.lump_response import LumpResponse
from tactsim.outside.text import one_line
from tactsim.units import format_quantity

if TYPE_CHECKING:
    import xarray

SPHERE = 1
"""Number of a ball among the kinds of inclusions of a store."""
LEAST_NOISE = 1e-9
"""Of a reading over the largest: below it is round-off."""
JAW_KEYS = (("upper",), ("lower",))
"""Where a case describes its jaws."""
TISSUE = ("block", "tissue")
"""Where it describes the tissue."""
SHARED = (("block",), ("matrix",))
"""Where it describes what all samples and the reference share."""
SENSED = (("readout",), ("time",))
"""Parts of a grasp that say how it was read."""


@dataclass(frozen=True)
class Truth:
    """What a sample was computed with; lengths in m, all but ``closing`` None without a lump.

    ``depth`` is that of the centre below the upper face, ``contrast`` the shear modulus over that of the tissue, both at rest.
    """

    sample: int
    closing: float
    center: tuple[float, float, float] | None = None
    radius: float | None = None
    depth: float | None = None
    contrast: float | None = None
    specimen: int | None = None
    """Number of the specimen, which samples may share; None if it has its own."""

    @property
    def group(self) -> int:
        """The same number for samples of one specimen."""
        return self.sample if self.specimen is None else self.specimen

    @property
    def present(self) -> bool:
        """Whether there is a lump."""
        return self.center is not None


@dataclass(frozen=True, eq=False)
class JudgedSamples:
    """The samples of a store that are done, with at most one ball each, and the plain grasp that they are held against."""

    truths: tuple[Truth, ...]
    forces: Array
    """(n, jaw, row, column) in N: as the solution has them, or as read."""
    plain: PlainGrasp
    source: Source
    noise: Array
    """Standard deviation (n,) in N of a reading of each, as stated."""
    own_noise: Array
    """That of the forces as they are (n,); the rest is added."""
    sensing: tuple[Sensing, ...] = ()
    """How each was read; empty for the forces of the solution."""
    cases: tuple[str, ...] = ()
    """Hash of the case of each sample, as the store has it."""

    @property
    def block_size(self) -> Array:
        """(3,) in m."""
        return np.asarray(self.plain.readings.block_size)

    @cached_property
    def references(self) -> Array:
        """What the plain tissue reads (n, jaw, row, column) at each sample's closing, in N; read with noise like the samples."""
        if not self.sensing:
            return self.plain.at(np.array([truth.closing for truth in self.truths]))
        both = zip(self.sensing, self.truths, strict=True)
        return np.stack([sensing.read(self.plain, truth.closing, truth.sample) for sensing, truth in both])

    def readings(self, response: LumpResponse | None = None, *, multiple: float = 1.0, seed: int = 1) -> Iterator[Readings]:
        """Readings of each sample with reference; noise is added until it is ``multiple`` times the stated one, by the seed."""
        added = added_noise(self.noise, self.own_noise, multiple)
        for k, (truth, forces, reference) in enumerate(zip(self.truths, self.forces, self.references, strict=True)):
            generator = np.random.default_rng([seed, truth.sample, round(1000 * multiple)])
            noise = added[k] * generator.standard_normal((2, *forces.shape))
            yield replace(
                self.plain.readings,
                forces=forces + noise[0],
                reference=reference + noise[1],
                noise=multiple * float(self.noise[k]),
                closing=truth.closing,
                response=response,
            )


def added_noise(stated: Array, own: Array, multiple: Array | float) -> Array:
    """Standard deviations (n,) in N of the noise that makes that of forces and references a ``multiple`` of the stated one."""
    return np.sqrt(np.maximum(0.0, (multiple * stated) ** 2 - own**2))


def judged_samples(
    store: str | Path,
    reference: Sequence[str],
    *,
    split: str | Sequence[str] | None = None,
    source: Source | None = READ_FORCE,
    noise: float | None = None,
) -> JudgedSamples:
    """The samples of a store, or of one of its parts, that estimators can be judged on.

    ``source`` of None is what sensors read if the store has it, else what the solution has.
    ``noise`` in N is added to what they read. ``read_force`` has that of each sample's own electronics too, estimated by repeated
    readings of the reference; for ``taxel_force`` the default is what rounding to 0.1 N does (thesis 6.2).

    Raises
    ------
    StorageError
        If the folder is not a data set, or a sample is not what was written.
    InputError
        If it has no grasp that is done, other inclusions than one ball, no such readings, another block or matrix than the
        reference, closes further, or opens again before its end.
    """
    data, sweep = load(store, split=split, verified=True), stored_sweep(Store.open(store))
    experiment = first_grasp(sweep, Path(store).name)
    source = source or (READ_FORCE if experiment.readout else TAXEL_FORCE)
    _check_store(data, source, Path(store).name, split)
    refuse_reopened(experiment, Path(store).name)
    plain = PlainGrasp.of_results(reference)
    check_all_same(sweep, data, experiment, plain.readings, Path(store).name)
    for note in _unlike_reference(sweep, experiment, plain):
        warnings.warn(note, stacklevel=2)
    forces = np.asarray(data[source].values[:, -1], dtype=float)
    truths = _truths(data, float(experiment.block.size[2]))
    plain.at(np.array([truth.closing for truth in truths]))
    sensing = _sensing(sweep, data, experiment, Path(store).name) if source == READ_FORCE else ()
    electronic = noises(sensing, plain) if sensing else np.zeros(len(truths))
    if noise is None and sensing and (electronic < LEAST_NOISE * np.abs(forces).max()).any():
        raise InputError(
            f"{Path(store).name} was read without noise, from which no estimator can tell a lump that is felt; give that of the "
            "sensors, such as --noise '1 mN' (in Python: noise=1e-3)"
        )
    given = noise if noise is not None else 0.0 if sensing else ROUNDING_NOISE
    cases = tuple(map(str, data["case_id"].values))
    return JudgedSamples(truths, forces, plain, source, np.hypot(electronic, given), electronic, sensing, cases)


def _unlike_reference(sweep: Sweep, experiment: Grasp, plain: PlainGrasp) -> list[str]:
    """What an estimator would take for lumps: jaws unlike those of the reference, and jaws or tissue that vary."""
    of_jaws = [place.key for place in sweep.places if place.path[1:2] in JAW_KEYS]
    varied = of_jaws + [place.key for place in sweep.places if place.path[1:3] == TISSUE]
    notes = [] if of_jaws else list(jaw_notes(untouched_scene(experiment), plain.scene))
    if varied:
        words = "varies among the samples, not in the reference: what it changes in the readings is taken for lumps"
        notes.append(f"{' and '.join(varied)} {words}")
    return notes


def _sensing(sweep: Sweep, data: xarray.Dataset, experiment: Grasp, name: str) -> tuple[Sensing, ...]:
    """How each sample was read: as the ``experiment`` of one, or by its own case where sensors or steps vary."""
    own = any(place.path[1:2] in SENSED and place.path[-1] != SEED for place in sweep.places)
    grasps = _own_grasps(sweep, data, name) if own else [experiment] * data.sizes["sample"]
    durations = np.asarray(data["time_s"].values[:, -1], dtype=float)
    return tuple(Sensing.of(grasp, float(duration)) for grasp, duration in zip(grasps, durations, strict=True))


def _own_grasps(sweep: Sweep, data: xarray.Dataset, name: str) -> list[Grasp]:
    """What each sample was computed from, drawn again."""
    cases = stored_cases(sweep, data["sample"].values, data["case_id"].values, name)
    return [case.experiment for case in cases]  # type: ignore[misc]  # of one kind, as the first one is


def check_all_same(sweep: Sweep, data: xarray.Dataset, first: Grasp, reference: Readings, name: str) -> None:
    """Refuse samples of another block or matrix than the reference; ``first`` is one of them, as the others are unless they vary.

    Raises
    ------
    InputError
        Naming what differs.
    """
    vary = any(place.path[1:2] in SHARED for place in sweep.places)
    for grasp in _own_grasps(sweep, data, name) if vary else [first]:
        check_same(np.asarray(grasp.block.size), grasp.matrix, reference, "the store")


def first_grasp(sweep: Sweep, name: str) -> Grasp:
    """The first possible grasp of the store ``name``, which holds readout and loading.

    Raises
    ------
    InputError
        If it holds no grasps.
    StorageError
        If its case cannot be read.
    """
    try:
        experiment = first_case(sweep).experiment
    except UNUSABLE as error:
        raise StorageError(f"{name}: the case in it cannot be read by this tactsim: {one_line(error)}") from None
    if not isinstance(experiment, Grasp):
        raise InputError(f"{name} holds samples of {sweep.kind}; needed: grasps, as of cases/sweep_lumps.yaml")
    return experiment


def refuse_reopened(experiment: Grasp, name: str) -> None:
    """Refuse grasps that open again before their end: forces are judged there, against tissue that was closed only.

    Raises
    ------
    InputError
        If they do.
    """
    if experiment.loading.control != "displacement":
        return  # which has no closing, and is refused for that
    most = experiment.loading.least_and_most()[1]
    end = float(experiment.loading.history().value(experiment.duration))
    if end < most * (1 - SAME_CLOSING):
        closed, left = format_quantity(most, "m"), format_quantity(end, "m")
        raise InputError(
            f"{name} has grasps that close by {closed} and open again to {left}; needed: a largest closing at the end, where the "
            "taxels are read"
        )


def _check_store(data: xarray.Dataset, source: Source, name: str, split: str | Sequence[str] | None) -> None:
    part = f" in the split {split if isinstance(split, str) else ', '.join(split)}" if split else ""
    if not data.sizes["sample"]:
        raise InputError(f"{name} has no sample that is done{part}; run the sweep, or take another split")
    if source not in data:
        raise InputError(f"{name} has no {source}, its grasps have no readout; give --readings {TAXEL_FORCE}")
    if "inclusion_count" not in data or "inclusion_center" not in data:
        raise InputError(f"{name} has no labels of inclusions; needed: grasps with a lump, as of cases/sweep_lumps.yaml")
    count = data["inclusion_count"].values
    if (count > 1).any() or ((count == 1) & (data["inclusion_kind"].values[:, 0] != SPHERE)).any():
        raise InputError(
            f"{name} has samples{part} with other than one ball; needed: one ball or none in every sample; what estimators of "
            "several hypotheses take such samples for is counted by tactsim data confusion"
        )
    if not np.isfinite(data["closing"].values).all():
        raise InputError(f"{name} has grasps by a prescribed force; needed: a prescribed displacement of the jaws")


def _truths(data: xarray.Dataset, height: float) -> tuple[Truth, ...]:
    count, closing = data["inclusion_count"].values, data["closing"].values
    center, radius = data["inclusion_center"].values[:, 0], data["inclusion_radius"].values[:, 0]
    contrast, numbers = data["inclusion_contrast"].values[:, 0], data["sample"].values
    truths = []
    for k, number in enumerate(numbers):
        truth = Truth(int(number), float(closing[k]), specimen=int(data["specimen"].values[k]))
        if count[k]:
            x, y, z = map(float, center[k])
            truth = replace(truth, center=(x, y, z), radius=float(radius[k]), depth=height - z, contrast=float(contrast[k]))
        truths.append(truth)
    return tuple(truths)
