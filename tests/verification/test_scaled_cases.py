"""A case with all lengths, moduli and times multiplied gives the multiplied results: no constant in m, Pa, N or s hides in it."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from mutants import assert_kills
from small_problems import result_of

from tactsim.experiments.annulus.annulus_design import AnnulusDesign
from tactsim.experiments.threshold.catheter_tip import CatheterTip

pytestmark = pytest.mark.usefixtures("one_thread")
TOLERANCE = 1e-9
"""Relative: of an equilibrium, 1e-10, and what a stiff contact makes of it. 3e-13 was seen of forces."""


@dataclass(frozen=True)
class Scale:
    """What lengths, moduli and times are multiplied by: powers of two, with which every number keeps its digits."""

    length: float = 1.0
    modulus: float = 1.0
    time: float = 1.0

    @property
    def force(self) -> float:
        """What forces are multiplied by."""
        return self.modulus * self.length**2


CELL = Scale(2.0**-10, 2.0**-10, 2.0**-7)  # 10 um, 8 Pa, forces of nN
HULL = Scale(2.0**7, 2.0**18, 2.0**10)  # 1.3 m, 2 GPa, hours


def pressed(scale: Scale, *, relaxation_times: float | None = None, allowed: float | None = None) -> dict[str, float]:
    """Force, its estimated error and what a ball with friction pressed into relaxing rubber and held passes, over their scales.

    The first time of each piece at which a step must end is given, for by default it is no earlier than 1 us. Mutants leave the
    ``relaxation_times`` as they were, or allow a fixed penetration in m.
    """
    length, time = scale.length, scale.time
    cells = [{"length": 0.01 * length, "cells": 4}]
    times = time if relaxation_times is None else relaxation_times
    result = result_of(
        dimension="axisymmetric",
        geometry={"kind": "cylinder", "radial": cells, "axial": cells},
        material={
            "kind": "mooney_rivlin_2",
            "c10": 4e3 * scale.modulus,
            "c01": 1e3 * scale.modulus,
            "relaxation": {"fractions": [0.3, 0.3], "times": [0.25 * times, 4.0 * times]},
        },
        conditions=[{"kind": "clamped", "face": "bottom"}],
        contacts=[
            {
                "body": {"kind": "sphere", "radius": 0.004 * length},
                "side": "top",
                "face": "top",
                "at": [0.0, 0.01 * length],
                "z": -1e-3 * length,
                "law": {"kind": "coulomb", "friction": 0.3},
            }
        ],
        amplitude={"pieces": [{"kind": "ramp", "to": 1.0, "duration": time}, {"kind": "hold", "duration": time}]},
        penetration_tolerance=allowed,
        time={"tolerance": 1e-2, "per_decade": 1, "earliest": 1e-2 * time},
        asked={"number": {"kind": "force", "face": "bottom", "component": "z"}},
    )
    return {
        "force": float(result["number"].value) / scale.force,
        "penetration": float(result["max_penetration"].value) / length,
        "missing": float(result["penetration_force_error"].value),
        "steps": len(result.steps),
    }


def test_a_case_the_size_of_a_cell_and_one_of_a_hull_are_the_same(verification_record):
    """Mutants: relaxation times that stay, a penetration in m that stays."""
    plain = pressed(Scale())

    def check(scaled: dict[str, float]) -> None:
        assert scaled == pytest.approx(plain, rel=TOLERANCE)

    for name, scale in (("10 um and 8 Pa", CELL), ("1.3 m and 2 GPa", HULL)):
        scaled = pressed(scale)
        check(scaled)
        known = {"reference": "dimensional analysis", "kind": "invariance", "mesh": "4 x 4 cells", "tolerance": TOLERANCE}
        verification_record(f"ball held in relaxing rubber, {name}", scaled["force"], plain["force"], **known)
    assert_kills(check, times=(pressed(CELL, relaxation_times=1.0),), penetration=(pressed(HULL, allowed=1e-7),))


def designed(scale: Scale) -> dict[str, float]:
    """The design point of an annular sensor on atrial tissue, whose moduli and times are those of the thesis."""
    length = scale.length
    design = AnnulusDesign.model_validate(
        {
            "outer_radius": 3e-3 * length,
            "ratios": [0.1, 0.5],
            "recesses": [0.1e-3 * length, 0.7e-3 * length],
            "forces": [1.0 * length**2, 2.0 * length**2],
            "times": [0.5],
            "recommended_force": 2.0 * length**2,
            "largest_force": 3.0 * length**2,
            "design_point": {"ratio": 0.1, "recess": 0.7e-3 * length, "force": 1.0 * length**2, "time": 0.5},
        }
    ).run()
    point = {name: float(design[f"point_{name}"].value) for name in ("displacement", "rise", "force_to_touch")}
    return {name: value / (length**2 if name == "force_to_touch" else length) for name, value in point.items()}


def touched(scale: Scale) -> dict[str, float]:
    """Thresholds of the sensors of a tip that leans over three tissues; times are those of its electronics."""
    length, modulus = scale.length, scale.modulus
    tissues = [
        {"name": "leaflet", "shear_modulus": 20e3 * modulus, "thickness": 2e-3 * length, "base": "slipping"},
        {"name": "annulus", "shear_modulus": 60e3 * modulus, "thickness": 3e-3 * length},
        {"name": "atrium", "shear_modulus": 10e3 * modulus, "thickness": 3e-3 * length},
    ]
    radii = {"radius": 3e-3, "outer_radius": 1e-3, "inner_radius": 0.5e-3, "recess": 0.1e-3}
    result = CatheterTip.model_validate(
        {
            "surface": {"tissues": tissues, "borders": [13e-3 * length, 16e-3 * length]},
            "ring": {"count": 4} | {name: value * length for name, value in radii.items()},
            "place": (11e-3 * length, 2e-3 * length),
            "tilt": 0.03,
            "press": 1e-3 * length,
            "speed": 1e-3 * length,
            "trials": 1,
        }
    ).run()
    pressures, forces = (result[f"threshold_{name}"].value for name in ("pressure", "force"))
    return {f"{k}": value / modulus for k, value in enumerate(pressures)} | {
        f"force {k}": value / scale.force for k, value in enumerate(forces)
    }


@pytest.mark.parametrize("scale", [CELL, HULL], ids=["cell", "hull"])
def test_closed_forms_of_sensors_know_no_size(scale, verification_record):
    """Mutants: moduli that stay where the rest is multiplied, and forces over the lengths alone."""

    def check(found: dict[str, float]) -> None:
        assert found == pytest.approx(touched(Scale()), rel=TOLERANCE)

    assert designed(scale) == pytest.approx(designed(Scale()), rel=TOLERANCE)
    found = touched(scale)
    check(found)
    known = {"reference": "the unscaled sensor", "kind": "invariance", "mesh": "closed form", "tolerance": TOLERANCE}
    ratios = [found[name] / value for name, value in touched(Scale()).items()]
    verification_record("closed forms of a scaled sensor", ratios, 1.0, **known)
    of_forces = {name: value / (scale.length if "force" in name else 1.0) for name, value in found.items()}
    assert_kills(check, moduli=(touched(Scale(scale.length)) | {"0": found["0"] * scale.modulus},), lengths=(of_forces,))
