"""An estimator that takes its time, beside those that the page offers."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from pathlib import Path

from live_pages import grasp_folder

from tactsim.deadline import check_time
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import Readings
from tactsim.live.session.choices import Choice, offered_choices
from tactsim.live.session.content import Content, opened_content


@dataclass
class Slow:
    """An estimator that takes as long as a test wants, in small parts; it notes how it ended."""

    needs_response: bool = False
    free: bool = False
    ended: list[str] = field(default_factory=list)

    def estimate(self, readings: Readings) -> Estimate:
        """A place after some time."""
        try:
            for _ in range(2000):
                check_time()
                if self.free:
                    break
                time.sleep(0.01)
        except Exception as error:
            self.ended.append(str(error))
            raise
        self.ended.append("done")
        return Estimate(True, (EstimatedInclusion("unknown", (0.01, 0.02, 0.01)),), "found slowly")


def slow_content(folder: Path) -> tuple[Content, Slow]:
    """A grasp with the offered estimators and a slow one."""
    slow, opened = Slow(), opened_content(grasp_folder(folder))
    return replace(opened, choices=(*offered_choices(), Choice("slow", "Slow", slow, False))), slow
