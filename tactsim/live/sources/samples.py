"""The samples of a data set, picked by number, split and status; each is shown like a result."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.sampling.drawing import drawn_specimen
from tactsim.dataset.sampling.stored import stored_sweep
from tactsim.dataset.sampling.sweep import Sweep
from tactsim.dataset.store.arrays import DONE, PENDING, STATUS
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.verifying import refuse_holes
from tactsim.dataset.use.loading import opened, split_names
from tactsim.errors import InputError, StorageError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.scene import untouched_scene
from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.live.sources.recorded import SOURCES, checked_validity, source_noise
from tactsim.live.sources.scene import PageScene, Recording

OTHER_CASE = (
    "this sample was made from another case than this version of tactsim draws: block and jaws are drawn as of now, "
    "inclusions are not; the version that made the data set shows them"
)
ANY = ""
"""A filter that lets all samples through."""


@dataclass(frozen=True, eq=False)
class Samples:
    """A data set of grasps, opened once; ``data`` is read sample by sample."""

    place: Path
    data: Any

    @classmethod
    def open(cls, place: str | Path) -> Samples:
        """The data set in a folder.

        Raises
        ------
        InputError
            If it has no forces of taxels, or no sample that is done.
        StorageError
            If the folder is not a data set.
        """
        data = opened(place)
        if TAXEL_FORCE not in data:
            raise InputError(f"{place} is a data set without forces of taxels; needed: a data set of grasps")
        if not (data["status"].values == DONE).any():
            raise InputError(
                f"{place} is empty: none of its {data.sizes['sample']} samples is done; go on with `tactsim sweep ... --resume`"
            )
        return cls(Path(place), data)

    @property
    def count(self) -> int:
        """Number of samples, computed or not."""
        return int(self.data.sizes["sample"])

    @cached_property
    def splits(self) -> tuple[str, ...]:
        """Names of the parts."""
        return tuple(split_names(self.data))

    @cached_property
    def sweep(self) -> Sweep:
        """The sweep that made the data set.

        Raises
        ------
        StorageError
            If the store cannot be opened, or the text of its sweep is damaged or of another version.
        """
        return stored_sweep(Store.open(self.place))

    def chosen(self, split: str = ANY, status: str = ANY) -> Array:
        """Numbers (m,) of the samples of a part and a status, all if these are empty.

        Raises
        ------
        InputError
            If there is no such part or status.
        """
        keep = np.ones(self.count, bool)
        for what, name, names in (("split", split, self.splits), ("status", status, STATUS)):
            if name == ANY:
                continue
            if name not in names:
                raise InputError(f"unknown {what} {name[:40]!r}; known: {', '.join(names)}")
            keep &= self.data[what].values == names.index(name)
        return np.flatnonzero(keep)

    def near(self, number: int, move: int, split: str = ANY, status: str = ANY) -> int | None:
        """``move`` 1: the next chosen sample, -1: the one before, both around the end, 0: that nearest to ``number``.

        Raises
        ------
        InputError
            If there is no such part or status.
        """
        chosen = self.chosen(split, status)
        if not len(chosen):
            return None
        if move == 0:
            return int(chosen[np.abs(chosen - number).argmin()])
        beyond = chosen[chosen > number] if move > 0 else chosen[chosen < number][::-1]
        return int(beyond[0]) if len(beyond) else int(chosen[0] if move > 0 else chosen[-1])

    def status_of(self, number: int) -> dict[str, str]:
        """Split, status and reason of a sample."""
        row = self.data[["split", "status", "reason"]].isel(sample=number)
        split = self.splits[int(row["split"])]
        return {"split": split, "status": STATUS[int(row["status"])], "reason": str(row["reason"].values)}

    def recordings(self, number: int) -> dict[str, Recording]:
        """The recordings of a sample by the name of their forces, like those of a result.

        Raises
        ------
        InputError
            If there is no such sample.
        StorageError
            If the data set or this sample is gone since it was opened, or this version of tactsim cannot make out its case.
        """
        if not 0 <= number < self.count:
            raise InputError(f"there is no sample {number}; allowed: 0 to {self.count - 1}")
        row = self.data.isel(sample=number)
        names = [name for name in (*SOURCES, "time_s", "displacement") if name in row]
        computed = np.array([number] if int(row["status"]) != PENDING else [], int)
        refuse_holes(Store.open(self.place), names, computed)  # of what is gone Zarr reads numbers that are none
        scene = self._scene(number, int(row["status"]))
        times = np.atleast_1d(np.asarray(row["time_s"].values, dtype=float))
        if not np.isfinite(times).all():
            times = np.arange(len(times), dtype=float)
        recordings = {}
        for name in (name for name in SOURCES if name in row):
            forces = np.asarray(row[name].values, dtype=float)
            closings = np.asarray(row["displacement"].values, dtype=float)
            known = closings if np.isfinite(closings).all() else None
            valid = checked_validity(forces, times, scene)
            recordings[name] = Recording(scene, times, forces, valid, known, name, source_noise(name, forces, valid))
        return recordings

    def _scene(self, number: int, status: int) -> PageScene:
        state = self.status_of(number)
        title = f"{self.data.attrs.get('title') or self.place.name}: sample {number} ({state['split']})"
        notes: tuple[str, ...] = (
            () if status == DONE else (f"sample {number} is {state['status']}: {state['reason'] or 'it was not computed'}",)
        )
        experiment, same = self._experiment(number, status)
        if not same:
            notes += (OTHER_CASE,)
        return PageScene(title, untouched_scene(experiment), truth_known=same, notes=notes)

    def _experiment(self, number: int, status: int) -> tuple[Grasp, bool]:
        """What was computed, drawn again: it depends on the sweep and the number only; and whether it is the same case still."""
        specimen = number // self.sweep.per_specimen
        drawn = drawn_specimen(self.sweep, specimen)[number - specimen * self.sweep.per_specimen]
        if drawn.case is None or not isinstance(drawn.case.experiment, Grasp):
            raise StorageError(f"sample {number} of {self.place.name} has no case of a grasp: {drawn.refusal or 'another kind'}")
        stored = str(self.data["case_id"].values[number])
        return drawn.case.experiment, status == PENDING or not stored or stored == drawn.case.case_id
