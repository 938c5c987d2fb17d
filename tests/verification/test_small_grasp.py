"""A grasp of a tenth of the size: what is measured follows, and the lump is found at a tenth of the place.

Moduli, friction and strains are the same, so that forces are a hundredth and lengths a tenth, whatever the defaults of element
sizes, tolerances and radii are. Mutants: defaults of a large block for the small one, and rows of taxels for columns.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.localization.localization import Localization
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.localization.candidates import GAP
from tactsim.results import Result

TENTH = 0.1
STIFF = {"kind": "neo_hookean", "c10": 50e3}
FORCES, PLACES = 1e-4, 5e-3
"""Differences allowed of forces, over the largest, and of places, over the block's longest side: a candidate that touches a
border falls on either side of it by round-off."""


def grasped(part: float, *, lump: bool, mesh: dict[str, Any] | None = None) -> Result:
    """A block of 40 x 40 x 20 mm times ``part``, with a lump aside or without."""
    ball = {"kind": "sphere", "center": (22e-3 * part, 18e-3 * part, 12e-3 * part), "radius": 4e-3 * part}
    jaw = {"width": 50e-3 * part, "depth": 50e-3 * part, "fillet": 2e-3 * part}
    return Grasp.model_validate(
        {
            "block": {"size": (40e-3 * part, 40e-3 * part, 20e-3 * part), "tissue": "icf_stable"},
            "inclusions": [{"shape": ball, "material": STIFF}] if lump else [],
            "upper": jaw,
            "lower": jaw,
            "matrix": {"rows": 3, "columns": 3, "pitch": 11e-3 * part, "size": 9e-3 * part},
            "contact": {"kind": "coulomb", "friction": 0.6},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 1e-3 * part, "duration": 1.0}]},
            "mesh": mesh or {"kind": "automatic"},
        }
    ).run()


def located(folder: Path, part: float, grasp: str = "lump", **estimator: Any) -> Result:
    """What an estimator makes of the readings of a grasp of this size that a folder holds."""
    case = {"grasp": str(folder / grasp), "reference": str(folder / "plain"), "noise": 0.6e-3 * part**2}
    return Localization.model_validate(case | {"estimator": estimator}).run()


def turned(result: Result) -> Result:
    """The same grasp if rows of taxels were columns."""
    transposed = {
        name: replace(quantity, value=np.swapaxes(quantity.value, -1, -2).tolist())
        for name, quantity in result.quantities.items()
        if name.startswith("taxel_force_")
    }
    return replace(result, quantities=result.quantities | transposed)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> dict[float, Path]:
    """Folder of each size with a grasp with a lump, without, and with the lump and rows of taxels for columns."""
    folders = {part: tmp_path_factory.mktemp(f"{part:g}") for part in (TENTH, 1.0)}
    for part, folder in folders.items():
        grasp = grasped(part, lump=True)
        for name, result in (("lump", grasp), ("turned", turned(grasp)), ("plain", grasped(part, lump=False))):
            result.save(folder / name)
    return folders


def check_forces(small: Result, large: Result) -> None:
    """Forces on the taxels are in proportion to the area."""
    for side in JAWS:
        few, many = (np.array(result.quantities[f"taxel_force_{side}"].value) for result in (small, large))
        assert np.abs(few - TENTH**2 * many).max() < FORCES * TENTH**2 * many.max()


@pytest.mark.slow
def test_forces_are_a_hundredth(verification_record):
    small, large = (grasped(part, lump=True) for part in (TENTH, 1.0))
    check_forces(small, large)
    few, many = (np.array(result.quantities["taxel_force_upper"].value) for result in (small, large))
    known = {"reference": "the grasp of ten times the size", "kind": "invariance", "mesh": "default", "tolerance": FORCES}
    verification_record("taxels of a grasp of a tenth of the size", few, TENTH**2 * many, **known)
    sizes_of_large_blocks = {"kind": "graded", "size": 6e-3, "inclusion_size": 2e-3, "edge_size": 1.6e-3}
    assert_kills(lambda result: check_forces(result, large), coarse=(grasped(TENTH, lump=True, mesh=sizes_of_large_blocks),))


def check_places(small: Result, large: Result) -> None:
    """Centre and radius are in proportion to the side."""
    for name in ("estimated_center", "estimated_radius"):
        few, many = (np.array(result.quantities[name].value) for result in (small, large))
        assert np.abs(few - TENTH * many).max() < PLACES * TENTH * 40e-3, name


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["model_based", "hypotheses"])
def test_the_lump_is_found_at_a_tenth_of_the_place(kind, stored, verification_record):
    small, large = (located(stored[part], part, kind=kind) for part in (TENTH, 1.0))
    check_places(small, large)
    for name in ("estimated_center", "estimated_radius"):
        few, many = (np.array(result.quantities[name].value) for result in (small, large))
        known = {"reference": "the grasp of ten times the size", "kind": "invariance", "mesh": "default", "tolerance": PLACES}
        words = f"lump in a grasp of a tenth of the size, {name.replace('_', ' ')}, {kind.replace('_', '-')}"
        verification_record(f"{words}, over the side", few, TENTH * many, scale=TENTH * 40e-3, **known)
    rows_for_columns = located(stored[TENTH], TENTH, "turned", kind=kind)
    gap_of_large_blocks = located(stored[TENTH], TENTH, kind=kind, gap=GAP)
    assert_kills(lambda result: check_places(result, large), swapped=(rows_for_columns,), gap=(gap_of_large_blocks,))
