"""Which class was found for which true one: counts of true class by estimated class."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.interfaces.estimate import Estimate
from tactsim.localization.estimators.hypotheses import CLASSES

Array = np.ndarray
TUBE = "tube"


def class_of(kinds: Sequence[str]) -> str | None:
    """Class of inclusions by the names of their shapes; None for a lump beside an artery and for more than two."""
    tubes = sum(kind == TUBE for kind in kinds)
    names = {(0, 0): "none", (1, 0): "lump", (2, 0): "two_lumps", (1, 1): "artery", (2, 2): "two_arteries"}
    return names.get((len(kinds), tubes))


def estimated_class(estimate: Estimate) -> str:
    """The likeliest class; of an estimator that tells none apart, that of what it found, which then counts as a lump."""
    if estimate.classes is not None:
        classes = estimate.classes
        return max(classes, key=lambda name: classes[name])
    return class_of([found.kind for found in estimate.inclusions]) or "lump"


@dataclass
class ConfusionTable:
    """Counts (true, estimated) in the order of ``CLASSES``."""

    counts: Array = field(default_factory=lambda: np.zeros((len(CLASSES),) * 2, int))

    def add(self, true: str, estimated: str) -> None:
        """Count one.

        Raises
        ------
        InvalidQuantity
            If there is no such class.
        """
        for name in (true, estimated):
            if name not in CLASSES:
                raise InvalidQuantity(f"there is no class {name!r}; allowed: {', '.join(CLASSES)}")
        self.counts[CLASSES.index(true), CLASSES.index(estimated)] += 1

    @property
    def total(self) -> int:
        """Number of estimates."""
        return int(self.counts.sum())

    @property
    def share_right(self) -> float | None:
        """Share on the diagonal; None if nothing was counted."""
        return float(np.trace(self.counts) / self.total) if self.total else None

    @property
    def recalls(self) -> list[float | None]:
        """Share of each true class that was found as such; None for a class that does not occur."""
        return [float(row[k] / row.sum()) if row.sum() else None for k, row in enumerate(self.counts)]
