"""What an identification from dynamic mechanical analysis reports: curves, quantities, and what the data leave open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.stats

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.array import Array
from tactsim.experiments.dma.scene import DmaScene, KelvinFit, ShownSignals
from tactsim.experiments.dma.source import SignalsAnalysis
from tactsim.identification.dma_bands import ComplianceBand
from tactsim.identification.dma_data import PARTS, DmaData, parts_of
from tactsim.identification.dma_determined import Determination
from tactsim.identification.dma_least_squares import DmaFit, fit_least_squares
from tactsim.identification.dma_spectrum import noise_is_known, relative_noise
from tactsim.interfaces.run import Findings
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord

METHODS = ("least_squares", "genetic")
HISTORY_UNITS = {
    "frequency": "Hz",
    **{f"measured_{part}_compliance": "1/Pa" for part in PARTS},
    **{f"{method}_{part}_compliance{end}": "1/Pa" for method in METHODS for part in PARTS for end in ("", "_lower", "_upper")},
    **{f"true_{part}_compliance": "1/Pa" for part in PARTS},
}
FAR_FROM_LEAST = 1.05
"""Ratio to the least of eq. 4.5.2 from which the search is said not to have reached it."""
BY_CHANCE = 1e-3
"""Chance with which noise alone leaves the residuals from which a warning says that the units do not describe the data."""
SHOWN_GENERATIONS = 50
"""Generations whose best objective is kept."""


@dataclass(frozen=True, eq=False)
class DmaFinding:
    """A fit, its band, and what the data determine of its constants."""

    fit: DmaFit
    band: ComplianceBand
    determination: Determination


class DmaReport:
    """Collects the fits of one set of data and turns them into a result."""

    def __init__(
        self,
        data: DmaData,
        frequencies: np.ndarray,
        model: GeneralizedKelvin | None,
        analysis: SignalsAnalysis | None = None,
    ):
        self.data, self.frequencies, self.analysis = data, frequencies, analysis
        self.truth = None if model is None else parts_of(model.complex_compliance(2 * np.pi * frequencies))
        self.fits: dict[str, DmaFinding] = {}
        self.timing: dict[str, float] = {}
        """How long each fit took, in s."""

    def steps(self) -> tuple[StepRecord, ...]:
        """One step per frequency; data stand only at theirs, no step without a fit."""
        if not self.fits:
            return ()
        return tuple(StepRecord(k + 1, 0, 0.0, self._row(k)) for k in range(self.frequencies.size))

    def _row(self, k: int) -> dict[str, float]:
        """History values at the k-th frequency."""
        values = {"frequency": float(self.frequencies[k])}
        for row in np.flatnonzero(self.data.frequencies == self.frequencies[k]):
            values |= {f"measured_{part}_compliance": float(self.data.parts[i, row]) for i, part in enumerate(PARTS)}
        for method, finding in self.fits.items():
            band = finding.band
            for i, part in enumerate(PARTS):
                name = f"{method}_{part}_compliance"
                values[name] = float(band.centre[i, k])
                values |= {f"{name}_lower": float(band.lower[i, k]), f"{name}_upper": float(band.upper[i, k])}
        if self.truth is not None:
            values |= {f"true_{part}_compliance": float(self.truth[i, k]) for i, part in enumerate(PARTS)}
        return values

    def findings(self, reason: str, assumptions: list[str]) -> Findings:
        """What every fit that was made says."""
        quantities = self._quantities()
        return Findings(
            reason,
            self.steps(),
            quantities=quantities,
            assumptions=assumptions,
            warnings=self._warnings(quantities),
            timing=self.timing,
            scene=self._scene(),
        )

    def _quantities(self) -> dict[str, Quantity]:
        quantities: dict[str, Quantity] = {}
        for method, finding in self.fits.items():
            quantities |= self._constants(finding, prefix="" if not quantities else f"{method}_")
        for method, finding in self.fits.items():
            quantities |= self._errors(method, finding)
        quantities |= self._moduli()
        if self.fits:
            least = fit_least_squares(self.data, self._units, weighting="objective").objective
            quantities["least_objective"] = Quantity(least, "1/Pa**2", "the least of eq. 4.5.2, by least squares without weights")
            determination = next(iter(self.fits.values())).determination
            quantities["relative_noise"] = Quantity(
                determination.noise, "1", "relative standard deviation of each number, known or estimated"
            )
            quantities["determined_combinations"] = Quantity(
                determination.determined_combinations,
                "1",
                f"combinations of the {len(determination.names)} constants that the data determine",
            )
        return quantities

    def _moduli(self) -> dict[str, Quantity]:
        """Storage and loss modulus at the frequencies of the data, with their standard errors if signals were analysed."""
        modulus, each = self.data.modulus, "at each frequency of the data"
        values = {"storage": modulus.real, "loss": modulus.imag}
        quantities = {f"{n}_modulus": Quantity(v.tolist(), "Pa", f"{n} modulus {each}") for n, v in values.items()}
        quantities["loss_tangent"] = Quantity((modulus.imag / modulus.real).tolist(), "1", f"loss over storage modulus {each}")
        if self.analysis is not None:
            errors = np.array([estimate.modulus_errors for estimate in self.analysis.estimates]).T
            quantities |= {
                f"{n}_modulus_error": Quantity(error.tolist(), "Pa", f"standard error of the {n} modulus {each}")
                for n, error in zip(values, errors, strict=True)
            }
        return quantities

    @property
    def _units(self) -> int:
        return len(next(iter(self.fits.values())).fit.constants.moduli)

    @staticmethod
    def _constants(finding: DmaFinding, prefix: str) -> dict[str, Quantity]:
        constants, method = finding.fit.constants, finding.fit.method.replace("_", " ")
        return {
            f"{prefix}glassy_modulus": Quantity(constants.glassy_modulus, "Pa", f"E0, {method}"),
            f"{prefix}moduli": Quantity(constants.moduli, "Pa", f"E_i of the Kelvin units [unit], {method}"),
            f"{prefix}retardation_times": Quantity(constants.retardation_times, "s", f"tau_i [unit], {method}"),
        }

    def _errors(self, method: str, finding: DmaFinding) -> dict[str, Quantity]:
        """Objective, errors and width of the band of one fit."""
        fit, band = finding.fit, finding.band
        errors, squares = self._relative_errors(fit), self._squares(fit)
        width, both = float(np.median(band.relative_width)), "elastic and viscous"
        quantities = {
            f"{method}_objective": Quantity(fit.objective, "1/Pa**2", "eq. 4.5.2 with squared norms"),
            f"{method}_weighted_squares": Quantity(squares, "1", "squared errors over the variance of the noise, summed"),
            f"{method}_largest_error": Quantity(
                float(np.abs(errors).max()), "1", f"largest relative difference from the data, {both}"
            ),
            f"{method}_band_width": Quantity(width, "1", f"median full width of the band over the curve, {both}"),
        }
        if self.truth is not None:
            error = float(np.abs(band.centre / self.truth - 1).max())
            quantities[f"{method}_curve_error"] = Quantity(
                error, "1", f"largest relative difference from the true curves, {both}"
            )
        return quantities

    def _relative_errors(self, fit: DmaFit) -> Array:
        """Of both parts of the modulus, over the data."""
        return fit.parts(self.data.frequencies) / self.data.parts - 1

    def _squares(self, fit: DmaFit) -> float:
        """Squared errors of a fit over the variance of the noise, summed."""
        return float(((self._relative_errors(fit) / relative_noise(self.data)) ** 2).sum())

    def _noise_unknown(self) -> list[str]:
        """A warning if the data say too little of their own noise, of which bands and standard errors are made."""
        if noise_is_known(self.data) and all(np.isfinite(finding.band.upper).all() for finding in self.fits.values()):
            return []
        return [
            f"{self.data.parts.size} numbers leave too little to estimate their noise by: neither the bands nor what is said of "
            "the constants holds; measure at more frequencies, or state the noise as data.noise"
        ]

    def _misfit(self) -> list[str]:
        """A warning if the units leave more than the noise, whose sum of squares follows a chi-square distribution with at
        most as many degrees of freedom as there are numbers.
        """
        finding = self.fits.get("least_squares")
        fit = fit_least_squares(self.data, self._units) if finding is None else finding.fit
        squares, most = self._squares(fit), float(scipy.stats.chi2.ppf(1 - BY_CHANCE, self.data.parts.size))
        if squares <= most:
            return []
        return [
            f"with units: {self._units} the model does not describe the data: the least sum of squared errors over the variance "
            f"of the noise is {squares:.3g}, and noise alone leaves more than {most:.3g} once in {1 / BY_CHANCE:.0f} times; "
            "neither constants nor curves hold, whatever their errors say: take more units, or a larger noise if it is not "
            "known so well"
        ]

    def _warnings(self, quantities: dict[str, Quantity]) -> list[str]:
        determinations = [finding.determination for finding in list(self.fits.values())[:1]]
        warnings = [*self._noise_unknown(), *self._misfit()] if self.fits else []
        warnings += [one.statement() for one in determinations if not one.determined.all()]
        estimates = () if self.analysis is None else self.analysis.estimates
        coloured = [f"{estimate.frequency:g}" for estimate in estimates if not estimate.has_white_residuals]
        if coloured:
            warnings.append(
                f"the sines leave correlated residuals at {', '.join(coloured)} Hz: the specimen still creeps, the frequency is "
                "off, or there are harmonics; the standard errors there are too small: hold and precycle longer, or set "
                "refine: true"
            )
        if "genetic" in self.fits:
            reached, least = quantities["genetic_objective"].value, quantities["least_objective"].value
            if reached > FAR_FROM_LEAST * least:
                times = f"{reached / least:.3g} times" if reached < 1e6 * least else "more than a million times"
                warnings.append(f"the genetic algorithm stopped at {times} the least of its objective: search longer")
        return warnings

    def _scene(self) -> DmaScene:
        fits = {method: self._fit(finding) for method, finding in self.fits.items()}
        tests = [] if self.analysis is None else list(zip(self.analysis.signals, self.analysis.estimates, strict=True))
        signals = tuple(ShownSignals.of(*tests[end]) for end in (0, -1)) if tests else ()
        return DmaScene(data_frequencies=self.data.frequencies.tolist(), fits=fits, signals=signals)

    def _fit(self, finding: DmaFinding) -> KelvinFit:
        determination, band, history = finding.determination, finding.band, np.array(finding.fit.history or ())
        shown = np.unique(np.geomspace(1, max(1, len(history)), SHOWN_GENERATIONS).round().astype(int))[: len(history)]
        return KelvinFit(
            evaluations=finding.fit.evaluations,
            statement=determination.statement(),
            constants=dict(zip(determination.names, determination.values.tolist(), strict=True)),
            standard_errors_of_logarithms=dict(zip(determination.names, determination.relative_errors.tolist(), strict=True)),
            told=dict(zip(determination.names, determination.determined.tolist(), strict=True)),
            singular_values=determination.singular_values.tolist(),
            confidence=band.confidence,
            band="simultaneous" if band.simultaneous else "pointwise",
            generation=shown.tolist(),
            best_objective=history[shown - 1].tolist(),
            true_curves_inside_band=None if self.truth is None else band.contains(self.truth),
        )
