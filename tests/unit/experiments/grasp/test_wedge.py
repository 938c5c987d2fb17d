"""A block between jaws that lean towards each other is held only up to twice the angle of friction."""

from __future__ import annotations

import math
from typing import Any

import pytest

import tactsim as ts
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.jaw import Jaw
from tactsim.contact.stick import Stick
from tactsim.errors import CaseError
from tactsim.experiments.grasp.wedge import sliding_out
from tactsim.interfaces import ContactLaw


def leaning(upper: tuple[float, float], lower: tuple[float, float] = (0.0, 0.0)) -> tuple[Jaw, Jaw]:
    """Two jaws by their tilts about x and y in degrees."""
    tilts = [dict(zip(("tilt_x", "tilt_y"), map(math.radians, tilt), strict=True)) for tilt in (upper, lower)]
    return Jaw(side="upper", **tilts[0]), Jaw(side="lower", **tilts[1])


@pytest.mark.parametrize(
    ("upper", "lower", "angle"),
    [
        ((0, 4), (0, 0), 4),
        ((4, 0), (0, 0), 4),
        ((0, 3), (0, -2), 5),
        ((3, 0), (-1, 0), 4),
        ((0, 4), (0, 4), 0),
        ((-2, 3), (-2, 3), 0),
    ],
)
def test_the_angle_between_the_faces_is_twice_that_of_the_least_friction(upper: Any, lower: Any, angle: float) -> None:
    least = math.tan(math.radians(angle / 2))
    assert sliding_out(*leaning(upper, lower), Coulomb(friction=1.001 * least)) is None
    if angle:
        words = sliding_out(*leaning(upper, lower), Coulomb(friction=0.999 * least))
        assert words is not None
        assert words.startswith(f"the faces of the jaws lean by {angle}° towards each other, and friction holds a block up to ")


@pytest.mark.parametrize("law", [Stick(), Coulomb(friction=0.6)])
def test_usual_friction_holds_what_a_jaw_may_lean(law: ContactLaw) -> None:
    assert sliding_out(*leaning((0, 25)), law) is None


@pytest.mark.parametrize("width", [None, "12 mm"])
def test_a_case_is_refused_where_only_the_flats_of_the_faces_touch(width: str | None) -> None:
    case: dict[str, Any] = {
        "schema": "tactsim/case/1",
        "title": "wedge",
        "experiment": {
            "kind": "grasp",
            "block": {"size": ["20 mm", "20 mm", "10 mm"], "tissue": "icf_stable"},
            "upper": {"tilt_y": "4 deg"} | ({} if width is None else {"width": width}),
            "matrix": {"rows": 2, "columns": 2, "pitch": "5 mm", "size": "4 mm"},
            "contact": {"kind": "coulomb", "friction": 0.03},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": "1 mm", "duration": "1 s"}]},
        },
    }
    if width is not None:  # edges dig in, and may hold it
        assert ts.load_case(case).experiment.kind == "grasp"
        return
    with pytest.raises(
        CaseError, match=r"experiment.contact: .*lean by 4° towards each other, and friction holds a block up to 3\.4"
    ):
        ts.load_case(case)
