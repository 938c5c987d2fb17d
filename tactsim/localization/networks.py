"""Trained networks as plain arrays: what they take, what they give, and the file that keeps them."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy
from pydantic import ValidationError

from tactsim.array import Array
from tactsim.errors import InputError, StorageError
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.outside.arrays import LARGEST_FOREIGN, read_arrays
from tactsim.outside.files import opened
from tactsim.outside.text import one_line
from tactsim.refusals import first_fault
from tactsim.units import format_quantity

SCHEMA = "tactsim/learned/1"
OUTPUTS = ("x", "y", "z", "radius")
"""Order of what the networks give of a lump."""
ARCHIVE = b"PK"
"""What a file of arrays begins with."""
TRAINED = "tactsim data train makes one from a data set of grasps"
TINY = 1e-9
"""Change over the whole force of the reference below which there is none."""


@dataclass(frozen=True, eq=False)
class Network:
    """Layers of a perceptron: matrices (in, out) and offsets (out,), rectified but for the last."""

    matrices: tuple[Array, ...]
    offsets: tuple[Array, ...]

    def __call__(self, inputs: Array) -> Array:
        """Outputs (n, out) of inputs (n, in)."""
        for number, (matrix, offset) in enumerate(zip(self.matrices, self.offsets, strict=True), 1):
            inputs = inputs @ matrix + offset
            if number < len(self.matrices):
                inputs = np.maximum(inputs, 0.0)
        return inputs


@dataclass(frozen=True, eq=False)
class LearnedWeights:
    r"""An ensemble that gives place and radius, and a network that decides whether there is a lump.

    The inputs are what `inputs` makes of readings of a block of ``block_size`` (3,) in m, over ``scale`` (inputs,) about
    ``middle`` (inputs,). Errors have the covariance of those of held out grasps, ``covariance`` (4, 4) over the block's height
    squared, times :math:`e^{2 (a + b \\ln |d| / F)}` with the change d, the whole force F of the reference and a and b of
    ``growth`` (2,), and that of the ensemble.
    """

    layout: TaxelLayout
    block_size: Array
    middle: Array
    scale: Array
    places: tuple[Network, ...]
    presence: Network
    covariance: Array
    growth: Array
    held_out: int = 0
    """Grasps with a lump from which the covariance was estimated."""
    held_out_error: tuple[float, float] | None = None
    """Medians in m of their errors in plan and in height, of weights that were just trained; a file does not keep it."""
    trained_on: tuple[str, ...] = ()
    """Hash of the case of every sample of a store that was learned from or held out; empty of files of earlier versions."""

    def probability(self, features: Array) -> float:
        """Probability that there is a lump, for features (inputs,)."""
        return float(scipy.special.expit(self.presence((features - self.middle)[None] / self.scale)[0, 0]))

    def place(self, features: Array) -> tuple[Array, Array]:
        """Mean (4,) of x, y, z and radius in m and their covariance (4, 4) in m^2."""
        height = float(self.block_size[2])
        outputs = np.concatenate([network((features - self.middle)[None] / self.scale) for network in self.places])
        mean = outputs.mean(axis=0) * height + np.append(self.block_size / 2, 0.0)
        away = (outputs - outputs.mean(axis=0)) * height
        size = np.exp(2 * float(self.growth[0] + self.growth[1] * features[-2]))
        return mean, away.T @ away / len(outputs) + size * height**2 * self.covariance

    def check(self, readings: Readings) -> None:
        """Refuse readings of another matrix or block than those of the training data.

        Raises
        ------
        InputError
            Naming both matrices or both blocks.
        """
        if readings.layout != self.layout:
            learned, given = self.layout.in_words, readings.layout.in_words
            raise InputError(f"the estimator was trained on the matrix of {learned}, the readings are of {given}; train it anew")
        if not np.allclose(readings.block_size, self.block_size, rtol=1e-6):
            sizes = [np.asarray(size).tolist() for size in (self.block_size, readings.block_size)]
            raise InputError(
                f"the estimator was trained on a block of {sizes[0]} m, the readings are of one of {sizes[1]} m; train it anew"
            )

    def summary(self) -> str:
        """Number of networks and weights, and of the grasps held out, in words."""
        count = sum(matrix.size for matrix in self.places[0].matrices)
        words = f"{len(self.places)} networks of {count} weights, {self.held_out} lumps held out"
        if self.held_out_error is None:
            return words
        plan, height = (format_quantity(float(f"{error:.2g}"), "m") for error in self.held_out_error)
        return f"{words}, which are in the median {plan} off in plan and {height} in height, with noise"

    def content(self) -> bytes:
        """As the bytes of an npz file, without pickle."""
        arrays: dict[str, Array] = {
            "schema": np.array(SCHEMA),
            "layout": np.array(self.layout.model_dump_json()),
            "held_out": np.array(self.held_out),
            "trained_on": np.array(self.trained_on, dtype=str),
            **{name: np.asarray(getattr(self, name), dtype=float) for name in NUMBERS},
        }
        for number, network in enumerate((self.presence, *self.places)):
            arrays[f"depth_{number}"] = np.array(len(network.matrices))
            for layer, (matrix, offset) in enumerate(zip(network.matrices, network.offsets, strict=True)):
                arrays |= {f"matrix_{number}_{layer}": matrix, f"offset_{number}_{layer}": offset}
        arrays["networks"] = np.array(1 + len(self.places))
        content = io.BytesIO()
        np.savez_compressed(content, allow_pickle=False, **arrays)
        return content.getvalue()


MOST_PARTS = 1000
"""Networks of an ensemble, and layers of a network; five and three are trained."""
NUMBERS = ("block_size", "middle", "scale", "covariance", "growth")
"""Arrays of the weights beside those of the networks."""


def read_weights(path: str | Path) -> LearnedWeights:
    """The weights in a file.

    Raises
    ------
    StorageError
        If there is no such file, or it does not hold the weights of this version.
    """
    content = opened(path, "weights").read()
    if not content.startswith(ARCHIVE):
        raise StorageError(f"{one_line(path)} is no file of a learned estimator; {TRAINED}")
    file = read_arrays(content, str(path), largest=LARGEST_FOREIGN)
    try:
        if str(file["schema"]) != SCHEMA:
            raise StorageError(f"{path} has the schema {one_line(file['schema'], 40)!r}; this tactsim reads {SCHEMA!r}")
        presence, *places = (_network(file, number) for number in range(_count(file["networks"])))
        layout = TaxelLayout.model_validate_json(str(file["layout"]), strict=True)
        numbers = {name: np.asarray(file[name], dtype=float) for name in NUMBERS}
        held_out = int(file["held_out"])
        trained_on = tuple(map(str, file["trained_on"])) if "trained_on" in file else ()
        weights = LearnedWeights(
            layout=layout,
            places=tuple(places),
            presence=presence,
            held_out=held_out,
            held_out_error=None,
            trained_on=trained_on,
            **numbers,
        )
    except (ValueError, LookupError, TypeError, OverflowError, ValidationError) as error:
        fault = first_fault(error) if isinstance(error, ValidationError) else error
        reason = f"does not hold the weights of a learned estimator: {one_line(fault, 120)}"
        raise StorageError(f"{one_line(path)} {reason}; {TRAINED}") from None
    if not weights.places or not all(np.isfinite(numbers[name]).all() for name in NUMBERS):
        raise StorageError(f"{path} holds no networks or numbers that are not finite; train the estimator anew")
    return weights


def inputs(change: Array, reference: Array, noise: Array | float) -> Array:
    """Features (n, taxels + 2): the change over its own size, and the logarithms of change and noise over the reference's force.

    Parameters
    ----------
    change, reference : (n, jaw, row, column) in N
    noise : (n,) or one number, in N

    Raises
    ------
    InputError
        If a reference has no force.
    """
    flat, whole = change.reshape(len(change), -1), np.abs(reference).reshape(len(reference), -1).sum(axis=1)
    if not (whole > 0).all():
        raise InputError("the reference has no force; needed: a grasp that has closed")
    size = np.linalg.norm(flat, axis=1)
    least = TINY * whole
    logarithms = np.log(np.maximum(size, least) / whole), np.log(np.maximum(noise, least) / whole)
    return np.column_stack([flat / np.maximum(size, least)[:, None], *logarithms])


def _count(value: Array) -> int:
    """A number of parts that a file states, of which it must hold that many."""
    count = int(value)
    if not 1 <= count <= MOST_PARTS:
        raise ValueError(f"{count} networks or layers; allowed: 1 to {MOST_PARTS}")
    return count


def _network(file: dict[str, Array], number: int) -> Network:
    layers = range(_count(file[f"depth_{number}"]))
    layered = [tuple(np.asarray(file[f"{name}_{number}_{k}"], dtype=float) for k in layers) for name in ("matrix", "offset")]
    if not all(np.isfinite(array).all() for part in layered for array in part):
        raise ValueError("weights that are not finite")
    return Network(*layered)
