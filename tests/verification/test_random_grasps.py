"""Fifty random grasps end well or are refused: lumps of 2 to 7 mm anywhere in a block 20 mm high, closed by 0 to 2 mm."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from tactsim.errors import InputError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.interfaces.taxel_layout import JAWS

COUNT, SIZE = 50, (40e-3, 40e-3, 20e-3)
QUICK = (1, 2)
"""Those that run in CI: two lumps that are refused."""
COARSE = {"kind": "tetrahedra", "size": 8e-3, "edge_size": 6e-3, "growth": 1.0}
FINE_ENOUGH = 0.45
"""Element size at a lump over its radius, at most 3 mm."""


def random_grasp(number):
    """The case of a number and what it is called; a lump may stick out of the block."""
    draw = np.random.default_rng([2026, number])
    radius = draw.uniform(2e-3, 7e-3)
    centre = draw.uniform(0.0, 1.0, 3) * np.array(SIZE)
    if draw.uniform() < 0.8:  # most of them inside, the others mostly refused
        centre = radius + draw.uniform(0.0, 1.0, 3) * (np.array(SIZE) - 2 * radius)
    tissue = ("icf_stable", "b1a_stable")[number % 2]
    return {
        "block": {"size": SIZE, "tissue": tissue},
        "inclusions": [{"shape": {"kind": "sphere", "center": centre, "radius": radius}, "material": "lump"}],
        "loading": {
            "control": "displacement",
            "pieces": [{"kind": "ramp", "to": max(draw.uniform(0.0, 2e-3), 1e-5), "duration": 1.0}],
        },
        "mesh": COARSE | {"inclusion_size": min(3e-3, FINE_ENOUGH * radius)},
    }


def outcome(number):
    """ "refused" or "converged", the reason, and the result if there is one."""
    try:
        result = Grasp.model_validate(random_grasp(number)).run()
    except (InputError, ValidationError) as error:
        return "refused", str(error), None
    return str(result.status), result.reason, result


@pytest.mark.parametrize("number", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in range(COUNT)])
def test_a_random_grasp_converges_or_is_refused(number, verification_record):
    status, reason, result = outcome(number)
    if status == "refused":
        assert "allowed" in reason
        return
    assert status == "converged", reason
    quantities = {name: quantity.value for name, quantity in result.quantities.items()}
    closing = random_grasp(number)["loading"]["pieces"][0]["to"]
    assert quantities["displacement"] == pytest.approx(closing, rel=1e-9)
    assert quantities["max_penetration"] <= 5e-4 * SIZE[2]
    assert quantities["min_volume_ratio"] > 0
    for side in JAWS:
        check_balance(quantities, side)
        known = {"reference": "the reaction", "kind": "invariance", "mesh": "solid, coarse tetrahedra", "tolerance": 1e-5}
        verification_record(
            "random grasps, sum of taxels, gaps and outside", total(quantities, side), quantities["reaction_force"], **known
        )
        with pytest.raises(AssertionError):
            check_balance(quantities | {f"gap_force_{side}": 0.0}, side)


def total(quantities, side):
    """Force in N on taxels, gaps between them and what lies outside."""
    return np.sum(quantities[f"taxel_force_{side}"]) + quantities[f"gap_force_{side}"] + quantities[f"outside_force_{side}"]


def check_balance(quantities, side):
    """Taxels, gaps between them and what lies outside bear the reaction; fails without the gaps."""
    assert total(quantities, side) == pytest.approx(quantities["reaction_force"], rel=1e-5)
