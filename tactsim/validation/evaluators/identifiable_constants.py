"""How many combinations of the constants of Table 4.1 its data can determine."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.analytic.atrial import table_4_1
from tactsim.validation.atrial_units import FREQUENCIES, numbered_units
from tactsim.validation.evaluator import Evaluator, Inputs


class IdentifiableConstants(Evaluator):
    """Number of singular values of ``sensitivities`` above a relative error of the data.

    A change of the constants by a factor of e along any other direction is lost in that error.
    """

    kind: Literal["identifiable_constants"] = "identifiable_constants"
    data_error: Annotated[float, Field(gt=0, lt=1)]
    """Relative error of each compliance."""

    @classmethod
    def example(cls) -> Self:
        """Compliances to one percent."""
        return cls(data_error=0.01)

    def found(self, inputs: Inputs) -> float:
        """A count."""
        return float((np.linalg.svd(sensitivities(), compute_uv=False) > self.data_error).sum())


def sensitivities() -> np.ndarray:
    r"""How the eight elastic and eight viscous compliances of eq. 4.3.8 change with the 17 constants, shape (16, 17).

    .. math::
        \frac{\partial \ln (D_e, D_v)(\omega_j)}{\partial \ln (E_0, \ldots, E_8, \tau_1, \ldots, \tau_8)}, \quad
        D^* = \frac{1}{E_0} + \sum_i \frac{1}{E_i (1 + i \omega \tau_i)}
    """
    compliances, times = numbered_units("retardation_times")
    glassy = np.full((FREQUENCIES.size, 1), table_4_1().glassy_compliance + 0j)
    phase = 2j * np.pi * FREQUENCIES[:, None] * times
    units = compliances / (1 + phase)
    total = glassy + units.sum(axis=1, keepdims=True)
    columns = np.hstack([-glassy, -units, -units * phase / (1 + phase)])
    return np.vstack([columns.real / total.real, columns.imag / total.imag])
