"""Volumes that elements do not keep, taxels beside the block, and forces that a mesh makes unlike are reported."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact.jaw import Jaw
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.overhang import covered_areas, overhang_warnings
from tactsim.experiments.grasp.symmetry import mirror_axes
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout

pytestmark = pytest.mark.usefixtures("one_thread")
SIZE = np.array([30e-3, 30e-3])
BALL = {"kind": "sphere", "radius": 4e-3}


def grasp(**changes):
    return Grasp.model_validate(Grasp.example().model_dump() | changes)


def run(**changes):
    return grasp(**changes).run()


def closing(to):
    return {"control": "displacement", "pieces": [{"kind": "ramp", "to": to, "duration": 1.0}]}


def test_an_incompressible_grasp_whose_elements_lose_their_volume_is_reported():
    result = run(loading=closing(3e-3))
    assert result.quantities["min_volume_ratio"].value < 0.8
    assert result.quantities["poor_volume_fraction"].value > 1e-3
    (reported,) = (warning for warning in result.warnings if "misses the volume" in warning)
    assert "the mesh is too coarse there" in reported
    assert "mm in region 0" in reported
    assert reported.endswith("take more mesh.cells")
    assert result.steps[-1].values["poor_volume_fraction"] <= result.quantities["poor_volume_fraction"].value


def test_tissue_that_may_change_its_volume_is_not_blamed():
    soft = {"kind": "neo_hookean", "c10": 1000.0, "bulk_modulus": 1500.0}
    result = run(
        block={"tissue": soft}, loading=closing(3e-3), contact={"kind": "coulomb", "friction": 0.0}, penetration_tolerance=2e-6
    )
    assert result.quantities["min_volume_ratio"].value < 0.9
    assert result.quantities["poor_volume_fraction"].value < 1e-3
    assert not any("misses the volume" in warning for warning in result.warnings)


def test_covered_areas_of_a_matrix_wider_than_the_block():
    layout = TaxelLayout(rows=3, columns=3, pitch=13e-3, size=9e-3)  # 35 mm on a block of 30 mm
    areas = covered_areas(Jaw(width=40e-3, depth=40e-3), SIZE / 2, SIZE, layout) * 1e6
    edge, corner = 9 * 6.5, 6.5**2
    assert areas == pytest.approx(np.array([[corner, edge, corner], [edge, 81.0, edge], [corner, edge, corner]]))
    far = covered_areas(Jaw(width=40e-3, depth=40e-3), np.array([100e-3, 15e-3]), SIZE, layout)
    assert far == pytest.approx(0.0)
    leaning = covered_areas(Jaw(width=40e-3, depth=40e-3, tilt_y=0.1), SIZE / 2, SIZE, layout) * 1e6
    assert leaning[1, 0] == pytest.approx(9 * (15 / np.cos(0.1) - 8.5))


def test_overhanging_taxels_are_reported_jaw_by_jaw():
    block = {"size": (30e-3, 30e-3, 20e-3), "tissue": "icf_stable"}
    wide = {"rows": 3, "columns": 3, "pitch": 13e-3, "size": 9e-3}
    upper, lower = overhang_warnings(grasp(block=block, matrix=wide))
    assert upper.startswith("8 of 9 taxels of the upper jaw reach beyond the block: 403 mm^2 of their 648 mm^2 (62.2 %) face it")
    assert "least row 1, column 1 with 42.25 mm^2 (52.2 %)" in upper
    assert "lower jaw" in lower
    assert overhang_warnings(grasp(block=block, matrix=wide | {"pitch": 10.5e-3})) == []


@pytest.mark.parametrize(
    ("changes", "axes"),
    [
        ({}, (0, 1)),
        ({"upper": {"tilt_x": 0.05}}, (0,)),
        ({"upper": {"tilt_y": 0.05}}, (1,)),
        ({"lower": {"offset": (1e-3, 0.0)}}, (1,)),
        ({"inclusions": [{"shape": BALL | {"center": (20e-3, 20e-3, 10e-3)}, "material": "lump"}]}, (0, 1)),
        ({"inclusions": [{"shape": BALL | {"center": (12e-3, 20e-3, 10e-3)}, "material": "lump"}]}, (1,)),
        ({"inclusions": [{"shape": BALL | {"center": (12e-3, 20e-3, 10e-3)}, "material": "icf_stable"}]}, (0, 1)),
        (
            {"inclusions": [{"shape": BALL | {"center": (x, 20e-3, 10e-3)}, "material": "lump"} for x in (12e-3, 28e-3)]},
            (0, 1),
        ),
        (
            {
                "inclusions": [
                    {"shape": BALL | {"center": (x, 20e-3, 10e-3)}, "material": material}
                    for x, material in ((12e-3, "lump"), (28e-3, "b1a_stable"))
                ]
            },
            (1,),
        ),
    ],
)
def test_what_mirrors_a_grasp(changes, axes):
    assert mirror_axes(grasp(**changes)) == axes


def test_a_mesh_that_shows_in_symmetric_forces_is_reported():
    result = run()
    forces = np.array([result.quantities[f"taxel_force_{side}"].value for side in JAWS])
    unlike = max(np.abs(forces - forces[:, ::-1]).max(), np.abs(forces - forces[:, :, ::-1]).max()) / forces.max()
    assert result.quantities["mirror_asymmetry"].value == pytest.approx(unlike)
    assert unlike > 0.01
    assert any("nothing smaller than this should be read from a single taxel" in warning for warning in result.warnings)
    assert (
        "mirror_asymmetry" not in run(upper={"offset": (1e-3, 1e-3)}, mesh={"kind": "structured", "cells": (2, 2, 2)}).quantities
    )
