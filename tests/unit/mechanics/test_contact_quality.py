"""What a run says of contacts that its mesh hardly resolves."""

from __future__ import annotations

import numpy as np
import pytest

import tactsim as ts
from tactsim.mechanics.outcome.contact_quality import SMALL_CONTACTS

RADIUS, C10 = 2e-3, 1e3
HERTZ = 16 / 9 * 6 * C10 * RADIUS**0.5
"""Force in N of a ball on incompressible tissue over the displacement in m to the power of 3/2."""


def pressed(displacement: float, body: str = "sphere"):
    """A body pressed by a displacement in m into a wide block of cells a tenth of its radius long."""
    specimen = ts.Specimen(material=ts.NeoHookean(c10=C10), thickness=20 * RADIUS, radius=20 * RADIUS)
    return ts.Indentation(
        specimen=specimen,
        body={"kind": body, "radius": RADIUS},
        contact=ts.Coulomb(friction=0.0),
        displacement=displacement,
        mesh={"finest": RADIUS / 10, "growth": 1.0},
        stop="displacement",
    ).run()


@pytest.mark.parametrize(
    ("displacement", "words", "error"),
    [
        (1e-8, "no point of the surface has touched", 1.0),
        (1e-7, "no wider than a single point of the surface; its force may be off by 100 %", SMALL_CONTACTS[1]),
        (1e-6, "no wider than 2 points of the surface; its force may be off by 25 %", SMALL_CONTACTS[2]),
        (6e-6, "no wider than 4 points of the surface; its force may be off by 10 %", SMALL_CONTACTS[4]),
        (5e-5, None, 0.01),
    ],
)
def test_a_contact_between_the_points_of_the_surface_is_warned_of_and_its_force_is_off_by_no_more_than_said(
    displacement, words, error
):
    result = pressed(displacement)
    force = result.history["reaction_force"].values[-1]
    assert abs(force / (HERTZ * displacement**1.5) - 1) <= error
    said = [warning for warning in result.warnings if "surface" in warning]
    assert [words in warning and "take smaller elements" in warning for warning in said] == [True] * (words is not None)


def test_a_flat_contact_of_any_size_is_resolved():
    result = pressed(1e-8, "punch")
    assert not result.warnings
    assert np.isclose(result.history["reaction_force"].values[-1], 16 * C10 * RADIUS * 1e-8, rtol=0.05)  # 8 G a d; base, edge
