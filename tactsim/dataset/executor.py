"""Where samples are computed: what local processes and a cluster have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """What became of a task: the bytes of its block, or None if its worker was lost, with the reason."""

    samples: tuple[int, ...]
    block: bytes | None
    reason: str = ""


class Executor(ABC):
    """Computes tasks, each a tuple of numbers of samples."""

    @property
    @abstractmethod
    def slots(self) -> int:
        """How many tasks it can use at once."""

    @abstractmethod
    def submit(self, samples: tuple[int, ...]) -> None:
        """Begins a task."""

    @abstractmethod
    def wait(self, seconds: float) -> list[Outcome]:
        """Tasks that ended, as soon as there is one; empty after so many seconds."""

    @abstractmethod
    def close(self) -> None:
        """Gives up what is not finished and frees the workers."""
