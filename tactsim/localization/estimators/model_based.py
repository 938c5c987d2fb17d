"""Place, radius and contrast of one lump by Bayes' rule on the fast forward model, with their uncertainty."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field
from scipy.special import logsumexp

from tactsim.errors import InputError
from tactsim.localization.interface import Estimate, EstimatedInclusion, Estimator, Readings
from tactsim.localization.lump_response import LumpResponse
from tactsim.units import Length

Array = np.ndarray


class ModelBasedEstimator(Estimator):
    r"""One ball anywhere in the block, or nothing.

    The change d of the taxels' forces from the reference is c s(x, r) plus Gaussian errors, with the response s of a ball at x of
    radius r. The contrast c has a normal prior and is integrated out; centres and radii are even over the grid of the response:

    .. math:: \ln p(d | x, r) = -\frac{1}{2 v} \Bigl(d^2 - \frac{(s \cdot d)^2}{s^2 + v / \sigma_c^2}\Bigr)
        - \frac{1}{2} \ln\Bigl(1 + \frac{s^2 \sigma_c^2}{v}\Bigr)

    The variance v is that of both readings and of the forward model, ``model_error`` of the root mean square of d. Mean and
    covariance are those of the posterior. Nothing is there if that explains d better.

    Source: D. J. C. MacKay 1992, doi:10.1162/neco.1992.4.3.415, for the evidence; the response is that of ``lump_response``.
    """

    needs_response: ClassVar[bool] = True
    kind: Literal["model_based"] = "model_based"
    radii: tuple[Annotated[Length, Field(gt=0)], Annotated[Length, Field(gt=0)]] = (2e-3, 7e-3)
    """Least and largest radius."""
    gap: Annotated[Length, Field(ge=0)] = 0.5e-3
    """Least distance of the ball from the faces of the block."""
    contrast_spread: Annotated[float, Field(gt=0)] = 5.0
    """Standard deviation of the contrast beforehand; 5/2 is a small rigid ball, large ones act several times more."""
    model_error: Annotated[float, Field(ge=0, le=1)] = 0.12
    """Error of the forward model over the root mean square of the change."""
    prior: Annotated[float, Field(gt=0, lt=1)] = 0.5
    """Probability beforehand that anything is there."""

    @classmethod
    def example(cls) -> Self:
        """Lumps of 2 to 7 mm."""
        return cls()

    def estimate(self, readings: Readings) -> Estimate:
        """At most one ball, with the covariance of place, radius and contrast."""
        if readings.difference is None or readings.response is None:
            raise InputError("the model-based estimator needs a reference without a lump and the response of the tissue")
        change = readings.difference.ravel()
        noise = 2 * readings.noise**2
        centers, radii, signals = self._candidates(readings.response, readings.block_size)
        variance = noise + self.model_error**2 * float(np.mean(change**2))
        if variance == 0:
            return Estimate(False, (), "nothing there: the readings are those of the reference", 0.0)
        strength, along = (signals**2).sum(axis=1), signals @ change
        stiff = strength + variance / self.contrast_spread**2
        evidence = along**2 / stiff / (2 * variance) - np.log(stiff * self.contrast_spread**2 / variance) / 2
        total, weights = logsumexp(evidence) - np.log(len(evidence)), np.exp(evidence - logsumexp(evidence))
        probability = self._probability(total, change, noise, variance)
        contrasts, spread = along / stiff, variance / stiff
        samples = np.column_stack([centers, radii, contrasts])
        mean = weights @ samples
        away = samples - mean
        covariance = (weights[:, None] * away).T @ away
        covariance[4, 4] += weights @ spread
        if probability < 0.5:
            return Estimate(False, (), f"nothing there with a probability of {1 - probability:.3g}", probability)
        x, y, z, radius, contrast = map(float, mean)
        found = EstimatedInclusion("sphere", (x, y, z), radius, contrast, covariance)
        words = "softer" if mean[4] < 0 else "stiffer"
        return Estimate(True, (found,), f"a {words} ball with a probability of {probability:.3g}", probability)

    def _candidates(self, response: LumpResponse, size: Array) -> tuple[Array, Array, Array]:
        """Centres (n, 3), radii (n,) and signals (n, taxels) of all balls of the table that fit into the block."""
        chosen = np.flatnonzero((response.radii >= self.radii[0] - 1e-12) & (response.radii <= self.radii[1] + 1e-12))
        if not len(chosen):
            raise InputError(f"no tabulated radius lies between {self.radii[0]:g} and {self.radii[1]:g} m")
        grid = np.stack(np.meshgrid(*response.axes, indexing="ij"), axis=-1).reshape(-1, 3)
        room = np.minimum(grid, size - grid).min(axis=1)
        parts = []
        for k in chosen:
            fits = room >= response.radii[k] + self.gap
            values = response.values[k].reshape(len(grid), -1)[fits]
            parts.append((grid[fits], np.full(int(fits.sum()), response.radii[k]), values))
        centers, radii, signals = (np.concatenate(part) for part in zip(*parts, strict=True))
        return centers, radii, signals

    def _probability(self, total: float, change: Array, noise: float, variance: float) -> float:
        """Of anything being there, from the evidence ``total`` over that of errors of ``variance`` alone."""
        if noise == 0:
            return 1.0
        power, count = float(change @ change), change.size
        nothing = -power / (2 * noise) - count / 2 * np.log(noise)
        something = total - power / (2 * variance) - count / 2 * np.log(variance)
        return float(1 / (1 + (1 - self.prior) / self.prior * np.exp(np.clip(nothing - something, -700, 700))))
