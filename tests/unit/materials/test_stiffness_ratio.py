"""The stiffness of a lump over that of the tissue depends on the strain at which both work."""

import numpy as np
import pytest

from tactsim.analytic.eshelby_ball import eshelby_contrast, stiffness_ratio_of
from tactsim.localization.lump_response import stiffness_words
from tactsim.materials.homogeneous import nominal_stress, stiffness_ratio
from tactsim.materials.library import named_material


def test_the_lump_of_the_thesis_is_stiffer_than_icf_at_rest_and_softer_at_work():
    lump, tissue = (named_material(name).material for name in ("lump", "icf_stable"))
    assert stiffness_ratio(lump, tissue, 1.0) == pytest.approx(lump.shear_modulus / tissue.shear_modulus)
    assert stiffness_ratio(lump, tissue, 1 - 1e-5) == pytest.approx(stiffness_ratio(lump, tissue, 1.0), rel=1e-3)
    assert stiffness_ratio(lump, tissue, 1.0) > 1.6
    assert stiffness_ratio(lump, tissue, 0.9) < 1.0, "closed by 1 mm per jaw of 20 mm"
    assert stiffness_ratio(tissue, tissue, 0.9) == 1.0
    assert nominal_stress(lump, "uniaxial", np.array(0.9)) < 0


@pytest.mark.parametrize("ratio", [0.1, 1.0, 1.8, 9.0])
def test_the_ratio_of_a_small_ball_is_that_of_its_contrast(ratio):
    assert stiffness_ratio_of(float(eshelby_contrast(np.array(ratio)))) == pytest.approx(ratio, rel=1e-9)


def test_a_rigid_ball_has_no_ratio_but_words():
    assert stiffness_ratio_of(2.5) == np.inf
    assert stiffness_ratio_of(-2.0) == 0.0
    assert stiffness_words(0.0) == "1 times as stiff as the tissue at this closing"
    assert "more than 10 times" in stiffness_words(4.0)
    assert stiffness_words(-1.72, 1.75).startswith("0 to 1 times as stiff"), "not a hole, but not known either"
    assert stiffness_words(3.5, 2.6).startswith("2.4 to more than 10 times as stiff")
    assert stiffness_words(5.0, 1.0).startswith("more than 10 times as stiff")
