"""A stored force as a sensor reads it: film, electronics and calibration, with the noise of the sample's own seed."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.recording import ForceReader
from tactsim.sensors.electronics.force_electronics import ForceElectronics

CLEAN = "_clean"
"""How the names of readings without noise end."""


class ForceReading(ForceElectronics, ForceReader):
    """A sensor under the whole force of a history."""

    def read(self, time: Array, force: Array, at: Array, generator: np.random.Generator) -> dict[str, Array]:
        """``voltage`` in V after the low pass and ``read_force`` in N at times ``at`` in s, and both without noise (``_clean``).

        Forces (n,) in N at times (n,) in s are linear between these; a sensor cannot be pulled, so pulls read as no force.
        """
        read: dict[str, Array] = {}
        for electronics, ending in ((self, ""), (self.quiet, CLEAN)):
            sensed = electronics.sensed(time, force, generator)
            sample = latest(sensed.time, at)
            read |= {f"voltage{ending}": sensed.recording.filtered[sample], f"read_force{ending}": sensed.force[sample]}
        return read


def read_variables(
    voltage: str = "voltage after the low pass", force: str = "force by the calibration"
) -> dict[str, tuple[str, str]]:
    """Unit and description by name of what is read, with noise and without."""
    variables: dict[str, tuple[str, str]] = {}
    for ending, words in (("", "with noise"), (CLEAN, "without noise: what film, electronics and calibration alone make of it")):
        variables |= {f"voltage{ending}": ("V", f"{voltage}, {words}"), f"read_force{ending}": ("N", f"{force}, {words}")}
    return variables


READ = read_variables()
"""Of one sensor."""


def latest(times: Array, at: Array) -> Array:
    """Index of the last of increasing ``times`` (n,) in s that is not after each time in ``at``, of its shape."""
    return np.clip(np.searchsorted(times, at * (1 + 1e-12), side="right") - 1, 0, len(times) - 1)
