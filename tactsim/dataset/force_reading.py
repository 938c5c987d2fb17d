"""A stored force as a sensor reads it: film, electronics and calibration, with the noise of the sample's own seed."""

from __future__ import annotations

import numpy as np

from tactsim.sensors.force_electronics import ForceElectronics

Array = np.ndarray


class ForceReading(ForceElectronics):
    """A sensor under the whole force of a history."""

    def read(self, time: Array, force: Array, at: Array, generator: np.random.Generator) -> dict[str, Array]:
        """``voltage`` in V after the low pass and ``read_force`` in N at the times ``at`` in s.

        Forces (n,) in N at times (n,) in s are linear between these; a sensor cannot be pulled, so pulls read as no force.
        """
        found = self.sensed(time, force, generator)
        sample = latest(found.time, at)
        return {"voltage": found.recording.filtered[sample], "read_force": found.force[sample]}


def latest(times: Array, at: Array) -> Array:
    """Index of the last of increasing ``times`` in s that is not after each time in ``at``."""
    return np.clip(np.searchsorted(times, at * (1 + 1e-12), side="right") - 1, 0, len(times) - 1)
