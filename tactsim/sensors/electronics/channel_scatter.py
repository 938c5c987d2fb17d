"""Scatter from sensor to sensor of a matrix: seeded gains of the conductance."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.sensors.electronics.calibration import LinearCalibration
from tactsim.units import Force, NonNegative, Positive

GAINS = 1
"""Names the stream of random numbers: the noise of a reading, which may have the same seed, draws others."""


class ChannelScatter(FrozenModel):
    r"""Gain of every channel's conductance, so large that a reading at full scale has the stated standard deviation.

    .. math:: C_k' = g_k C_k, \qquad g_k = 1 + \frac{r F_s}{F_s + n/m} N(0, 1)

    A channel that is read by a line ``C = m F + n`` then errs by ``(g - 1)(F + n/m)`` at the force F, by ``r F_s`` in the root
    mean square at the full scale ``F_s``.

    Source: thesis, 6.2: repeatability of 2.5 % of full scale, calibrated in 0 to 20 N. Assumed, as the thesis does not say it:
    the 2.5 % are one standard deviation, Gaussian, independent between channels, constant during a recording, and come from the
    sensor's gain, so that they shrink with the force.
    """

    repeatability: Annotated[float, Field(ge=0, le=0.1)] = 0.025
    """Standard deviation ``r`` of the force at full scale, over the full scale."""
    full_scale: Positive[Force] = 20.0
    """``F_s``."""
    seed: NonNegative[int] = 1
    """The same seed gives the same channels."""

    def gains(self, channels: tuple[int, ...], line: LinearCalibration) -> Array:
        """Factor on the conductance of every channel, of the shape of the channels, like (jaw, row, column).

        Raises
        ------
        InvalidQuantity
            If the line does not conduct at full scale, or a gain is not positive.
        """
        reach = self.full_scale + line.intercept / line.slope
        if reach <= 0:
            raise InvalidQuantity(
                f"the line does not conduct at the full scale of {self.full_scale:g} N; lower the intercept's size"
            )
        spread = self.repeatability * self.full_scale / reach
        gains = 1 + spread * np.random.default_rng([GAINS, self.seed]).standard_normal(channels)
        if not np.all(gains > 0):
            raise InvalidQuantity(
                f"a spread of {spread:g} makes a gain negative; lower the repeatability or the intercept's size"
            )
        return gains
