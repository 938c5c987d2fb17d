"""Jaws smaller than the block, on the mesh that a grasp has by default: taxels that mirror each other are equal, and right.

Mutants: cells without lines at the edges of the jaws, cells that no plane mirrors, and cells as thick as at larger jaws.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.results import Result

EQUAL = 3e-3
"""Difference allowed of equal taxels over the largest, a fifth of what the least palpable lump changes one by."""
SHARE = 8e-3
"""Difference allowed of a taxel from that of a finer mesh over the largest: that of a default mesh around an artery."""
FINE = np.array([[77.226, 76.596, 77.226], [76.596, 78.849, 76.596], [77.226, 76.596, 77.226]]) * 1e-3
"""Forces in N on the taxels of either jaw by 110 754 unknowns: ``{kind: graded, size: 3 mm, edge_size: 0.933 mm, growth: 0.6}``;
58 140 unknowns, cells at the edges half as thick again, differ by 0.35 %."""
CONVERGED = 4e-3
"""Difference allowed of the finer of two meshes, of which the finest differs by less."""
DRAWN, DRAWN_REACTION = (
    np.array([[278.209, 271.271, 278.209], [271.271, 289.782, 271.271], [278.209, 271.271, 278.209]]) * 1e-3,
    6.370,
)
"""Forces in N on the taxels of jaws around whose edges the tissue is drawn, and of the whole jaw, by 295 278 unknowns: ``{kind:
graded, size: 4 mm, edge_size: 0.333 mm}``."""
DRAWN_SHARE = 1e-2
"""Difference allowed there: 0.92 % of the taxel in the middle was found."""
SMALLER = {"width": 24e-3, "depth": 24e-3, "fillet": 2e-3}
TINY = {"width": 8e-3, "depth": 8e-3, "fillet": 0.7e-3}
FINE_TINY, FINE_TINY_REACTION = np.full((2, 2), 6.9578e-3), 0.124050
"""Forces in N on the taxels of such jaws, and of the whole jaw, by 218 262 unknowns: ``{kind: graded, size: 4 mm, growth: 0.6,
edge_size: 0.364 mm}``."""


def pressed(mesh: dict[str, Any]) -> np.ndarray:
    """Forces (jaw, row, column) in N on taxels that reach to 0.75 mm from the edges of flats of 20 mm, closed by 1 mm."""
    return forces_of(closed(SMALLER, {"rows": 3, "columns": 3, "pitch": 6.5e-3, "size": 5.5e-3}, 1e-3, mesh))


def pressed_by_tiny_jaws(mesh: dict[str, Any]) -> Result:
    """Jaws of a fifth of the block's sides."""
    return closed(TINY, {"rows": 2, "columns": 2, "pitch": 2.5e-3, "size": 2.2e-3}, 0.6e-3, mesh)


def closed(jaw: dict[str, float], matrix: dict[str, Any], by: float, mesh: dict[str, Any]) -> Result:
    """A block between two such jaws, closed by this much in m."""
    result = Grasp.model_validate(
        {
            "block": {"size": (40e-3, 40e-3, 20e-3), "tissue": "icf_stable"},
            "upper": jaw,
            "lower": jaw,
            "matrix": matrix,
            "contact": {"kind": "coulomb", "friction": 0.6},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": by, "duration": 1.0}]},
            "mesh": mesh,
            "time": {"steps": 1},
        }
    ).run()
    assert result.status == "converged"
    return result


def forces_of(result: Result) -> np.ndarray:
    """Forces (jaw, row, column) in N on the taxels."""
    return np.array([result.quantities[f"taxel_force_{side}"].value for side in JAWS])


def unlike(forces: np.ndarray) -> float:
    """Largest difference of taxels that should be equal, over the largest taxel."""
    images = [np.flip(forces, axis) for axis in (0, 1, 2)]
    return float(max(np.abs(forces - image).max() for image in images) / forces.max())


def check_equal(forces: np.ndarray) -> None:
    """Taxels that mirror each other are equal."""
    assert unlike(forces) < EQUAL


def check_right(forces: np.ndarray) -> None:
    """Taxels are those of a finer mesh."""
    assert np.abs(forces - FINE).max() < SHARE * FINE.max()


def test_taxels_of_jaws_smaller_than_the_block_are_equal_and_right(verification_record):
    forces = pressed({"kind": "automatic"})
    check_equal(forces)
    check_right(forces)
    known = {"reference": "taxels that are images of each other", "kind": "invariance", "mesh": "default", "tolerance": EQUAL}
    verification_record("equal taxels of jaws smaller than the block, difference", unlike(forces), 0.0, scale=1.0, **known)
    known = {"reference": "110 754 unknowns", "kind": "invariance", "mesh": "default, 25 558 unknowns", "tolerance": SHARE}
    verification_record("taxels of jaws smaller than the block", forces, np.stack([FINE, FINE]), **known)


@pytest.mark.slow
def test_cells_that_no_plane_mirrors_or_without_lines_at_the_edges_are_seen(monkeypatch):
    assert_kills(check_equal, not_mirrored=(pressed({"kind": "structured", "cells": (7, 7, 4)}),))
    monkeypatch.setattr(GraspSetup, "flats", [])
    assert_kills(check_right, without_edges=(pressed({"kind": "graded"}),))


def check_tiny(result: Result) -> None:
    """Taxels and the force of the jaw are those of a finer mesh."""
    assert np.abs(forces_of(result) - FINE_TINY).max() < CONVERGED * FINE_TINY.max()
    assert result.quantities["reaction_force"].value == pytest.approx(FINE_TINY_REACTION, rel=CONVERGED)


@pytest.mark.slow
def test_cells_at_the_edges_of_tiny_jaws_are_as_thin_as_these_ask(verification_record):
    result = pressed_by_tiny_jaws({"kind": "automatic"})
    check_tiny(result)
    known = {"reference": "218 262 unknowns", "kind": "invariance", "mesh": "default, 90 218 unknowns", "tolerance": CONVERGED}
    verification_record("taxels of jaws of a fifth of the block", forces_of(result), np.stack([FINE_TINY] * 2), **known)
    assert_kills(check_tiny, cells_of_larger_jaws=(pressed_by_tiny_jaws({"kind": "graded", "edge_size": 1.6e-3}),))


@pytest.mark.slow
def test_a_finer_mesh_reads_the_same(verification_record):
    forces = pressed({"kind": "graded", "size": 4e-3, "edge_size": 1.467e-3, "growth": 0.8})
    assert np.abs(forces - FINE).max() < CONVERGED * FINE.max()
    known = {
        "reference": "a finer mesh",
        "kind": "invariance",
        "mesh": "graded, 4 mm and 1.5 mm at edges",
        "tolerance": CONVERGED,
    }
    verification_record("taxel forces between narrow jaws", forces, FINE, **known)


def drawn_around_the_edges(radius: float) -> Result:
    """Jaws of half the block's sides, closed by 2.5 mm around edges of this radius in m, at little friction."""
    jaw = {"width": 30e-3, "depth": 30e-3, "fillet": radius}
    return Grasp.model_validate(
        {
            "block": {"size": (60e-3, 60e-3, 30e-3), "tissue": "icf_stable"},
            "upper": jaw,
            "lower": jaw,
            "matrix": {"rows": 3, "columns": 3, "pitch": 8e-3, "size": 7e-3},
            "contact": {"kind": "coulomb", "friction": 0.2},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 2.5e-3, "duration": 1.0}]},
        }
    ).run()


@pytest.mark.slow
def test_tissue_is_drawn_around_the_edges_of_jaws(verification_record, monkeypatch):
    result = drawn_around_the_edges(1e-3)
    assert result.status == "converged"
    assert np.abs(forces_of(result) - DRAWN).max() < DRAWN_SHARE * DRAWN.max()
    assert result.quantities["reaction_force"].value == pytest.approx(DRAWN_REACTION, rel=CONVERGED)
    known = {"reference": "295 278 unknowns", "kind": "invariance", "mesh": "default, 110 754 unknowns", "tolerance": DRAWN_SHARE}
    verification_record("taxels of jaws around whose edges tissue is drawn", forces_of(result), np.stack([DRAWN, DRAWN]), **known)
    sharper = 0.5e-3
    assert drawn_around_the_edges(sharper).status == "converged"
    for module in ("drawn_edges", "path"):  # the mutant: cells and contact of jaws around which nothing is drawn
        monkeypatch.setattr(f"tactsim.experiments.grasp.{module}.drawn_radius", lambda _: math.inf)
    assert drawn_around_the_edges(sharper).status == "failed"
