"""A viscoelastic cube under sudden loads: it creeps to a stretch of six and is unloaded at once, or is pulled at once by four
times its modulus, where Newton finds another equilibrium before that of the uniform cube.

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


@pytest.mark.slow
def test_a_cube_recovers_from_a_stretch_of_six(one_thread, verification_record):
    stretch = stretches(9e3)
    assert max(stretch) > 6

    def check(recovered):
        assert recovered == pytest.approx(RECOVERED, rel=TOLERANCE)

    check(stretch[-1])
    known = {"reference": "ordinary differential equation", "kind": "exact", "mesh": "one cell", "tolerance": TOLERANCE}
    verification_record("stretch of a cube 60 s after a creep to a stretch of six", stretch[-1], RECOVERED, **known)
    assert_kills(check, before=(stretch[-2],), less=(stretches(8.91e3)[-1],))


def test_a_sudden_pull_finds_the_uniform_cube(one_thread, verification_record):
    """Reference: s = 2 (c10 + c01 / l) (l^2 - 1 / l), the true stress of the uniform cube. The equilibrium that Newton finds from
    rest has a stretch of 1.5 and elements with two thirds of their volume. Mutants: a dead load of this size, and no c01."""
    stretch, c10, c01 = 2.2, 3e3, 0.8e3
    pull = 2 * (c10 + c01 / stretch) * (stretch**2 - 1 / stretch)
    result = result_of(
        geometry=CUBE,
        material=TISSUE | {"c10": c10, "c01": c01},
        conditions=[*PLANES, {"kind": "pressure", "face": "top", "pressure": -pull}],
        amplitude={"pieces": [{"kind": "jump", "to": 1.0, "duration": 1e-3}]},
        asked=EXTENSION,
    )
    reached = 1 + float(result.steps[0].values["number"]) / SIDE

    def check(modulus, area):
        assert modulus(reached) * (reached**2 - 1 / reached) / area(reached) == pytest.approx(pull, rel=1e-9), "Newton's error"

    def law(stretch):
        return 2 * (c10 + c01 / stretch)

    check(law, lambda _: 1.0)
    assert not result.warnings
    known = {"reference": "uniform stress", "kind": "exact", "mesh": "one cell", "tolerance": 1e-9}
    verification_record("stretch of a cube under a sudden true stress", reached, stretch, **known)
    assert_kills(check, dead=(law, lambda stretch: stretch), without_c01=(lambda _: 2 * c10, lambda _: 1.0))
