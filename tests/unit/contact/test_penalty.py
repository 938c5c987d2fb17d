"""What a contact that is not as stiff as its penetration tolerance asks says of itself."""

from __future__ import annotations

import pytest

from tactsim.contact.penalty import RELAXED_SHARE, SLIP_SHARE, TARGET_SHARE, Augmentation, Regularisation

TOLERANCE = 1e-7


@pytest.mark.parametrize(
    ("penetration", "elastic_slip", "words"),
    [
        (2 * TOLERANCE, 0.0, "the penetration 2.00e-07 m stays above the tolerance 1.00e-07 m"),
        (
            TOLERANCE / 2,
            3 * SLIP_SHARE * TOLERANCE,
            "the elastic slip 3.00e-06 m stays above 1.00e-06 m, 10 times the penetration tolerance",
        ),
    ],
)
def test_the_one_that_is_too_large_is_named(penetration, elastic_slip, words):
    regularisation = Augmentation(TOLERANCE, softest=1e3, switch_length=1e-3, softness=1e-5)
    assert regularisation.excess(penetration, elastic_slip) > 1
    assert regularisation.excess_in_words(penetration, elastic_slip) == words


@pytest.mark.parametrize("largest", [1e2, 1e7])
def test_a_softened_contact_is_as_stiff_as_its_present_pressure_asks(largest):
    stiff = Regularisation(TOLERANCE, softest=1e6, switch_length=1e-3).seen(largest)
    softer = stiff.softened(200.0)
    assert 0.5 < 200.0 / softer.penalty / (RELAXED_SHARE * TOLERANCE) < 1 + 1e-9
    assert softer.seen(1e5).penalty > 10 * softer.penalty, "it becomes stiffer again where the pressure rises"
    assert softer.softened(200.0) is None, "hardly stiffer"
    assert stiff.softened(0.0) is None, "without a pressure there is no measure"
    assert stiff.softened(1e7 * RELAXED_SHARE / TARGET_SHARE) is None
