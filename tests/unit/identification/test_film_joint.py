"""Line and creep of a film together: a film that has both comes back, the shipped one is the fitted one, no film keeps both."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.errors import InvalidQuantity
from tactsim.identification.film_joint import changed, identify_film_jointly
from tactsim.identification.film_line import identify_film
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.films.composite_library import named_composite
from tactsim.sensors.films.film import Film
from tactsim.sensors.films.tunnelling import relative_resistance
from tactsim.validation.quantities import film_line as quantities

LITERAL, JOINT = named_composite("lingstat_literal"), named_composite("lingstat_joint")
jointly = quantities._jointly
"""The film fitted with a weight of its creep, once for all tests and numbers of tables that ask for it."""
STATED = {"most": 0.039, "least": -0.0615}
"""Accuracy of the sensor of 3.1.2 in parts of the full scale."""


def test_the_fit_is_a_least_and_a_mutant_is_not():
    """The mean square of the errors rises whichever way a constant is moved."""
    fit = jointly(None)
    history = np.tile(fit.forces, (2, 1))

    def squares(composite):
        conductance = Film(composite=composite).conductance([0.0, 1.0], history)[-1]
        return float(np.mean((THESIS_LINE.conductance(fit.forces) / conductance - 1) ** 2))

    def check(composite):
        names, least = ("barrier", "initial_resistance", "contact_resistance"), squares(composite)
        moved = [squares(composite.model_copy(update={n: f * getattr(composite, n)})) for n in names for f in (0.999, 1.001)]
        assert least < min(moved)

    check(fit.composite)
    np.testing.assert_allclose(squares(fit.composite), np.mean(fit.errors**2), rtol=1e-9)
    assert_kills(check, barrier=(fit.composite.model_copy(update={"barrier": 1.01 * fit.composite.barrier}),))


def test_the_shipped_film_is_the_fitted_one():
    fitted = jointly(None).composite
    for name in ("barrier", "initial_resistance", "contact_resistance"):
        assert getattr(JOINT, name) == pytest.approx(getattr(fitted, name), rel=1e-4)
        assert abs(getattr(LITERAL, name) / getattr(fitted, name) - 1) > 0.1
    assert JOINT.instantaneous == LITERAL.instantaneous
    assert JOINT.viscosity == LITERAL.viscosity


def test_the_joint_film_lies_within_the_stated_accuracy_and_the_identified_one_does_not():
    def check(composite):
        assert quantities.film_line_error("most", composite) < STATED["most"]
        assert quantities.film_line_error("least", composite) > STATED["least"]

    check(JOINT)
    assert_kills(check, two_resistances_only=(named_composite("lingstat_identified"),))
    assert quantities.film_line_error("most", JOINT) == pytest.approx(0.0125, abs=2e-4)  # numbers that the guide gives
    assert quantities.film_line_error("least", JOINT) == pytest.approx(-0.0319, abs=2e-4)


def test_no_barrier_gives_the_line_without_half_a_drift():
    """With the creep as printed and both resistances fitted to the line, the conductance at 1 N grows by half in a minute."""
    seen = []
    for factor in np.linspace(0.4, 1.0, 13):
        composite = changed(LITERAL, np.log([factor]))
        fit = identify_film(composite, THESIS_LINE)
        update = {"initial_resistance": fit.initial_resistance, "contact_resistance": fit.contact_resistance}
        film = composite.model_copy(update=update)
        seen.append((np.abs(fit.errors).max(), quantities.film_drift(film)))
    errors, drifts = np.array(seen).T
    assert drifts[errors < 0.25].min() > 0.48
    assert drifts[errors < 0.08].min() > 0.52


def test_no_resistances_that_use_up_a_quarter_of_the_line_drift_by_less_than_a_quarter():
    """Fitted ones are not those of the least drift, as the guide says: more contact and less film creep less."""
    forces = np.linspace(0.5, 5.0, 91)
    seen = []
    for factor in np.linspace(0.4, 2.0, 9):
        composite = changed(LITERAL, np.log([factor]))
        early = Film(composite=composite).strain([0.0, 1.0], np.tile(forces, (2, 1)))[-1]
        alone = np.stack([forces**-0.5, relative_resistance(early, composite.exponent)])
        for part in np.linspace(0.0, 1.0, 201):
            weights = np.array([part, 1 - part]) / alone.max(axis=1)
            over = (weights @ alone) * THESIS_LINE.conductance(forces)
            contact, initial = 2 * weights / (over.max() + over.min())  # errors of both signs alike
            if contact > 0 and initial > 0 and over.max() / over.min() <= 1.25 / 0.75:
                update = {"contact_resistance": contact, "initial_resistance": initial}
                seen.append(quantities.film_drift(composite.model_copy(update=update)))
    assert 0.26 < min(seen) < 0.28


@pytest.mark.parametrize(
    ("weight", "errors", "changes"),
    [(0.3, (0.9, 0.95), (0.035, 0.045)), pytest.param(0.1, (0.0, 0.75), (0.15, 0.2), marks=pytest.mark.slow)],
)
def test_a_looser_creep_nears_the_line_and_leaves_the_printed_creep(weight, errors, changes):
    kept, weighed = jointly(None), jointly(weight)
    assert np.abs(kept.creep_changes).max() == 0
    assert errors[0] < np.abs(weighed.errors).max() / np.abs(kept.errors).max() < errors[1]
    assert changes[0] < np.abs(weighed.creep_changes).max() < changes[1]
    assert quantities.film_drift(weighed.composite) > quantities.film_drift(kept.composite), "the line is bought with drift"
    heavy = jointly(1e2)
    assert heavy.composite.barrier == pytest.approx(kept.composite.barrier, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"creep_weight": -1.0}, "creep_weight"),
        ({"creep_weight": np.inf}, "creep_weight"),
        ({"forces": (5.0, 0.5)}, "rising forces"),
    ],
)
def test_impossible_settings_are_refused(arguments, words):
    with pytest.raises(InvalidQuantity, match=words):
        identify_film_jointly(LITERAL, THESIS_LINE, **arguments)


def test_numbers_for_the_tables():
    assert quantities.joint_film("barrier") == pytest.approx(JOINT.barrier, rel=1e-4)
    assert quantities.joint_film("exponent") == pytest.approx(JOINT.exponent, rel=1e-4)
    assert quantities.joint_film("line_error") == pytest.approx(0.0763, abs=1e-4)
    assert quantities.joint_film("creep_change", creep_weight=0.3) == pytest.approx(0.04, abs=1e-3)
    assert quantities.joint_film("drift") == pytest.approx(quantities.film_drift(JOINT), rel=1e-4)
    assert quantities.film_drift(JOINT, since=1.0) < quantities.film_drift(JOINT), "what the first second creeps is in the line"
    drawn = quantities.film_line_and_drift("Line and drift", exponents=(150.0, 170.0))
    assert [len(part["curves"]) for part in drawn["panels"]] == [2, 2]
