"""Place and radius of one lump by networks that were trained on a data set."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Literal, Self

import numpy as np

from tactsim.errors import InputError
from tactsim.interfaces import Estimator
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.localization.networks import inputs, read_weights
from tactsim.localization.region import GaussianRegion
from tactsim.outside.input_path import InputPath

LEAST_RADIUS = 0.1e-3
"""Radius in m that an estimate is raised to: a network may give one below zero."""


class LearnedEstimator(Estimator):
    """One lump at most, as an ensemble of networks saw it in training; several places where the readings rise apart.

    ``tactsim data train`` makes the weights from a data set of grasps. What the networks take are the changes of the taxels'
    forces from the reference over their size, and that size and the noise over the whole force. Readings of another matrix or
    block are refused. The uncertainty is that of grasps held out of the training, and the spread of the ensemble.

    Source: an ensemble of perceptrons after B. Lakshminarayanan, A. Pritzel & C. Blundell 2017, arXiv:1612.01474.
    """

    kind: Literal["learned"] = "learned"
    weights: InputPath
    """File of the weights, beside the case or in the working folder."""

    @property
    def title(self) -> str:
        """Its name in words."""
        return "Learned"

    @classmethod
    def example(cls) -> Self:
        """Weights wherever they were written."""
        return cls(weights="results/lumps_estimator.npz")

    @classmethod
    def variants(cls) -> dict[str, Self]:
        """None: it needs a file of weights."""
        return {}

    @property
    def needs_reference(self) -> bool:
        """Always: networks take changes."""
        return True

    @classmethod
    def checked(cls, path: str | Path) -> Self:
        """The estimator of a file that is there and can be read.

        Raises
        ------
        StorageError
            If there is no such file, or it does not hold the weights of this version.
        """
        read_weights(path)
        return cls(weights=str(path))

    def estimate(self, readings: Readings) -> Estimate:
        """At most one ball, with the covariance of place and radius; the places of `ThesisEstimator` where these are several.

        Raises
        ------
        InputError
            If the readings lack a reference without a lump, or are of another matrix or block than the training data.
        """
        if readings.difference is None or readings.reference is None:
            raise InputError("the learned estimator needs a reference without a lump")
        learned = read_weights(self.weights)
        learned.check(readings)
        features = inputs(readings.difference[None], np.asarray(readings.reference)[None], readings.noise)[0]
        probability = learned.probability(features)
        if probability < 0.5:
            return Estimate(False, (), f"no inclusion (probability {1 - probability:.3g})", probability)
        apart = ThesisEstimator(background="reference").estimate(readings)
        if len(apart.inclusions) > 1:
            return replace(apart, probability=probability)
        mean, covariance = learned.place(features)
        x, y, z = map(float, np.clip(mean[:3], 0.0, learned.block_size))
        radius = max(float(mean[3]), LEAST_RADIUS)
        region = GaussianRegion(np.array([x, y, z]), covariance[:3, :3])
        ball = EstimatedInclusion("sphere", (x, y, z), radius, covariance=covariance, region=region)
        return Estimate(True, (ball,), f"a ball with a probability of {probability:.3g}", probability)
