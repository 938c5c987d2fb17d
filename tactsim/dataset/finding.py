"""One thing that is wrong with a data set."""

from __future__ import annotations

from dataclasses import dataclass

from tactsim.outside.text import one_line

SHOWN = 10
"""Samples named in one finding."""


@dataclass(frozen=True)
class Finding:
    """Its kind, the samples, and in words what it is and what to do."""

    kind: str
    samples: tuple[int, ...]
    words: str

    def __str__(self) -> str:
        more = f" and {len(self.samples) - SHOWN} more" if len(self.samples) > SHOWN else ""
        which = f"; samples {', '.join(map(str, self.samples[:SHOWN]))}{more}" if self.samples else ""
        return f"{self.kind}: {one_line(self.words, 1000)}{which}"
