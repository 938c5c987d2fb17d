"""What the page shows: the block with what is in it, and the forces on the taxels at one time or over many."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError, shown
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.experiments.grasp.setup import JawSettings
from tactsim.interfaces import Inclusion
from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.interfaces.readings import Readings, named_taxels, pulled_words, silent_taxels, silent_words
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.live.sources.noise import RESOLVED, ReadingNoise

LARGEST_FORCE = 1e6
"""In N; a larger number is not a force on a taxel but a mistaken unit."""

SHORTEST_LENGTH, LONGEST_LENGTH = 1e-6, 100.0
"""In m, of a block, a taxel or a pitch; another length is a mistaken unit."""
FILLET = 0.25
"""Largest fillet of an assumed jaw over the smallest side of its block."""
LATEST = 1e12
"""Time in s beyond which differences of times mean nothing; seconds since 1970 are far below."""


@dataclass(frozen=True, eq=False)
class PageScene:
    """What does not change from frame to frame.

    Attributes
    ----------
    title : in words, as the user or a sensor wrote it
    grasp : block, inclusions, jaws and taxels; the places of the jaws are those at ``closing``
    truth_known : whether the inclusions of ``grasp`` are known, as they are not with a real sensor
    closing : of each jaw in m
    notes : what the user must know about these data

    Raises
    ------
    InputError
        If a length is not one that can be drawn.
    """

    title: str
    grasp: GraspScene
    truth_known: bool = True
    closing: float = 0.0
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> Array:
        """Size (3,) of the undeformed block in m, which begins at the origin."""
        return self.grasp.size

    @property
    def layout(self) -> TaxelLayout:
        """Taxels on each jaw."""
        return self.grasp.matrix

    @property
    def inclusions(self) -> tuple[Inclusion, ...] | None:
        """The true inclusions; None if they are not known."""
        return self.grasp.true_inclusions if self.truth_known else None

    def __post_init__(self) -> None:
        lengths = {"block_size": self.size, "matrix.pitch": self.layout.pitch, "matrix.size": self.layout.size}
        for name, value in lengths.items():
            if not np.all((np.asarray(value) >= SHORTEST_LENGTH) & (np.asarray(value) <= LONGEST_LENGTH)):
                raise InputError(f"{name} is {shown(value)} m; allowed: {SHORTEST_LENGTH:g} to {LONGEST_LENGTH:g} m")
        places = self.grasp.places
        if not (np.abs([*places.ravel(), self.closing]) <= LONGEST_LENGTH).all():
            raise InputError(f"a jaw is beyond {LONGEST_LENGTH:g} m or nowhere: {shown(places)} at {shown(self.closing)} m")
        with np.errstate(all="ignore"):  # what is too large is refused
            middles = [np.abs(shape.places(self.size)).max(initial=0.0) for shape in self.inclusions or ()]
        if not all(middle <= LONGEST_LENGTH for middle in middles):
            raise InputError(f"an inclusion is beyond {LONGEST_LENGTH:g} m or nowhere: {shown(middles)} m")

    def places_at(self, closing: float | None) -> Array:
        """Middle (2, 3) in m of both faces when each jaw has closed by ``closing`` in m; None leaves them where they are."""
        places = self.grasp.places
        if closing is not None:
            places[:, 2] += np.array([1.0, -1.0]) * (self.closing - closing)
        return places


def check_extent(size: Array) -> None:
    """Refuses what is not the extent (3,) in m of a block that can be drawn.

    Raises
    ------
    InputError
        With the allowed range.
    """
    if np.shape(size) != (3,) or not ((size >= SHORTEST_LENGTH) & (size <= LONGEST_LENGTH)).all():
        needed = f"needed: three lengths of {SHORTEST_LENGTH:g} to {LONGEST_LENGTH:g} m"
        raise InputError(f"block_size is {shown(np.asarray(size).tolist())} m; {needed}")


def plain_scene(title: str, size: Array, layout: TaxelLayout) -> PageScene:
    """A scene of which no more is known: the jaws are a quarter wider than the block, (3,) in m, and touch it in its middle.

    Raises
    ------
    InputError
        If the size is not three lengths that can be drawn.
    """
    check_extent(size)
    settings = JawSettings()
    settings = settings.model_copy(update={"fillet": min(settings.fillet, FILLET * float(size.min()))})
    x, y, z = map(float, size)
    grasp = GraspScene(
        kind="stream",
        block_size=(x, y, z),
        inclusions=(),
        jaws={side: settings.jaw(side, size.tolist()) for side in JAWS},
        jaw_places={"upper": (x / 2, y / 2, z), "lower": (x / 2, y / 2, 0.0)},
        matrix=layout,
    )
    return PageScene(title, grasp, truth_known=False)


@dataclass(frozen=True, eq=False)
class Frame:
    """The taxels at one time.

    Attributes
    ----------
    forces : (jaw, row, column) in N pressing into the taxels, the upper jaw first; what is not valid may be NaN
    valid : (jaw, row, column), False for a dead or saturated taxel
    time : in s; None if not known
    closing : of each jaw from first touch in m; None if not known
    source : what the forces are, as in ``recorded.SOURCES``
    noise : of each reading
    """

    forces: Array
    valid: Array
    time: float | None = None
    closing: float | None = None
    source: str = TAXEL_FORCE
    noise: ReadingNoise = RESOLVED

    def notes(self) -> tuple[str, ...]:
        """What the user must know about this frame: taxels that are not to be trusted."""
        if any(not good.any() for good in self.valid):
            return (f"no taxel of a jaw gives a number ({named_taxels(~self.valid)}): there is nothing to draw",)
        notes = []
        if not self.valid.all():
            notes.append(f"dead or saturated taxels, interpolated from their neighbours: {named_taxels(~self.valid)}")
        if (silent := silent_taxels(self.forces) & self.valid).any():
            notes.append(silent_words(silent))
        if (pulled := pulled_words(np.where(self.valid, self.forces, 0.0), self.noise.deviation)) is not None:
            notes.append(pulled)
        return tuple(notes)

    def shown_forces(self) -> Array:
        """The forces (jaw, row, column) in N as they are drawn and sent: NaN where the number is no force."""
        return np.where(np.abs(self.forces) <= LARGEST_FORCE, self.forces, np.nan)

    def readings(self, scene: PageScene) -> Readings:
        """The frame as estimators take it.

        Raises
        ------
        InvalidQuantity
            If a whole jaw has no valid taxel.
        """
        return Readings(
            self.forces,
            scene.layout,
            scene.size,
            noise=self.noise.deviation,
            noise_origin=self.noise.origin,
            valid=None if self.valid.all() else self.valid,
            middle=scene.grasp.middle,
            closing=self.closing,
        )


@dataclass(frozen=True, eq=False)
class Recording:
    """Frames over time.

    Attributes
    ----------
    times : (n,) in s, increasing
    forces, valid : (n, jaw, row, column), forces in N
    closings : (n,) in m; None if not known
    source : what the forces are, as in ``recorded.SOURCES``
    noise : of each reading
    """

    scene: PageScene
    times: Array
    forces: Array
    valid: Array
    closings: Array | None
    source: str = TAXEL_FORCE
    noise: ReadingNoise = RESOLVED

    def frame(self, step: int) -> Frame:
        """The frame of a step, counted from 0; beyond the ends the nearest one."""
        k = min(max(step, 0), len(self.times) - 1)
        closing = None if self.closings is None else float(self.closings[k])
        return Frame(self.forces[k], self.valid[k], float(self.times[k]), closing, self.source, self.noise)

    @property
    def last(self) -> Frame:
        """The frame of the last step."""
        return self.frame(len(self.times) - 1)

    def step_at(self, time: float) -> int:
        """Number of the last step that is not after a time in s."""
        return int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(self.times) - 1))

    def at(self, time: float) -> Frame:
        """The frame at a time in s, linear between the steps; a taxel is valid if it is so in both."""
        k = self.step_at(time)
        if k == len(self.times) - 1 or time <= self.times[0]:
            return self.frame(k)
        share = float((time - self.times[k]) / (self.times[k + 1] - self.times[k]))
        closing = None
        if self.closings is not None:
            closing = float((1 - share) * self.closings[k] + share * self.closings[k + 1])
        forces = (1 - share) * self.forces[k] + share * self.forces[k + 1]
        return Frame(forces, self.valid[k] & self.valid[k + 1], float(time), closing, self.source, self.noise)
