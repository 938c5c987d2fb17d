"""Fig. 5.8's ranking by finite elements and by the fast model: the functions of the rows, and the nine touches themselves."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import InputError
from tactsim.shipped import CASES
from tactsim.validation.execution import Task, simulated
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.probe import (
    Press,
    ProbeRun,
    probe_force_ratio,
    probe_model_difference,
    probe_order_kept,
    probe_rank,
    probe_rates_of_tissue,
    probe_tissues_by_rate,
)
from tactsim.validation.study import RunOutcome

RATES = (1e-3, 0.5e-3, 3e-3)
FEM, FAST = ProbeRun(study="fem", run="r"), ProbeRun(study="fast", run="r")
BOTH = {"tissues": 3, "rates": RATES}


def outcome(stiffness, identifier="r"):
    """Pretended touches, shape (tissue, rate) in N/m, each force proportional to the depth."""
    history = {"tissue": [], "rate": [], "depth": [], "force": []}
    depth = np.array([0.0, 2.5e-3, 5e-3, 2.5e-3, 0.0])
    for (tissue, place), value in np.ndenumerate(np.asarray(stiffness, float)):
        columns = (np.full(5, tissue + 1.0), np.full(5, RATES[place]), depth, value * depth)
        for name, column in zip(history, columns, strict=True):
            history[name] += column.tolist()
    values = {name: tuple(column) for name, column in history.items()}
    return RunOutcome(id=identifier, case_id="r", status="converged", reason="end", quantities={}, history=values, seconds=0.0)


def inputs(fem, fast):
    return Inputs(studies={"fem": (outcome(fem),), "fast": (outcome(fast),)})


STIFF = np.array([[2.0, 1.0, 3.0], [4.0, 3.9, 4.1], [1.5, 1.4, 1.6]])


def test_equal_models_rank_alike_and_differ_by_nothing():
    same = inputs(STIFF, STIFF)
    assert probe_model_difference(same, FAST, FEM, **BOTH) == 0
    assert probe_order_kept(same, FAST, FEM, **BOTH) == 1


def test_one_turned_pair_counts_as_one():
    turned = STIFF.copy()
    turned[0, 0] = 1.4
    given = inputs(STIFF, turned)
    assert probe_order_kept(given, FAST, FEM, **BOTH) == pytest.approx(8 / 9)  # one of three pairs at one of three rates
    assert probe_model_difference(given, FAST, FEM, **BOTH) == pytest.approx(0.3)
    assert probe_model_difference(given, FEM, FAST, **BOTH) == pytest.approx(2 / 1.4 - 1)


def test_ranks_and_the_figure():
    given = inputs(STIFF, STIFF)
    ranks = [probe_rank(given, FEM, Press(tissue=k, rate=0.5e-3), tissues=3) for k in (1, 2, 3)]
    assert ranks == [3, 1, 2]
    with pytest.raises(InputError, match="tissue 4 of 3"):
        probe_rank(given, FEM, Press(tissue=4, rate=0.5e-3), tissues=3)
    drawn = probe_tissues_by_rate(given, "t", {"finite elements": FEM, "fast": FAST}, **BOTH)
    assert [len(part["curves"]) for part in drawn["panels"]] == [6, 6, 6]
    assert {curve["style"] for curve in drawn["panels"][0]["curves"]} == {"line", "points"}
    (part,) = probe_rates_of_tissue(given, "t", FEM, RATES, 2)["panels"]
    assert [curve["label"] for curve in part["curves"]] == ["1 mm/s", "0.5 mm/s", "3 mm/s"]
    assert part["curves"][1]["y"][-1] == pytest.approx(3.9 * 5e-3), "tissue 2 at the second rate, 5 mm deep"


@pytest.mark.slow
def test_the_ranking_of_figure_5_8_by_finite_elements(one_thread):
    """Nine touches, about three minutes: the order of the tissues is the fast model's, the forces are within 2 %."""
    paths = {"fem": CASES / "switch_tissues_fem.yaml", "fast": CASES / "switch_tissues.yaml"}
    both = Inputs(studies={name: (simulated(Task("r", str(path), ())),) for name, path in paths.items()})
    assert probe_order_kept(both, FAST, FEM, **BOTH) == 1
    assert probe_model_difference(both, FAST, FEM, **BOTH) < 0.025  # 1.97 %: tissue 1 at 0.5 mm/s, 5 mm

    def ratio(press, over, depth=5e-3):
        return probe_force_ratio(both, "fem", "r", press, over, depth=depth)

    def at(tissue, rate):
        return Press(tissue=tissue, rate=rate)

    assert all(probe_rank(both, FEM, at(2, rate), tissues=3) == 1 for rate in RATES)
    assert [probe_rank(both, FEM, at(1, rate), tissues=3) for rate in RATES] == [2, 3, 2], "1 and 3 change places at 0.5 mm/s"
    assert ratio(at(3, 0.5e-3), at(3, 1e-3)) < 1, "E26: passive tissue is softer when it is pressed more slowly"
