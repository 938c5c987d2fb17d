"""Trains a small estimator of where a lump lies, on a data set of grasps, and reports its error beside the trivial one.

A data set for it, some hours on two cores; a first look needs --samples 300:

    tactsim sweep cases/sweep_lumps.yaml --out lumps.zarr
    python examples/train_lump_position.py lumps.zarr

It reads the noisy forces of the taxels and is scored on the split ``test``, whose specimens it has never seen. The trivial
estimator answers the mean position of the training lumps whatever it feels. Everything is ridge regression in NumPy; for
PyTorch see `tactsim.dataset.TorchSamples`.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
import xarray

from tactsim.dataset import load
from tactsim.errors import InputError, TactsimError

FEWEST = 10
"""Samples with one lump that each of the two splits must have."""
PENALTIES = np.logspace(-3, 3, 13)
"""Strengths of the ridge; the split ``validation`` chooses."""


def one_lump(store: str, split: str, fewest: int = FEWEST) -> tuple[np.ndarray, np.ndarray]:
    """Readings (sample, feature) and centres (sample, 3) in m of the samples with exactly one lump."""
    data = load(store, split=split, variables=["read_force", "inclusion_center", "inclusion_count", "closing"])
    data = data.isel(sample=np.flatnonzero(data["inclusion_count"].values == 1))
    if data.sizes["sample"] < fewest:
        raise InputError(
            f"{split}: {data.sizes['sample']} samples with one lump in {store}; needed: {fewest}; compute more samples"
        )
    return readings(data), data["inclusion_center"].values[:, 0]


def readings(data: xarray.Dataset) -> np.ndarray:
    """The share of each taxel in the force of its jaw, the forces of the jaws and the closing, at the last stored time."""
    force = data["read_force"].isel(time=-1).values  # (sample, jaw, row, column) in N
    total = force.sum(axis=(2, 3))
    share = force / np.maximum(total, 1e-3)[:, :, None, None]
    return np.column_stack([share.reshape(len(force), -1), total, data["closing"].values])


class Ridge:
    """Centres as a quadratic function of the readings: linear and squared terms, large coefficients penalised."""

    def __init__(self, inputs: np.ndarray, targets: np.ndarray, penalty: float):
        self.mean, self.spread, self.center = inputs.mean(axis=0), inputs.std(axis=0) + 1e-12, targets.mean(axis=0)
        terms = self._terms(inputs)
        normal = terms.T @ terms + penalty * np.eye(terms.shape[1])
        self.weights = np.linalg.solve(normal, terms.T @ (targets - self.center))

    def __call__(self, inputs: np.ndarray) -> np.ndarray:
        return self.center + self._terms(inputs) @ self.weights

    def _terms(self, inputs: np.ndarray) -> np.ndarray:
        scaled = (inputs - self.mean) / self.spread
        return np.hstack([scaled, scaled**2 - 1])


def distance(estimate: np.ndarray, truth: np.ndarray) -> float:
    """Mean distance between two sets of points in mm."""
    return 1e3 * float(np.linalg.norm(estimate - truth, axis=1).mean())


def trained(store: str) -> dict[str, float]:
    """Errors on the test split in mm: of the estimator, and of the mean position."""
    train, test = one_lump(store, "train"), one_lump(store, "test")
    validation = one_lump(store, "validation", fewest=1)
    models = [Ridge(*train, penalty) for penalty in PENALTIES]
    best = min(models, key=lambda model: distance(model(validation[0]), validation[1]))
    inputs, truth = test
    trivial, located = np.broadcast_to(train[1].mean(axis=0), truth.shape), best(inputs)
    return {
        "training_samples": len(train[0]),
        "test_samples": len(truth),
        "error_mm": distance(located, truth),
        "lateral_error_mm": distance(located[:, :2], truth[:, :2]),
        "depth_error_mm": distance(located[:, 2:], truth[:, 2:]),
        "trivial_error_mm": distance(trivial, truth),
        "trivial_lateral_error_mm": distance(trivial[:, :2], truth[:, :2]),
        "trivial_depth_error_mm": distance(trivial[:, 2:], truth[:, 2:]),
    }


def main() -> int:
    """Prints the errors; exit code 0, or that of the error."""
    parser = argparse.ArgumentParser(description="train a small estimator of lump position and report its error")
    parser.add_argument("store", help="data set of grasps that `tactsim sweep` wrote")
    try:
        told = trained(parser.parse_args().store)
    except TactsimError as error:
        sys.stderr.write(f"error: {error}\n")
        return error.exit_code
    sys.stdout.writelines(f"{name:<26} {value:8.4g}\n" for name, value in told.items())
    return 0


if __name__ == "__main__":
    sys.exit(main())
