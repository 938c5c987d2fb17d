"""Cells and contact at edges of jaws that the closing draws the tissue around."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tactsim.experiments.grasp.drawn_edges import CELL_SHARE, SOFTNESS_SHARE, drawn_radius, following
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.regularisation import regularisation
from tactsim.mesh.graded.beside_jaws import THINNER, footprint_of

SMALLER = {"width": "30 mm", "depth": "30 mm", "fillet": "1 mm"}


def grasp(*, upper=SMALLER, lower=SMALLER, to="2.5 mm", control="displacement", **changes):
    return Grasp.model_validate(
        {
            "block": {"size": ("60 mm", "60 mm", "30 mm"), "tissue": "icf_stable"},
            "upper": upper,
            "lower": lower,
            "loading": {"control": control, "pieces": [{"kind": "ramp", "to": to, "duration": "1 s"}]},
        }
        | changes
    )


def thickness(experiment):
    """Of the cells at the edges in m."""
    source = following(experiment.source, experiment)
    flats = experiment.flats
    return footprint_of(flats, np.array(experiment.block.size), source.settings(experiment.block.size, flats)).settings.edge_size


@pytest.mark.parametrize(
    ("changes", "radius"),
    [
        ({}, 1e-3),
        ({"to": "0.9 mm"}, math.inf),
        ({"upper": SMALLER | {"fillet": "0.5 mm"}}, 0.5e-3),
        ({"upper": {"fillet": "0.5 mm"}}, 1e-3),
        ({"upper": {"fillet": "0.5 mm"}, "lower": {}}, math.inf),
        ({"upper": SMALLER | {"fillet": "0 mm"}}, 1e-3),
        ({"upper": SMALLER | {"fillet": "0.45 mm"}}, 1e-3),
        ({"control": "force", "to": "10 N"}, 1e-3),
        ({"control": "force", "to": "10 mN"}, math.inf),
    ],
    ids=[
        "both",
        "hardly closed",
        "the sharper",
        "one jaw",
        "larger jaws",
        "sharp",
        "sharper than cells",
        "by force",
        "by little force",
    ],
)
def test_the_tissue_is_drawn_around_round_edges_on_the_block(changes, radius):
    assert drawn_radius(grasp(**changes)) == radius


def test_cells_and_contact_follow_such_an_edge():
    drawn, hardly = grasp(), grasp(to="0.9 mm")
    assert thickness(drawn) == pytest.approx(CELL_SHARE * 1e-3)
    assert thickness(hardly) == pytest.approx(THINNER * 1.6e-3)
    assert regularisation(drawn).softness == pytest.approx(SOFTNESS_SHARE * 1e-3)
    assert regularisation(hardly).softness > SOFTNESS_SHARE * 1e-3


def test_what_a_case_says_of_the_cells_stays():
    experiment = grasp(mesh={"kind": "graded", "edge_size": "2 mm"})
    assert following(experiment.mesh, experiment) is experiment.mesh


def test_contact_is_never_stiffer_than_its_tolerance_asks():
    experiment = grasp(penetration_tolerance="50 um")
    assert regularisation(experiment).softness == experiment.tolerance > SOFTNESS_SHARE * 1e-3
