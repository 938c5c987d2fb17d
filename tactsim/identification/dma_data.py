"""Complex compliance of tissue at the frequencies of a dynamic mechanical analysis (DMA): checked, read, or made up."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.spectrum import checked_number, read_only, real_array
from tactsim.array import Array
from tactsim.errors import InvalidQuantity, shown
from tactsim.identification.columns import of_file, read_columns

FEWEST_FREQUENCIES = 3
THESIS_FREQUENCIES = (1.0, 6.0, 11.0, 16.0, 21.0, 26.0, 31.0, 36.0)
"""In Hz: eight cycles from 1 Hz, each 5 Hz above the last; thesis section 4.4."""

PARTS = ("elastic", "viscous")
COLUMNS = {
    "frequency": "Hz",
    "storage modulus": "Pa",
    "loss modulus": "Pa",
    "elastic compliance": "1/Pa",
    "viscous compliance": "1/Pa",
    "dynamic modulus": "Pa",
    "phase": "rad",
}
PAIRS = (("storage modulus", "loss modulus"), ("elastic compliance", "viscous compliance"), ("dynamic modulus", "phase"))
"""What may stand beside the frequency."""


@dataclass(frozen=True, eq=False)
class DmaData:
    r"""Complex compliance :math:`D^* = D_e - i D_v` in 1/Pa over the frequency.

    Parameters
    ----------
    frequencies : array_like
        In Hz, > 0 and increasing, shape (n,), n >= 3.
    compliance : array_like
        ``D*`` in 1/Pa, complex, shape (n,), with ``D_e > 0`` and ``D_v > 0`` as a passive, dissipating tissue has them.
    relative_noise : array_like, optional
        Standard deviation of the noise of each number over that number: one value, or shape (2, n) with the elastic row first.
        All positive, or all 0 for exact data; None if it is not known.

    Raises
    ------
    InvalidQuantity
        With the row and the value, if a number is out of its range.

    Source: thesis sections 4.3 and 4.4, eqs. 4.3.7 and 4.4.2.
    """

    frequencies: Array
    compliance: Array
    relative_noise: Array | None = None

    def __post_init__(self) -> None:
        frequencies = _checked_frequencies(self.frequencies)
        compliance = _checked_compliance(self.compliance, frequencies.size)
        object.__setattr__(self, "frequencies", read_only(frequencies))
        object.__setattr__(self, "compliance", read_only(compliance))
        if self.relative_noise is not None:
            object.__setattr__(self, "relative_noise", read_only(_checked_noise(self.relative_noise, frequencies.size)))

    @property
    def parts(self) -> Array:
        """Elastic and viscous compliance in 1/Pa, shape (2, n)."""
        return parts_of(self.compliance)

    @property
    def modulus(self) -> Array:
        """E* = E_e + i E_v = 1 / D* in Pa, shape (n,)."""
        return 1 / self.compliance


def parts_of(compliance: Array) -> Array:
    """Elastic and viscous compliance, shape (2, ...), of a complex one of shape (...)."""
    return np.stack([compliance.real, -compliance.imag])


def synthetic_dma(
    model: GeneralizedKelvin, frequencies: ArrayLike = THESIS_FREQUENCIES, noise: float = 0.0, seed: int = 0
) -> DmaData:
    """Data of a model: each elastic and viscous compliance times ``1 + noise z`` with independent standard normal ``z``.

    The frequencies (n,) are in Hz.

    Raises
    ------
    InvalidQuantity
        If the noise is negative, or so large that a compliance becomes negative.
    """
    noise = checked_number("noise", noise, zero=True)
    frequencies = _checked_frequencies(frequencies)
    exact = parts_of(model.complex_compliance(2 * np.pi * frequencies))
    noisy = exact * (1 + noise * np.random.default_rng(seed).standard_normal(exact.shape))
    return DmaData(frequencies, noisy[0] - 1j * noisy[1], np.array(noise))


def read_dma(path: str | Path, relative_noise: ArrayLike | None = None) -> DmaData:
    r"""Data in a CSV file: a header such as ``frequency [Hz], storage modulus [kPa], loss modulus [kPa]``, rows by frequency.

    Beside the frequency stand two columns: ``storage modulus`` and ``loss modulus``, ``elastic compliance`` and
    ``viscous compliance`` (``[1/MPa]``), or ``dynamic modulus`` and ``phase`` (``[deg]``), with
    :math:`D^* = 1 / E^*` and :math:`E^* = |E^*| e^{i \delta}`. The noise has a shape of `DmaData`.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If a unit is missing or a number out of its range, with file and row.
    """
    columns = read_columns(path, COLUMNS)
    beside = set(columns) - {"frequency"}
    pair = next((pair for pair in PAIRS if set(pair) == beside), None)
    if "frequency" not in columns or pair is None:
        allowed = ", or ".join(" and ".join(names) for names in PAIRS)
        raise InvalidQuantity(f"{path}: columns {', '.join(columns)}; allowed: frequency with {allowed}")
    first, second = (columns[name] for name in pair)
    with of_file(path):
        compliance = first - 1j * second if pair[0] == "elastic compliance" else 1 / _modulus(pair, first, second)
        return DmaData(columns["frequency"], compliance, None if relative_noise is None else np.array(relative_noise))


def _modulus(pair: tuple[str, str], first: Array, second: Array) -> Array:
    """Complex modulus in Pa, of positive columns."""
    for name, values in zip(pair, (first, second), strict=True):
        highest = np.pi / 2 if name == "phase" else np.inf
        for row in np.flatnonzero(~((values > 0) & (values < highest)))[:1]:
            allowed = "> 0 and < pi/2 rad" if name == "phase" else "> 0"
            raise InvalidQuantity(f"{name} in row {row + 1} is {values[row]:g} {COLUMNS[name]}; allowed: {allowed}")
    return first * np.exp(1j * second) if pair[1] == "phase" else first + 1j * second


def _checked_frequencies(values: ArrayLike) -> Array:
    frequencies = real_array("frequencies", values)
    if frequencies.ndim != 1 or frequencies.size < FEWEST_FREQUENCIES:
        count = f"{frequencies.size} of shape {frequencies.shape}"
        raise InvalidQuantity(f"frequencies are {count}; allowed: a list of at least {FEWEST_FREQUENCIES}")
    for row in np.flatnonzero(~(np.isfinite(frequencies) & (frequencies > 0)))[:1]:
        raise InvalidQuantity(f"frequency in row {row + 1} is {frequencies[row]:g} Hz; allowed: finite and > 0")
    for row in np.flatnonzero(np.diff(frequencies) <= 0)[:1]:
        raise InvalidQuantity(
            f"frequency in row {row + 2} is {frequencies[row + 1]:g} Hz after {frequencies[row]:g} Hz; "
            "allowed: each once, in increasing order"
        )
    return frequencies


def _checked_compliance(values: ArrayLike, count: int) -> Array:
    try:
        compliance = np.array(values, dtype=complex)
    except (TypeError, ValueError):
        raise InvalidQuantity(f"compliance is {shown(values)}; allowed: complex numbers in 1/Pa") from None
    if compliance.shape != (count,):
        raise InvalidQuantity(f"compliance has shape {compliance.shape}; allowed: ({count},), one per frequency")
    for name, part in zip(PARTS, parts_of(compliance), strict=True):
        for row in np.flatnonzero(~(np.isfinite(part) & (part > 0)))[:1]:
            raise InvalidQuantity(f"{name} compliance in row {row + 1} is {part[row]:g} 1/Pa; allowed: finite and > 0")
    return compliance


def _checked_noise(values: ArrayLike, count: int) -> Array:
    noise = real_array("relative_noise", values)
    if noise.shape not in ((), (2, count)):
        raise InvalidQuantity(f"relative_noise has shape {noise.shape}; allowed: one number, or (2, {count})")
    for value in noise[~(np.isfinite(noise) & (noise >= 0))][:1]:
        raise InvalidQuantity(f"relative_noise is {value:g}; allowed: finite and >= 0")
    if (noise == 0).any() and (noise > 0).any():
        raise InvalidQuantity("relative_noise is 0 in places only; allowed: all > 0, or all 0 for exact data")
    return np.broadcast_to(noise, (2, count)).copy()
