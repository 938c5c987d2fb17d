"""Noise that a channel adds to the voltage of its sensor."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.units import Frequency, NonNegative, Voltage


class Noise(FrozenModel):
    r"""White noise, independent per sample and channel, and pick-up of the power line with one phase per channel.

    .. math:: e_k = w_k + a \sin(2 \pi f t_k + \varphi), \qquad w_k \sim N(0, s^2)

    The thesis names the 60 Hz pick-up (3.1.2, 6.4) without its size; both sizes are declared by the user, zero by default.
    """

    white: NonNegative[Voltage] = 0.0
    """Root mean square ``s`` of the white noise of a sample, all of it between 0 Hz and half the sampling rate."""
    line: NonNegative[Voltage] = 0.0
    """Amplitude ``a`` of the pick-up."""
    line_frequency: Annotated[Frequency, Field(gt=0, le=1e9)] = 60.0
    """Frequency ``f`` of the power line."""

    @property
    def silent(self) -> bool:
        """Whether it adds nothing."""
        return self.white == 0 and self.line == 0

    def phases(self, channels: tuple[int, ...], generator: np.random.Generator | None) -> Array:
        """Phases in rad of the pick-up, one per channel, uniform over the circle; zeros, undrawn, without pick-up.

        Raises
        ------
        InvalidQuantity
            If there is pick-up and no generator.
        """
        if self.line == 0:
            return np.zeros(channels)
        return 2 * np.pi * required(generator).random(channels)

    def sample(self, time: Array, phases: Array, generator: np.random.Generator | None) -> Array:
        """Noise in V at times in s, shape ``(time, *channels)``.

        Samples are drawn in the order of time, so consecutive calls with one generator give the noise of one long call.

        Raises
        ------
        InvalidQuantity
            If there is white noise and no generator.
        """
        shape = (time.size, *phases.shape)
        noise = self.white * required(generator).standard_normal(shape) if self.white else np.zeros(shape)
        if self.line:
            angle = 2 * np.pi * self.line_frequency * time
            noise += self.line * np.sin(angle.reshape(-1, *[1] * phases.ndim) + phases)
        return noise


def required(generator: np.random.Generator | None) -> np.random.Generator:
    """The random generator that noise needs.

    Raises
    ------
    InvalidQuantity
        If there is none.
    """
    if not isinstance(generator, np.random.Generator):
        raise InvalidQuantity("a chain with noise needs a random generator; pass numpy.random.default_rng(seed)")
    return generator
