"""What a computation in a thread and the page that waits for it know of each other."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Watch:
    """Written by both threads, each attribute by one of them only."""

    dropped: bool = False
    """By the page: another estimate is wanted."""
    cancelled: bool = False
    """By the page: the user wants none."""
    stage: str = ""
    """By the computation: its present part, in words."""
    systems: int = 0
    """By the computation: linear systems and other parts of its work so far."""

    def asked_to_cancel(self) -> bool:
        """Whether the user has cancelled it; counts a part of the work."""
        self.systems += 1
        return self.cancelled

    def asked_to_stop(self) -> bool:
        """Whether the result is not wanted any more; counts a part of the work."""
        self.systems += 1
        return self.cancelled or self.dropped
