"""An experiment of which some places vary: what a sweep of many samples is made from in Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tactsim.model import FrozenModel
from tactsim.units import written


@dataclass(frozen=True)
class Variation:
    """An experiment and, by key path within it, the distributions of what varies, as a sweep file writes them."""

    experiment: Any
    places: Mapping[str, Any]


def uniform(low: Any, high: Any) -> dict[str, Any]:
    """Evenly distributed between two numbers or quantities such as ``"2 mm"``."""
    return {"uniform": written([low, high])}


def log_uniform(low: Any, high: Any) -> dict[str, Any]:
    """Evenly distributed in the logarithm between two positive numbers or quantities."""
    return {"log_uniform": written([low, high])}


def normal(mean: Any, deviation: Any, *, low: Any = None, high: Any = None) -> dict[str, Any]:
    """Normal with a mean and a standard deviation, cut off below ``low`` and above ``high``, which go together."""
    return {"normal": written([mean, deviation])} | ({} if low is None and high is None else {"within": written([low, high])})


def choice(*options: Any, weights: tuple[float, ...] | None = None) -> dict[str, Any]:
    """One of the options, numbers, quantities, names, or models such as materials; equally probable without weights."""
    listed = [
        one.model_dump(mode="json", context={"units": "written"}) if isinstance(one, FrozenModel) else written(one)
        for one in options
    ]
    return {"choice": listed} | ({} if weights is None else {"weights": list(weights)})
