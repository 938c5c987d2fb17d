"""Place, radius and contrast of one lump by Bayes' rule on the fast forward model, with their uncertainty."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Estimator
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.localization.candidates import (
    BALL_RADII,
    RadiusLimits,
    ball_candidates,
    balls_between,
    gap_in,
    limits_in,
    radius_steps,
)
from tactsim.localization.evidence import Change, noise_evidence, over_errors
from tactsim.localization.posterior import covariance_about, likely_bodies
from tactsim.localization.reference_errors import (
    OTHER_TISSUE,
    SAME_TISSUE,
    TAXEL_ERROR,
    UNCHANGED,
    ReferenceErrors,
    ReferenceFit,
    factor_words,
    fitted,
    stated_factor,
    without_error,
)
from tactsim.localization.region import CellRegion
from tactsim.localization.separate_places import rises_apart
from tactsim.units import Length, NonNegative, Positive

EVERY, COARSE = 2, 4
"""Spacing, in tabulated centres, of the balls of which pairs are made, and of those that are tried in all pairs."""
SEED = 1
"""Of the draws by which pairs are averaged."""


class ModelBasedEstimator(Estimator):
    r"""One ball anywhere in the block, or nothing; two where one does not explain the readings.

    The change d of the taxels' forces from the reference is c s(x, r) plus Gaussian errors of covariance S, with the response s
    of a ball at x of radius r. The contrast c has a normal prior and is integrated out; centres and radii are even over the grid
    of the response:

    .. math:: \ln p(d | x, r) = \frac{1}{2} \frac{(s \cdot S^{-1} d)^2}{s \cdot S^{-1} s + \sigma_c^{-2}}
        - \frac{1}{2} \ln\bigl(1 + \sigma_c^2\, s \cdot S^{-1} s\bigr) + \text{const}

    .. math:: S = \bigl(2 \sigma^2 + e_m^2 \overline{a^2} + e_b^2 \overline{p^2}\bigr) 1 + \beta^2 p p^T

    with the noise of both readings, the error of the forward model over what the ball adds, a, and the reference p, which is
    known to e_b from taxel to taxel and to a common factor f of stiffness and gain of standard deviation beta
    (``reference_errors``): ``background_scale`` if it is of the same tissue, more by ``factor_spread`` if not, whichever makes
    the readings likelier. Mean, covariance and region are those of the posterior; the contrast is over the tissue that was read.
    Nothing is there if that explains d better; then S lacks the model's error.

    One ball that stands for two lies between them, where nothing is. So the evidence of one ball is held against that of two that
    do not overlap (``evidence``), with the same S, on a coarser grid. Two are the answer if they are likelier, if the readings
    rise at separate places (``separate_places``), or if the mean place lies outside its own region, as between two places where
    one ball could be. Where they are nearer to each other in plan than the pitch of the taxels, two may be one of another shape:
    the answer is one ball then, and says that two explain the readings better.

    Source: D. J. C. MacKay 1992, doi:10.1162/neco.1992.4.3.415, for the evidence; the response is that of ``lump_response``.
    """

    needs_response: ClassVar[bool] = True
    kind: Literal["model_based"] = "model_based"
    radii: RadiusLimits | None = None
    """Least and largest radius; by default 2 and 7 mm, in a block thinner than 20 mm 0.1 and 0.35 of its least side."""
    gap: NonNegative[Length] | None = None
    """Least distance of the ball from the faces of the block; by default 0.5 mm, in a block thinner than 20 mm
    0.025 of its least side."""
    contrast_spread: Positive[float] = 5.0
    """Standard deviation of the contrast beforehand; 5/2 is a small rigid ball, large ones act several times more."""
    model_error: Annotated[float, Field(ge=0, le=1)] = 0.35
    """Error of the forward model over the root mean square of the change; the default is the least of five at which nine in
    ten of the 90 % regions held the lump, in 38 grasps of another seed than those of ``sweep_judged``."""
    background_scale: Annotated[float, Field(ge=0, le=1)] = SAME_TISSUE
    """Error of the whole reference over itself where it is of the same tissue: the closing and friction are not known exactly."""
    factor_spread: Annotated[float, Field(ge=0, le=1)] = OTHER_TISSUE
    """Standard deviation of the common factor of stiffness and gain where it is of another tissue, or read by other sensors; as
    likely beforehand as the same tissue. 0 if it cannot be another."""
    background_error: Annotated[float, Field(ge=0, le=1)] = TAXEL_ERROR
    """Error of the reference from taxel to taxel over its root mean square."""
    prior: Annotated[float, Field(gt=0, lt=1)] = 0.5
    """Probability beforehand that anything is there."""
    second: Annotated[float, Field(ge=0, le=1)] = 0.2
    """Prior probability of two balls over that of one, as that of ``hypotheses``; 0 for one ball whatever is read."""

    @property
    def title(self) -> str:
        """Its name in words."""
        return "Model based: one lump"

    @classmethod
    def example(cls) -> Self:
        """Lumps of 2 to 7 mm."""
        return cls()

    def estimate(self, readings: Readings) -> Estimate:
        """One ball, none or two, with the covariance of place, radius and contrast, and the region of each centre.

        Raises
        ------
        InputError
            If the readings lack a reference without a lump or the response of the tissue.
        """
        if readings.difference is None or readings.response is None or readings.reference is None:
            raise InputError("the model-based estimator needs a reference without a lump and the response of the tissue")
        trusted = readings.trusted
        change, plain = (values[trusted] for values in (readings.difference, np.asarray(readings.reference, dtype=float)))
        limits, gap = limits_in(readings.block_size, self.radii, BALL_RADII), gap_in(readings.block_size, self.gap)
        candidates = balls_between(readings.response, readings.block_size, limits, gap=gap).felt_by(trusted)
        balls = candidates.geometry
        priors = self._errors(plain, readings.noise)
        if any(without_error(change, errors) for errors in priors):
            return Estimate(False, (), UNCHANGED, 0.0)
        fits = [fitted(candidates.signals, change, errors, self.contrast_spread) for errors in priors]
        fit = max(fits, key=lambda one: one.likelihood)
        probability = self._probability(fits)
        if probability < 0.5:
            bare = stated_factor(fit.bare_factor, self.factor_spread)
            reason = f"no inclusion (probability {1 - probability:.3g})"
            return Estimate(False, (), reason + factor_words(bare), probability, factor=bare)
        factor = stated_factor(fit.factor, self.factor_spread)
        weights = fit.weights
        samples = np.column_stack([balls.centers, balls.radii, fit.contrasts / fit.factor])
        region = CellRegion.of_centres(readings.response.axes, balls.centers, weights)
        mean = weights @ samples
        covariance = covariance_about(mean, samples, weights, spreads=fit.spreads / fit.factor**2, cell=region.cell)
        x, y, z, radius, contrast = map(float, mean)
        pair = self._pair(readings, fit, between=not region.contains(mean[:3]))
        near = pair is not None and _apart(pair) < readings.layout.pitch
        if pair is not None and not near:
            return replace(pair, reason=pair.reason + factor_words(factor), probability=probability, factor=factor)
        ball = EstimatedInclusion("sphere", (x, y, z), radius, contrast, covariance, region)
        reason = f"a {'softer' if contrast < 0 else 'stiffer'} ball with a probability of {probability:.3g}"
        if pair is not None:
            reason += f", though {pair.reason}; nearer to each other than the taxels, they may be one of another shape"
        return Estimate(True, (ball,), reason + factor_words(factor), probability, factor=factor)

    def _pair(self, readings: Readings, fit: ReferenceFit, *, between: bool) -> Estimate | None:
        """Two balls, if they are likelier than the one of a ``fit`` on the finest grid; None if not.

        ``between``: the mean place of one ball lies where it hardly can be, between several places where it can.
        """
        response, size, difference = readings.response, readings.block_size, readings.difference
        if self.second == 0 or response is None or difference is None:
            return None
        radii, gap = radius_steps(limits_in(size, self.radii, BALL_RADII), size), gap_in(size, self.gap)
        fine, coarse = (
            over_errors(ball_candidates(response, size, tried, gap=gap, every=every).felt_by(readings.trusted), fit)
            for tried, every in ((radii, EVERY), (radii[1::2], COARSE))
        )
        white = Change.of_fit(fit, self.contrast_spread)
        two = white.double(fine, coarse, np.random.default_rng(SEED))
        if not np.isfinite(two.evidence):
            return None
        single = max(fit.total + noise_evidence(white.values), white.single(fine).evidence)
        odds = self.second * float(np.exp(np.clip(two.evidence - single, -700, 700)))
        apart = rises_apart(difference - (fit.factor - 1) * np.asarray(readings.reference), readings.noise)
        if odds <= 1 and not apart and not between:
            return None
        cell = EVERY * np.array([float(axis[1] - axis[0]) for axis in response.axes])
        bodies = likely_bodies(two, fine, cell)
        words = f"two balls explain the readings better than one, with a probability of {odds / (1 + odds):.3g}"
        if odds <= 1:
            why = (
                "the sums of both jaws fall between them"
                if apart
                else "one ball could be in several places, none of them between"
            )
            words = f"two places explain the readings better than one, as {why}"
        return Estimate(True, bodies, words)

    def _errors(self, plain: Array, noise: float) -> list[ReferenceErrors]:
        """Of a reference p (taxels,) in N of the same tissue, and of another."""
        factors = [self.background_scale, float(np.hypot(self.background_scale, self.factor_spread))]
        return [ReferenceErrors(plain, noise, self.background_error, factor, self.model_error) for factor in sorted(set(factors))]

    def _probability(self, fits: list[ReferenceFit]) -> float:
        """Of anything being there; each prior of the factor is as likely as the other."""
        none = np.logaddexp.reduce([fit.evidence_of_none for fit in fits])
        body = np.logaddexp.reduce([fit.evidence_of_body for fit in fits])
        return float(1 / (1 + (1 - self.prior) / self.prior * np.exp(np.clip(none - body, -700, 700))))


def _apart(pair: Estimate) -> float:
    """Distance in plan of two bodies in m."""
    first, other = (np.array(body.center[:2]) for body in pair.inclusions)
    return float(np.linalg.norm(first - other))
