"""What data determine of the constants of the generalized Kelvin model, and what they do not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.identification.dma_least_squares import PRIOR_DEVIATION, DmaFit
from tactsim.identification.dma_objective import part_sensitivities
from tactsim.identification.dma_spectrum import relative_noise

DETERMINED = 0.5
"""Assumption: data determine a constant, or a product of powers of them, if the standard error of its logarithm is below this."""


@dataclass(frozen=True, eq=False)
class Determination:
    """Which constants, and how many combinations of them, data determine at their noise."""

    names: tuple[str, ...]
    values: Array
    """The constants in SI, shape (p,)."""
    relative_errors: Array
    """Standard errors of their logarithms under the broad prior of a factor of ten, shape (p,); 2.3 is the prior's own."""
    singular_values: Array
    """Of the sensitivity of the data, over their noise, to the log constants, decreasing, shape (min(2n, p),)."""
    directions: Array
    """Rows: the combinations of log constants that belong to the singular values, unit vectors, shape (min(2n, p), p)."""
    data_count: int
    noise: float
    """Root mean square relative noise."""

    @property
    def determined(self) -> Array:
        """Whether the data determine each constant, shape (p,)."""
        return self.relative_errors < DETERMINED

    @property
    def determined_combinations(self) -> int:
        """Number of independent combinations of log constants whose standard error is below ``DETERMINED``."""
        return int((self.singular_values * DETERMINED > 1).sum())

    def statement(self) -> str:
        """The finding in one sentence."""
        determined = [name for name, yes in zip(self.names, self.determined, strict=True) if yes]
        hidden = [name for name, yes in zip(self.names, self.determined, strict=True) if not yes]
        numbers = f"{self.data_count} numbers with a relative noise of {self.noise:.2g} determine"
        if not hidden:
            return f"{numbers} each of the {len(self.names)} constants"
        combinations = f"{numbers} {self.determined_combinations} combinations of the {len(self.names)} constants"
        alone = f"{', '.join(determined)} alone, and do not determine {', '.join(hidden)}" if determined else "none of them alone"
        return f"{combinations}; they determine {alone}: trust the curves, not the constants"


def determination(fit: DmaFit) -> Determination:
    r"""What the data of a fit determine of its constants.

    With the sensitivity :math:`S_{kj} = \frac{1}{\sigma_k D_k} \frac{\partial D_k}{\partial \ln p_j}`, the standard error of a
    combination along a singular vector of S is the inverse of its singular value, and that of each log constant follows from the
    covariance :math:`(S^T S + 1 / (\ln 10)^2)^{-1}`.

    Source: errata E23; Gutenkunst et al. 2007, doi:10.1371/journal.pcbi.0030189 (such "sloppy" spectra).
    """
    noise = relative_noise(fit.data)
    logarithms = fit.constants.logarithms
    slopes = part_sensitivities(logarithms, fit.data.frequencies) / (noise * fit.data.parts)[..., None]
    sensitivity = slopes.reshape(-1, logarithms.size)
    _, singular, directions = np.linalg.svd(sensitivity, full_matrices=False)
    hidden = 1 - (directions**2).sum(axis=0)
    variance = PRIOR_DEVIATION**2 * np.maximum(hidden, 0)
    variance += (directions**2 / (singular**2 + PRIOR_DEVIATION**-2)[:, None]).sum(axis=0)
    return Determination(
        names=fit.constants.names,
        values=np.exp(logarithms),
        relative_errors=np.sqrt(variance),
        singular_values=singular,
        directions=directions,
        data_count=noise.size,
        noise=float(np.sqrt(np.mean(noise**2))),
    )
