"""Few cells suffice around a hard ball near a jaw, but not one across."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from hard_balls import pressed_balls

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mesh.graded import cells as graded_cells
from tactsim.mesh.graded import lines as graded_lines

SHARE = 0.03
"""Difference allowed of a taxel's force over the largest taxel's."""
FINE, COARSE = 1.5e-3, 5e-3
"""Cells at the ball in m: six across, and as few as there may be."""


@functools.cache
def taxels(size: float, least: int) -> np.ndarray:
    """Forces (jaw, row, column) in N after a closing of 0.1 mm, with cells of ``size`` in m and at ``least`` so many across
    along the jaws."""
    before = graded_lines.LEAST_ALONG, graded_lines.PAIRED
    graded_lines.LEAST_ALONG, graded_lines.PAIRED = least, 1 if least % 2 else 2
    try:
        result = Grasp.model_validate(
            {
                "block": {"size": (24e-3, 24e-3, 20e-3), "tissue": "icf_stable"},
                "inclusions": [
                    {
                        "shape": {"kind": "sphere", "center": (11e-3, 12.5e-3, 8.1e-3), "radius": 4.7e-3},
                        "material": {"kind": "neo_hookean", "c10": 226e3},
                    }
                ],
                "matrix": {"rows": 3, "columns": 3, "pitch": 8e-3, "size": 7e-3},
                "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 1e-4, "duration": 1.0}]},
                "mesh": {"kind": "graded", "inclusion_size": size, "edge_size": 2.2e-3},
                "time": {"steps": 1},
            }
        ).run()
    finally:
        graded_lines.LEAST_ALONG, graded_lines.PAIRED = before
    assert result.status == "converged"
    return np.array([result.quantities[f"taxel_force_{side}"].value for side in JAWS])


def difference(least: int) -> float:
    """Of the default cells from fine ones, over the largest taxel."""
    fine = taxels(FINE, graded_lines.LEAST_ALONG)
    return float(np.abs(taxels(COARSE, least) - fine).max() / fine.max())


@pytest.mark.slow
def test_a_hard_ball_near_a_jaw_is_felt_right(verification_record):
    found = difference(graded_lines.LEAST_ALONG)
    assert found < SHARE
    known = {"reference": "six cells across the ball", "kind": "invariance", "mesh": "graded, default cells", "tolerance": SHARE}
    verification_record("taxels over a hard ball near a jaw", found, 0.0, scale=1.0, **known)


@pytest.mark.slow
def test_one_cell_across_would_miss_the_peak():
    assert difference(1) > SHARE


TETRAHEDRA = 68.22e-3
"""Force in N on the taxel over a hard ball in the middle by 72 727 unknowns of tetrahedra, 1 mm long at the ball; by 46 422 of
1.6 mm 68.29 mN, by 118 799 of graded cells in five layers around the ball 68.65 mN."""
LAYERED = 0.03


def over_the_ball():
    tissue = {"kind": "neo_hookean", "c10": 6.7e3}
    cells = {"size": 4e-3, "inclusion_size": 2e-3, "edge_size": 1.6e-3, "growth": 0.6}
    return pressed_balls([(20e-3, 20e-3, 12e-3)], 5e-3, tissue, cells)[0, 1, 1]


def with_layers(count, monkeypatch):
    ends = np.arange(1, count) / count
    monkeypatch.setattr(graded_cells.Filling, "ends", lambda self, wall, box: ends)
    return over_the_ball() / TETRAHEDRA - 1


def test_graded_cells_press_over_a_hard_ball_as_tetrahedra_do(verification_record):
    found = over_the_ball()
    assert abs(found / TETRAHEDRA - 1) < LAYERED
    known = {"reference": "fine tetrahedra", "kind": "invariance", "mesh": "graded, 4 and 2 mm", "tolerance": LAYERED}
    verification_record("taxel over a hard ball 3 mm below a jaw", found, TETRAHEDRA, **known)


@pytest.mark.slow
def test_two_layers_around_a_hard_ball_would_be_too_few(monkeypatch):
    assert with_layers(2, monkeypatch) > LAYERED
    assert with_layers(1, monkeypatch) > 5 * LAYERED


HARD = 50.0
STIFF = {"a tenth": 0.1, "as stiff": 1.0, "thrice": 3.0, "fifty times": HARD}
"""Modulus of a ball over that of the tissue at rest."""
TISSUE_C10 = 1.78e3
"""c10 in Pa of neo-Hookean tissue as stiff at rest as `icf_stable`."""
SAME = 5e-4
"""Difference of a taxel over the largest up to which fans and cells are felt alike; these cells are off by 1 %."""
OF_SWEEPS = {"size": 1e-2, "inclusion_size": 4e-3, "edge_size": 3.2e-3}


@functools.cache
def closed_on(stiffness: float, size: tuple[float, float, float], **cells: object) -> np.ndarray:
    """Forces (jaw, row, column) in N after a closing of 1 mm at friction 0.6 on a ball of 4.7 mm, by default with `OF_SWEEPS`."""
    count = int(size[0] // 12e-3)
    result = Grasp.model_validate(
        {
            "block": {"size": size, "tissue": "icf_stable"},
            "inclusions": [
                {
                    "shape": {"kind": "sphere", "center": FAR_OFF[size], "radius": 4.7e-3},
                    "material": {"kind": "neo_hookean", "c10": stiffness * TISSUE_C10},
                }
            ],
            "matrix": {"rows": count, "columns": count, "pitch": 10e-3, "size": 9e-3},
            "contact": {"kind": "coulomb", "friction": 0.6},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 1e-3, "duration": 1.0}]},
            "mesh": {"kind": "graded", **OF_SWEEPS, **cells},
            "time": {"steps": 1},
        }
    ).run()
    assert result.status == "converged"
    return np.array([result.quantities[f"taxel_force_{side}"].value for side in JAWS])


def apart(found: np.ndarray, known: np.ndarray) -> float:
    """Largest difference of a taxel over the largest taxel."""
    return float(np.abs(found - known).max() / known.max())


SMALL, LARGE = (24e-3, 24e-3, 20e-3), (40e-3, 40e-3, 20e-3)
FAR_OFF = {SMALL: (11e-3, 12.5e-3, 8.1e-3), LARGE: (18e-3, 22e-3, 8.1e-3)}
"""Sizes of blocks, the larger that of sweeps, and in each the middle of a ball that no plane mirrors."""
IN_LARGE = [pytest.param(ratio, LARGE, id=name, marks=pytest.mark.slow) for name, ratio in STIFF.items()]


@pytest.mark.parametrize(("stiffness", "size"), [*IN_LARGE, pytest.param(HARD, SMALL, id="fifty times, small")])
def test_a_fan_in_a_ball_is_felt_as_cells_are(stiffness, size, verification_record):
    found = apart(closed_on(stiffness, size, filling="fan"), closed_on(stiffness, size))
    assert found < SAME
    mesh = "graded, cells of the sweeps" + (" in a small block" if size == SMALL else "")
    known = {"reference": "cells in the ball", "kind": "invariance", "mesh": mesh, "tolerance": SAME}
    verification_record(f"taxels over a fan {stiffness:g} times as stiff as the tissue", found, 0.0, scale=1.0, **known)


@pytest.mark.slow
def test_a_ball_a_tenth_as_stiff_would_be_felt_otherwise():
    assert apart(closed_on(HARD / 10, SMALL), closed_on(HARD, SMALL, filling="fan")) > SAME
