"""How a sample of a data set was read: by which sensors, in how many steps, how fast, and with what noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.dataset.ranking.reference import PlainGrasp
from tactsim.errors import InputError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.progress import count_bar
from tactsim.sensors.matrix_readout import MatrixReadout

REPEATED = 16
"""Readings of the same forces from which the noise of a sensor is estimated."""


@dataclass(frozen=True)
class Sensing:
    """The sensors of one sample, taxels of ``area`` in m^2, and the equal ``steps`` of its ramp of ``duration`` in s."""

    readout: MatrixReadout
    area: float
    steps: int
    duration: float

    @classmethod
    def of(cls, experiment: Grasp, duration: float) -> Sensing:
        """That of a grasp that is read ``duration`` seconds after first touch.

        Raises
        ------
        InputError
            If it has no readout, or closes otherwise than in one ramp.
        """
        pieces = experiment.loading.pieces
        if experiment.readout is None or len(pieces) != 1 or pieces[0].kind != "ramp":
            raise InputError(f"read forces need grasps with a readout that close in one ramp; give --readings {TAXEL_FORCE}")
        return cls(experiment.readout, experiment.matrix.area, experiment.time.steps, duration)

    def read(self, plain: PlainGrasp, closing: float, seed: int) -> Array:
        """What the sensors read (jaw, row, column) in N at the end of a ramp on plain tissue, solved in as many steps."""
        part = np.arange(1, self.steps + 1) / self.steps
        seeded = self.readout.model_copy(update={"seed": seed})
        return np.asarray(seeded.read(part * self.duration, plain.at(part * closing), self.area).force[-1])

    def noise(self, plain: PlainGrasp) -> float:
        """Standard deviation in N of repeated readings at the reference's last closing, root mean square over the taxels."""
        repeated = [self.read(plain, float(plain.closings[-1]), seed) for seed in range(REPEATED)]
        return float(np.sqrt(np.var(repeated, axis=0, ddof=1).mean()))


def noises(sensing: tuple[Sensing, ...], plain: PlainGrasp) -> Array:
    """The noise (n,) in N of each sample, once for those that are read alike."""
    alike = {_but_for_the_seed(one): one for one in sensing}
    known: dict[str, float] = {}
    with count_bar("sensors", len(alike)) as show:
        for number, (name, one) in enumerate(alike.items(), 1):
            known[name] = one.noise(plain)
            show(number)
    return np.array([known[_but_for_the_seed(one)] for one in sensing])


def _but_for_the_seed(sensing: Sensing) -> str:
    """The same text for samples whose readings differ by their seed alone."""
    return f"{sensing.readout.model_dump_json(exclude={'seed'})} {sensing.area} {sensing.steps} {sensing.duration}"
