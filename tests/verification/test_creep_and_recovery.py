"""A viscoelastic cube that creeps to a stretch of six under a dead load, and is unloaded at once: round-off of large stretches.

Reference: the equilibrium of the incompressible cube as an ordinary differential equation of its stretch, solved outside the
project to 1e-6. Mutants: the stretch before the unloading ends, and a load lower by a hundredth.
"""

from __future__ import annotations

import pytest
from mutants import assert_kills
from small_problems import CUBE, EXTENSION, PLANES, SIDE, result_of

TISSUE = {
    "kind": "mooney_rivlin_2",
    "c10": 2e3,
    "c01": 1e3,
    "relaxation": {"fractions": [0.3, 0.45], "times": [0.2, 8.0]},
}
PIECES = [{"kind": "jump", "to": 1.0, "duration": 20.0}, {"kind": "jump", "to": 0.0, "duration": 60.0}]
RECOVERED, TOLERANCE = 1.176586, 1e-4
"""Stretch 60 s after the load is gone, and the largest relative error, that of the steps."""


def stretches(load: float) -> list[float]:
    """Stretch after every step under a nominal stress in Pa that is held for 20 s, then taken off."""
    result = result_of(
        geometry=CUBE,
        material=TISSUE,
        conditions=[*PLANES, {"kind": "traction", "face": "top", "z": load}],
        amplitude={"pieces": PIECES},
        time={"tolerance": 1e-4},
        steps=10,
        asked=EXTENSION,
    )
    return [1 + float(step.values["number"]) / SIDE for step in result.steps]


def test_a_cube_recovers_from_a_stretch_of_six(one_thread, verification_record):
    stretch = stretches(9e3)
    assert max(stretch) > 6

    def check(recovered):
        assert recovered == pytest.approx(RECOVERED, rel=TOLERANCE)

    check(stretch[-1])
    known = {"reference": "ordinary differential equation", "kind": "exact", "mesh": "one cell", "tolerance": TOLERANCE}
    verification_record("stretch of a cube 60 s after a creep to a stretch of six", stretch[-1], RECOVERED, **known)
    assert_kills(check, before=(stretch[-2],), less=(stretches(8.91e3)[-1],))
