"""Where the readings of a force calibration come from: a declared line through a signal chain, or a file."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.identification.columns import read_columns
from tactsim.model import FrozenModel
from tactsim.outside.input_path import InputPath
from tactsim.sensors.electronics.calibration import THESIS_LINE, AnyCalibration
from tactsim.sensors.electronics.channel_scatter import ChannelScatter
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.units import Force, NonNegative, Time

Readings = tuple[Array, Array, Array]
"""Forces in N of shape (points,), voltages in V and whether each is saturated, of shape (points, sensors)."""
MOST_SENSORS = 64
"""Sensors of one calibration, at most: a file has a column for each."""
MOST_NUMBERS = 100_000_000
"""Samples of all sensors, holds and repeats together."""


class SyntheticCalibration(FrozenModel):
    """Forces held one after the other on sensors of known lines and read at the end of each hold."""

    kind: Literal["synthetic"] = "synthetic"
    line: AnyCalibration = THESIS_LINE
    """The true line; by default that of thesis section 3.1.2."""
    sensors: Annotated[int, Field(ge=1, le=MOST_SENSORS)] = 1
    """Number of sensors, each with its channel; 18 in thesis section 6.2."""
    scatter: ChannelScatter | None = None
    """How the sensors' conductances differ from the line; null is not at all."""
    forces: Annotated[tuple[NonNegative[Force], ...], Field(min_length=1)] = tuple(map(float, range(26)))
    """Forces applied; by default 0 to 25 N, the range of thesis section 3.1.2, in steps of 1 N (an assumption)."""
    repeats: Annotated[int, Field(ge=1, le=1000)] = 2
    """How often the forces are applied, one after the other."""
    hold: Annotated[Time, Field(gt=0, le=100)] = 1.0
    """How long each force is held; its last sample is read, one second after its application in thesis section 2.2.1."""
    seed: NonNegative[int] = 1
    """Seed of the chain's noise."""

    def truth(self) -> tuple[Array, Array]:
        """True slopes in S/N and intercepts in S, shape (sensors,)."""
        return self.line.slope * self._gains(), self.line.intercept * self._gains()

    def readings(self, chain: SignalChain) -> Readings:
        """Filtered readings; one is saturated if any sample of its hold was.

        Raises
        ------
        InvalidQuantity
            If they would take more than `MOST_NUMBERS` samples.
        """
        forces = np.tile(self.forces, self.repeats)
        samples = int(min(self.hold * chain.sampling_rate + 1, MOST_NUMBERS + 1))
        if samples * forces.size * self.sensors > MOST_NUMBERS:
            raise InvalidQuantity(
                f"data: {forces.size} holds of {self.sensors} sensors take {self.hold * chain.sampling_rate:.3g} samples each; "
                f"allowed: {MOST_NUMBERS:g} in all; lower hold, repeats or sampling_rate"
            )
        samples = chain.times(self.hold).size
        stream = chain.stream(np.random.default_rng(self.seed))
        voltages, saturated = [], []
        for conductance in self.line.conductance(forces)[:, None] * self._gains():
            recording, stream = stream.take(np.broadcast_to(conductance, (samples, self.sensors)))
            voltages.append(recording.filtered[-1])
            saturated.append(recording.saturated.any(axis=0))
        return forces, np.array(voltages), np.array(saturated)

    def lag(self, chain: SignalChain) -> float:
        """Most in V by which the low pass keeps the reading at the end of a hold from the voltage of its force."""
        if chain.low_pass is None:
            return 0.0
        jump = np.append(0.0, np.ones(chain.times(self.hold).size))
        left = 1 - float(chain.low_pass.filtered(jump, chain.sampling_rate)[0][-1])
        return abs(left) * self._largest_jump(chain)

    def settled_hold(self, chain: SignalChain) -> float:
        """Hold in s after which the low pass is within a step of the converter; of a high order a little more than it takes."""
        if chain.low_pass is None:
            return 0.0
        slowest = 2 * np.pi * chain.low_pass.cutoff * np.sin(np.pi / (2 * chain.low_pass.order))  # 1/s, of a Butterworth filter
        return max(0.0, float(np.log(chain.low_pass.order * self._largest_jump(chain) / chain.converter.step) / slowest))

    def _largest_jump(self, chain: SignalChain) -> float:
        """Largest change of the voltage in V from one hold to the next."""
        forces = np.tile(self.forces, min(self.repeats, 2))
        voltage = chain.voltage(self.line.conductance(forces)[:, None] * self._gains())
        return float(np.abs(np.diff(voltage, axis=0)).max(initial=0.0))

    def _gains(self) -> Array:
        return np.ones(self.sensors) if self.scatter is None else self.scatter.gains((self.sensors,), self.line)


class MeasuredCalibration(FrozenModel):
    """Readings from a file."""

    kind: Literal["file"] = "file"
    path: InputPath
    """CSV file, beside the case or in the working folder; header such as ``force [N], voltage [V]``."""
    sensors: Annotated[int, Field(ge=1, le=MOST_SENSORS)] = 1
    """Number of columns of voltage; beyond one they are numbered: ``force [N], voltage 1 [V], voltage 2 [V]``."""

    def truth(self) -> None:
        """No true line is known."""
        return None

    def readings(self, chain: SignalChain) -> Readings:
        """The columns of the file; a voltage at an end of the converter's range counts as saturated.

        Raises
        ------
        StorageError
            If the file cannot be read.
        InvalidQuantity
            If it does not hold one finite force and one voltage of every sensor per row.
        """
        names = ["voltage"] if self.sensors == 1 else [f"voltage {number}" for number in range(1, self.sensors + 1)]
        columns = read_columns(self.path, {"force": "N", **dict.fromkeys(names, "V")}, complete=True)
        voltage = np.stack([columns[name] for name in names], axis=1)
        return columns["force"], voltage, chain.converter.at_end(voltage)
