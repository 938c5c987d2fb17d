"""Relaxation of a material as plain values: a Prony series of its isochoric stress."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.model import FrozenModel
from tactsim.units import Positive, Time

SHORTEST, LONGEST = 1e-12, 1e12
"""Relaxation times in s; beyond, nothing is measured and steps of time drown in round-off."""


class Relaxation(FrozenModel):
    r"""The isochoric stress relaxes as the fading memory of its own history.

    .. math::
        S(t) = \int_0^t g(t - s)\, \frac{\partial S_e}{\partial s}\, ds + p J C^{-1}, \qquad
        g(t) = g_\infty + \sum_i g_i e^{-t / \tau_i}

    with :math:`S_e` the isochoric second Piola-Kirchhoff stress of the energy. The constants of the energy are those at once
    (:math:`g(0) = 1`) or those after infinite time (:math:`g(\infty) = 1`).

    >>> import tactsim as ts
    >>> memory = ts.Relaxation(fractions=(0.3, 0.2), times=("0.1 s", "2 s"))
    >>> tissue = ts.NeoHookean(c10="3 kPa", relaxation=memory)
    >>> tissue.relaxation.times
    (0.1, 2.0)

    Source: Simo 1987, doi:10.1016/0045-7825(87)90107-1; Holzapfel 2000, Nonlinear Solid Mechanics, section 6.10.
    """

    fractions: Annotated[tuple[Annotated[float, Field(gt=0, lt=1)], ...], Field(min_length=1)]
    """Parts of the instantaneous modulus that relax; their sum is below 1."""
    times: Annotated[tuple[Positive[Time], ...], Field(min_length=1)]
    """Relaxation time of each part."""
    constants: Literal["instantaneous", "equilibrium"] = "instantaneous"
    """Whether the constants of the material hold at once or after infinite time."""

    @model_validator(mode="after")
    def _fades(self) -> Self:
        if len(self.fractions) != len(self.times):
            raise ValueError(f"{len(self.fractions)} fractions and {len(self.times)} times; each fraction needs its time")
        for time in self.times:
            if not SHORTEST <= time <= LONGEST:
                raise ValueError(f"a relaxation time of {time:g} s; allowed are {SHORTEST:g} s to {LONGEST:g} s")
        if sum(self.fractions) >= 1:
            raise ValueError(f"the fractions add up to {sum(self.fractions):.9g}; a solid needs less than 1")
        return self

    @property
    def when_constants_hold(self) -> str:
        """``constants`` in words, "at once" or "in the end"."""
        return "at once" if self.constants == "instantaneous" else "in the end"

    @property
    def amplitudes(self) -> tuple[float, Array, Array]:
        """Equilibrium part, relaxing parts (n,) and their times (n,) in s, as multiples of the energy's own constants."""
        fractions, times = np.array(self.fractions), np.array(self.times)
        remaining = 1.0 - float(fractions.sum())
        scale = 1.0 if self.constants == "instantaneous" else 1.0 / remaining
        return scale * remaining, scale * fractions, times
