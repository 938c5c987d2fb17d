"""Nothing, one lump, two lumps, an artery or two: the likeliest by Bayes' rule on the fast forward model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
import scipy
from pydantic import Field

from tactsim.array import Array
from tactsim.deadline import check_time
from tactsim.errors import InputError
from tactsim.interfaces import Estimator
from tactsim.interfaces.estimate import Estimate
from tactsim.interfaces.readings import Readings, TissueResponse
from tactsim.localization.candidates import (
    BALL_RADII,
    TUBE_RADII,
    Candidates,
    RadiusLimits,
    ball_candidates,
    gap_in,
    limits_in,
    radius_steps,
    tube_candidates,
)
from tactsim.localization.evidence import Change, Explanation, over_errors
from tactsim.localization.posterior import likely_bodies
from tactsim.localization.reference_errors import (
    OTHER_TISSUE,
    TAXEL_ERROR,
    UNCHANGED,
    ReferenceErrors,
    ReferenceFit,
    factor_words,
    fitted,
    stated_factor,
    without_error,
)
from tactsim.units import Length, NonNegative, Positive

ClassName = Literal["lump", "two_lumps", "artery", "two_arteries"]
CLASSES: tuple[str, ...] = ("none", "lump", "two_lumps", "artery", "two_arteries")
"""The classes, in the order of every table."""
PAIRS = ("two_lumps", "two_arteries")
WORDS = {"lump": "one lump", "two_lumps": "two lumps", "artery": "an artery", "two_arteries": "two arteries"}
COARSE = 4
"""Spacing, in tabulated centres, of the balls that are tried in all pairs."""
COARSE_SPACING, FINE_SPACING = 4e-3, 2e-3
"""Distance in m of the parallel tubes that are tried in all pairs, and in the best ones."""


@dataclass(frozen=True)
class ExplainedChange:
    """What a class explains of a change of the forces.

    Parameters
    ----------
    log_density : of the change under the class
    bodies : that explain it
    candidates : that were tried, in deviations
    """

    log_density: float
    bodies: Explanation
    candidates: Candidates


class HypothesesEstimator(Estimator):
    r"""Which of several classes explains the change of the taxels' forces, and where its one or two inclusions lie.

    A class is a set of bodies: balls anywhere in the block; straight level tubes in any direction, through the block or ending
    in it; pairs of balls, or of tubes through the block, that do not overlap. Each body changes the forces by its contrast,
    which is integrated out, times the response of the tissue; the response of a tube is the integral along its line. The
    evidence of a class is the mean over its bodies, so that a second body must explain more than it costs (Occam's razor):

    .. math:: P(k | d) \propto P(k)\, \langle p(d | \text{bodies}) \rangle_k

    Place, radius and contrast are means of the posterior of the likeliest class, with their covariance; the line of a tube is
    the likeliest one. The reference is exact, or of another tissue and wrong by a common factor of stiffness and gain, fitted
    with one ball or none, and from taxel to taxel (``reference_errors``). To first order a tube acts by its whole section, with
    one contrast for wall and lumen together: an empty soft one is softer than the tissue. The wall's thickness and a pressure
    cannot be determined.

    Source: D. J. C. MacKay 1992, doi:10.1162/neco.1992.4.3.415, for the evidence; the response is that of ``lump_response``.
    """

    needs_response: ClassVar[bool] = True
    gives_classes: ClassVar[bool] = True
    kind: Literal["hypotheses"] = "hypotheses"
    classes: Annotated[tuple[ClassName, ...], Field(min_length=1)] = ("lump", "two_lumps", "artery", "two_arteries")
    """Classes that are considered."""
    radii: RadiusLimits | None = None
    """Least and largest radius of a lump; by default 2 and 7 mm, in a block thinner than 20 mm 0.1 and 0.35 of its least side."""
    tube_radii: RadiusLimits | None = None
    """Least and largest outer radius of an artery; by default 2 and 5 mm, in a block thinner than 20 mm 0.1 and 0.25 of
    its least side."""
    gap: NonNegative[Length] | None = None
    """Least distance of a body from the faces of the block that it does not leave through; by default 0.5 mm, in a block
    thinner than 20 mm 0.025 of its least side."""
    contrast_spread: Positive[float] = 5.0
    """Prior standard deviation of the contrast."""
    model_error: Annotated[float, Field(ge=0, le=1)] = 0.2
    """Error of the forward model over the root mean square of the change."""
    factor_spread: Annotated[float, Field(ge=0, le=1)] = OTHER_TISSUE
    """Standard deviation of the common factor of stiffness and gain where the reference is of another tissue, or was read by
    other sensors; as likely beforehand as the same tissue, of which it is taken as exact. 0 if it cannot be another."""
    background_error: Annotated[float, Field(ge=0, le=1)] = TAXEL_ERROR
    """Error of a reference of another tissue from taxel to taxel, beside the factor, over its root mean square."""
    prior: Annotated[float, Field(gt=0, lt=1)] = 0.5
    """Prior probability of any inclusion."""
    second: Annotated[float, Field(gt=0, le=1)] = 0.2
    """Prior probability of a class of two over that of one: readings say nothing of a second one too weak to be felt."""
    seed: NonNegative[int] = 1
    """Seed of the draws by which pairs are averaged."""

    @property
    def title(self) -> str:
        """Its name in words."""
        return "Model based: lumps or arteries"

    @classmethod
    def example(cls) -> Self:
        """All classes."""
        return cls()

    def estimate(self, readings: Readings) -> Estimate:
        """None, one or two inclusions, and the probability of each class.

        Raises
        ------
        InputError
            If the readings lack a reference without a lump or the response of the tissue.
        """
        if readings.difference is None or readings.response is None:
            raise InputError("the estimator of hypotheses needs a reference without a lump and the response of the tissue")
        response, size = readings.response, readings.block_size
        values, priors = readings.difference[readings.trusted], self._priors(readings)
        if any(without_error(values, errors) for errors in priors):
            return Estimate(False, (), UNCHANGED, 0.0, self._probabilities({"none": 0.0}))
        balls = ball_candidates(response, size, self._ball_radii(size), gap=gap_in(size, self.gap)).felt_by(readings.trusted)
        fits = [fitted(balls.signals, values, errors, self.contrast_spread) for errors in priors]
        bodies = {str(name): self._bodies(name, balls, readings, response) for name in self.classes}
        explained = {name: [self._explained(name, fit, *some) for fit in fits] for name, some in bodies.items()}
        densities = {name: [one.log_density for one in each] for name, each in explained.items()}
        densities["none"] = [fit.evidence_of_none for fit in fits]
        probabilities = self._probabilities(
            {name: self._prior(name) + float(np.logaddexp.reduce(each)) for name, each in densities.items()}
        )
        likeliest = max(probabilities, key=lambda name: probabilities[name])
        probability, best = float(np.clip(1 - probabilities["none"], 0.0, 1.0)), int(np.argmax(densities[likeliest]))
        if likeliest == "none":
            factor = stated_factor(fits[best].bare_factor, self.factor_spread)
            reason = f"no inclusion (probability {probabilities['none']:.3g}){factor_words(factor)}"
            return Estimate(False, (), reason, probability, probabilities, factor)
        cell = np.array([float(axis[1] - axis[0]) for axis in response.axes])
        factor = stated_factor(fits[best].factor, self.factor_spread)
        chosen = explained[likeliest][best]
        inclusions = likely_bodies(chosen.bodies, chosen.candidates, cell)
        reason = f"{WORDS[likeliest]} with a probability of {probabilities[likeliest]:.3g}{factor_words(factor)}"
        return Estimate(True, inclusions, reason, probability, probabilities, factor)

    def _priors(self, readings: Readings) -> list[ReferenceErrors]:
        """Errors of a reference of the same tissue, and of another."""
        plain = np.asarray(readings.reference, dtype=float)[readings.trusted]
        same = ReferenceErrors(plain, readings.noise, 0.0, 0.0, self.model_error)
        other = ReferenceErrors(plain, readings.noise, self.background_error, self.factor_spread, self.model_error)
        return [same, other] if self.factor_spread > 0 else [same]

    def _explained(self, name: str, fit: ReferenceFit, candidates: Candidates, few: Candidates | None) -> ExplainedChange:
        """What a class explains of the change of a fit, by all its bodies and for pairs a few of them."""
        check_time()
        change, white = Change.of_fit(fit, self.contrast_spread), over_errors(candidates, fit)
        if few is None:
            bodies = change.single(white)
        else:
            generator = np.random.default_rng([self.seed, CLASSES.index(name)])
            bodies = change.double(white, over_errors(few, fit), generator)
        return ExplainedChange(fit.log_whitening + bodies.evidence, bodies, white)

    def _bodies(
        self, name: str, balls: Candidates, readings: Readings, response: TissueResponse
    ) -> tuple[Candidates, Candidates | None]:
        """The bodies of a class, those of lumps being ``balls``, and for pairs a few of them."""
        size, trusted = readings.block_size, readings.trusted
        gap = gap_in(size, self.gap)
        if name == "lump":
            return balls, None
        if name == "two_lumps":
            some = ball_candidates(response, size, self._ball_radii(size)[1::2], gap=gap, every=COARSE)
            return balls, some.felt_by(trusted)
        radii = radius_steps(limits_in(size, self.tube_radii, TUBE_RADII), size)
        if name == "artery":
            return tube_candidates(response, size, radii, gap=gap).felt_by(trusted), None
        few = tube_candidates(response, size, radii[1::2], gap=gap, closed=False, spacing=COARSE_SPACING).felt_by(trusted)
        lower = few.geometry.begins[:, 2]
        kept = few.chosen(np.isin(lower, np.unique(lower)[::COARSE]))
        fine = tube_candidates(response, size, radii, gap=gap, closed=False, spacing=FINE_SPACING).felt_by(trusted)
        return fine, kept

    def _ball_radii(self, size: Array) -> list[float]:
        """Radii in m of the balls that are tried in a block of this size (3,) in m."""
        return radius_steps(limits_in(size, self.radii, BALL_RADII), size)

    def _prior(self, name: str) -> float:
        """Log prior probability of a class."""
        if name == "none":
            return float(np.log(1 - self.prior))
        shares = {other: self.second if other in PAIRS else 1.0 for other in self.classes}
        return float(np.log(self.prior * shares[name] / sum(shares.values())))  # type: ignore[index]

    def _probabilities(self, evidence: dict[str, float]) -> dict[str, float]:
        """Posterior probability of each class from the log evidence; zero for classes that are not considered."""
        total = scipy.special.logsumexp(list(evidence.values()))
        return {name: float(np.exp(evidence[name] - total)) if name in evidence else 0.0 for name in CLASSES}
