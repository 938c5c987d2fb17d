"""What a Prony series in a case accepts, and what its constants mean."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import CaseError
from tactsim.materials.any_material import read_material
from tactsim.materials.library import named_material
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.viscoelasticity import neo_hookean_of, shear_compliance, shear_relaxation
from tactsim.relaxation import Relaxation


@pytest.mark.parametrize(
    ("fractions", "times", "words"),
    [
        ((0.5,), (0.0,), "greater than 0"),
        ((0.5,), (-1.0,), "greater than 0"),
        ((0.0,), (1.0,), "greater than 0"),
        ((0.5, 0.5), (1.0, 2.0), "less than 1"),
        ((0.5,), (1.0, 2.0), "each fraction needs its time"),
        ((0.5,), (1e-300,), "allowed are"),
        ((), (), "at least 1"),
        ((float("nan"),), (1.0,), "finite"),
    ],
)
def test_what_is_not_a_fading_memory_is_refused(fractions, times, words):
    with pytest.raises(CaseError, match=words):
        Relaxation(fractions=fractions, times=times)


def test_constants_hold_at_once_or_in_the_end():
    at_once = Relaxation(fractions=(0.3, 0.2), times=(1.0, 5.0))
    in_the_end = Relaxation(fractions=(0.3, 0.2), times=(1.0, 5.0), constants="equilibrium")
    equilibrium, parts, _ = at_once.amplitudes
    assert equilibrium + parts.sum() == pytest.approx(1.0)
    assert in_the_end.amplitudes[0] == pytest.approx(1.0)
    assert in_the_end.amplitudes[1] == pytest.approx(np.array([0.3, 0.2]) / 0.5)


def test_shear_relaxation_of_a_material():
    material = MooneyRivlin2(c10=2.0, c01=1.0, relaxation=Relaxation(fractions=(0.4,), times=(5.0,)))
    shear = shear_relaxation(material)
    assert shear.relaxation(np.array([0.0, 5.0, 1e9])) == pytest.approx([6.0, 6 * (0.6 + 0.4 / np.e), 3.6])
    assert shear_relaxation(MooneyRivlin2(c10=2.0, c01=1.0)).relaxation(np.array([0.0, 7.0])) == pytest.approx([6.0, 6.0])
    assert shear_compliance(material).creep(np.array([0.0, 1e9])) == pytest.approx([1 / 6, 1 / 3.6])


@pytest.mark.parametrize("name", ["atrial", "atrial_printed"])
def test_atrial_sets_give_their_compliance_back(name):
    material = named_material(name).material
    again = neo_hookean_of(shear_compliance(material))
    times = np.geomspace(1e-6, 1e6, 100)
    np.testing.assert_allclose(shear_compliance(again).creep(times), shear_compliance(material).creep(times), rtol=1e-9)


def test_a_set_takes_a_relaxation_of_its_own():
    class Info:
        context = None

    changed = read_material({"set": "icf_stable", "relaxation": {"fractions": [0.2], "times": ["1 s"]}}, Info())
    assert changed.relaxation == Relaxation(fractions=(0.2,), times=(1.0,))
    assert changed.c10 == named_material("icf_stable").material.c10
    assert read_material({"set": "atrial", "relaxation": None}, Info()).relaxation is None
