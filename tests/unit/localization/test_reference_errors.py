"""A reference that is wrong by a common factor of stiffness or gain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_grasps import LAYOUT, NOISE, SIZE, plain_forces, response

from tactsim.interfaces import Estimator
from tactsim.interfaces.readings import Readings
from tactsim.localization.estimators.hypotheses import HypothesesEstimator
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.lump_response import LumpResponse
from tactsim.localization.reference_errors import ReferenceErrors, fitted, log_density

CENTER, RADIUS, CONTRAST = np.array([18e-3, 22e-3, 12e-3]), 4e-3, 10.0
PLAIN = plain_forces(np.array([1e-3]))[0]
ONE_LUMP = ("lump",)
FITTING = {"model_based": ModelBasedEstimator(background_scale=0.0), "hypotheses": HypothesesEstimator(classes=ONE_LUMP)}
RIGID = {"factor_spread": 0.0}
"""The reference is taken for that of the tissue."""


@pytest.fixture(scope="module")
def table() -> LumpResponse:
    return response()


def read(table: LumpResponse, factor: float, contrast: float = 0.0, **changes: object) -> Readings:
    """Readings without noise of tissue this much stiffer than the reference, with a lump or none."""
    forces = factor * (PLAIN + contrast * table.signal(CENTER[None], np.array([RADIUS]))[0])
    return replace(Readings(forces, LAYOUT, SIZE, reference=PLAIN, noise=NOISE, closing=1e-3, response=table), **changes)


@pytest.mark.parametrize("estimator", FITTING.values(), ids=list(FITTING))
@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_stiffer_tissue_is_no_lump_but_a_factor(table: LumpResponse, estimator: Estimator, factor: float) -> None:
    estimate = estimator.estimate(read(table, factor))
    assert not estimate.present
    assert estimate.factor == pytest.approx(factor, abs=1e-3)  # the prior draws it towards one by (noise / spread)^2
    assert "times those of the reference" in estimate.reason
    assert not estimator.model_copy(update=RIGID).estimate(read(table, 1.0)).present
    without = estimator.model_copy(update=RIGID).estimate(read(table, factor))
    assert without.present, "what a reference that cannot be wrong makes of it"


@pytest.mark.parametrize("estimator", FITTING.values(), ids=list(FITTING))
@pytest.mark.parametrize("factor", [0.8, 1.25])
def test_a_lump_lies_where_it_lies_whatever_the_factor(table: LumpResponse, estimator: Estimator, factor: float) -> None:
    matched, other = (estimator.estimate(read(table, one, CONTRAST)) for one in (1.0, factor))
    rigid = estimator.model_copy(update=RIGID).estimate(read(table, factor, CONTRAST))
    off, off_matched = (np.linalg.norm(np.array(one.inclusions[0].center) - CENTER) for one in (other, matched))
    assert off < off_matched + 1e-3
    assert other.factor == pytest.approx(factor, rel=0.05)
    assert other.inclusions[0].region.contains(CENTER)
    assert np.linalg.norm(np.array(rigid.inclusions[0].center) - CENTER) > 2 * off, "what a factor of one makes of it"


def test_gain_and_stiffness_are_one_factor(table: LumpResponse) -> None:
    readings = read(table, 1.0, CONTRAST)
    stiffer = read(table, 1.3, CONTRAST)
    gained = replace(readings, forces=1.3 * readings.forces)
    assert np.array_equal(stiffer.forces, gained.forces)


def test_both_readings_have_their_noise_and_the_reference_its_errors() -> None:
    """The variance of a change: noise twice, errors of model and reference in root mean squares, one factor."""
    errors = ReferenceErrors(np.array([3.0, 4.0]), 0.1, 0.02, 0.5, 0.3)
    left = np.array([1.0, -2.0])
    alone = 2 * 0.01 + 4e-4 * 12.5
    white = alone + 0.09 * (2.5 - alone)
    np.testing.assert_allclose(errors.covariance(left), white * np.eye(2) + 0.25 * np.array([[9, 12], [12, 16]]), rtol=1e-14)
    assert errors.white(np.array([0.1, 0.0])) == errors.white(np.zeros(2)), "errors alone are no body's"


def test_the_evidence_is_that_of_the_joint_normal_distribution(table: LumpResponse) -> None:
    errors = ReferenceErrors(PLAIN.ravel(), NOISE, 0.015, 0.25, 0.2)
    change = (read(table, 1.2, CONTRAST).forces - PLAIN).ravel()
    signals = table.signal(CENTER[None], np.array([RADIUS])).reshape(1, -1)
    fit = fitted(signals, change, errors, 5.0)
    joint = fit.covariance + 25.0 * np.outer(signals[0], signals[0])
    assert fit.evidence_of_body == pytest.approx(log_density(change, joint), rel=1e-9)
    assert fit.evidence_of_none == pytest.approx(log_density(change, errors.covariance(0 * change)), rel=1e-9)
    assert fit.factor == pytest.approx(1.2, abs=0.01)
    mean = 25.0 * signals[0] @ np.linalg.solve(joint, change)
    assert fit.contrasts[0] == pytest.approx(mean, rel=1e-9)
