"""A material in words."""

from __future__ import annotations

import pytest

from tactsim.materials.library import LIBRARY, named_material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.materials.polynomial import Polynomial
from tactsim.materials.report import material_report
from tactsim.relaxation import Relaxation


@pytest.mark.parametrize("name", sorted(LIBRARY))
def test_a_shipped_set_reports_its_source_note_and_errors(name):
    entry = named_material(name)
    text = material_report(name, entry.material)
    assert text.startswith(f"{name} ({entry.material.kind})\n")
    assert entry.source in text
    assert entry.note in text
    assert ("largest relative error" in text) == (entry.fitted_stretch is not None)
    assert ("  open: " in text) == (entry.left_open is not None) == (entry.threshold_spread is not None)


def test_an_unstable_set_warns_and_names_its_window_and_a_stable_one_does_not():
    printed, stable = (material_report(name, named_material(name).material) for name in ("b1a_printed", "b1a_stable"))
    assert "WARNING" in printed
    assert "0.83 to 5; lost in 0.606 to 0.83" in printed
    assert "WARNING" not in stable
    assert "lost" not in stable


def test_constants_and_moduli_have_units():
    text = material_report("mine", NeoHookean(c10=3e3, bulk_modulus=1e6))
    lines = [line.split(maxsplit=1) for line in text.splitlines()]
    assert ["c10", "3 kPa"] in lines
    assert "shear G          6 kPa" in text
    assert "Young's E        17.964 kPa" in text  # 9 K G / (3 K + G)
    assert "bulk K           1 MPa" in text
    assert "source" not in text


def test_a_mapping_of_constants_and_plain_numbers():
    assert "c30              40 Pa" in material_report("mine", Polynomial.example())
    text = material_report("lump", LinearElastic.example())
    assert "poisson_ratio    0.49" in text
    assert "Young's E        18 kPa" in text


def test_the_name_of_a_set_does_not_lend_its_source_to_other_constants():
    assert "source" not in material_report("icf_stable", NeoHookean(c10=3e3))
    assert "source" not in material_report("icf_stable", LinearElastic.example())


def test_incompressible_is_said():
    assert "infinite (exactly incompressible)" in material_report("mine", NeoHookean(c10=3e3))


def test_relaxation_is_reported_with_its_times():
    relaxing = NeoHookean(c10=1000.0, relaxation=Relaxation(fractions=(0.25,), times=(2.0,)))
    text = material_report("mine", relaxing)
    assert "shear G at once    2 kPa" in text
    assert "shear G in the end 1.5 kPa" in text
    assert "0.25               relaxes in 2 s" in text
    assert "small strain, at once" in text
    assert "Relaxation" not in material_report("mine", NeoHookean(c10=1000.0))


def test_constants_that_hold_in_the_end_are_not_those_at_once():
    """The same report gave 2 kPa as the shear modulus at once, and 4 kPa a few lines below."""
    relaxation = Relaxation(fractions=(0.5,), times=(2.0,), constants="equilibrium")
    text = material_report("mine", NeoHookean(c10=1000.0, relaxation=relaxation))
    assert "Moduli at small strain, in the end\n  shear G          2 kPa" in text
    assert "shear G at once    4 kPa" in text
    assert "shear G in the end 2 kPa" in text
