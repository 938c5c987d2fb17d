"""Whether two measurements rank the same things alike."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.errors import InputError
from tactsim.validation.evaluator import Evaluator, Inputs

Ranked = Annotated[tuple[float, ...], Field(min_length=2)]


class RankingAgreement(Evaluator):
    r"""Kendall's rank correlation, 1 if every pair is ordered alike.

    .. math:: \tau = \frac{2}{n (n - 1)} \sum_{i < j} \mathrm{sgn}(x_i - x_j)\, \mathrm{sgn}(y_i - y_j)

    Source: Kendall 1938, doi:10.1093/biomet/30.1-2.81.
    """

    kind: Literal["ranking_agreement"] = "ranking_agreement"
    first: Ranked
    """One measurement of each thing."""
    second: Ranked
    """Another measurement of each, in the same order."""

    @classmethod
    def example(cls) -> Self:
        """Three elastomers by durometer and by hand."""
        return cls(first=(48, 45, 42), second=(7, 6, 5))

    def found(self, inputs: Inputs) -> float:
        """Dimensionless, from -1 to 1."""
        if len(self.first) != len(self.second):
            raise InputError(f"{len(self.first)} numbers cannot be ranked against {len(self.second)}")
        pairs = [(i, j) for i in range(len(self.first)) for j in range(i)]
        return sum(_sign(self.first, *pair) * _sign(self.second, *pair) for pair in pairs) / len(pairs)


def _sign(values: tuple[float, ...], i: int, j: int) -> int:
    return (values[i] > values[j]) - (values[i] < values[j])
