"""Which form of the energy is advised, and what else a user of ``tactsim material --fit`` is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tactsim.cli import main
from tactsim.errors import InvalidQuantity
from tactsim.identification.uniaxial import FORMS, fit_uniaxial, spread_of_forms, uniaxial_nominal_stress
from tactsim.identification.uniaxial_advice import advice, advised_form
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.library import LIBRARY
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

PLAIN = MooneyRivlin2(c10=2e3, c01=1e3)
COMPRESSION, TENSION = np.linspace(0.65, 0.99, 60), np.linspace(1.01, 1.8, 60)


def curve_of(material: Hyperelastic, stretch: np.ndarray, noise: float = 0.01) -> UniaxialCurve:
    factor = 1 + noise * np.random.default_rng(7).normal(size=stretch.size)
    return UniaxialCurve(stretch, uniaxial_nominal_stress(material, stretch) * factor, "made up")


@pytest.mark.parametrize("stretch", [COMPRESSION, TENSION])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_two_constants_are_advised_where_they_suffice(stretch: np.ndarray, noise: float) -> None:
    curve = curve_of(PLAIN, stretch, noise)
    fits = [fit_uniaxial(curve, form) for form in FORMS]
    assert advised_form(fits).form == "2-parameter"
    assert advice(fits).startswith("take 2-parameter: of the strongly elliptic forms")


def test_three_constants_are_advised_where_two_do_not_follow() -> None:
    curve = curve_of(LIBRARY["icf_stable"].material, COMPRESSION)
    fits = [fit_uniaxial(curve, form) for form in ("2-parameter", "3-parameter", "stable", "stable-c20-c30")]
    advised = advised_form(fits)
    assert len(advised.material.terms) == 3
    assert advised.stability.strongly_elliptic
    assert advice(fits[:1]) == "", "there is no choice"
    assert advised_form([fit for fit in fits if not fit.stability.strongly_elliptic]) is None


def test_fits_that_agree_on_the_other_side_are_said_to() -> None:
    curve = curve_of(PLAIN, TENSION, 0.001)
    (words,) = spread_of_forms([fit_uniaxial(curve, form) for form in FORMS])
    assert "at a stretch of 0.7 the stable fits agree within 0.4 %" in words
    assert "factor" not in words


def test_a_shear_modulus_at_rest_is_never_below_zero() -> None:
    rough = curve_of(PLAIN, np.linspace(1.5, 1.8, 12), 0.2)
    low, high = fit_uniaxial(rough, "2-parameter").certainty.shear_modulus
    assert low == 0.0 < high


def test_percent_without_their_unit_are_answered_with_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "curve.csv"
    for sign in (1, -1):
        rows = [f"{sign * percent},{sign * percent / 20}" for percent in range(5, 60, 5)]
        place.write_text("\n".join(["strain,stress [kPa]", *rows]), encoding="utf-8")
        code = main(["material", "--fit", str(place), "--form", "2-parameter"])
        assert code == (0 if sign > 0 else 2)
        assert "strain [%]" in capsys.readouterr().err
    place.write_text("\n".join(["strain [%],stress [kPa]", *rows]), encoding="utf-8")
    assert main(["material", "--fit", str(place)]) == 0
    out, err = capsys.readouterr()
    assert "strain [%]" not in err
    assert out.count("\ntake ") == 1


def test_the_message_of_a_stretch_below_zero_names_the_header() -> None:
    with pytest.raises(InvalidQuantity, match=r"a strain in percent has a header such as strain \[%\]"):
        UniaxialCurve(np.array([-29.0, -19.0, -9.0]), np.array([-3.0, -2.0, -1.0]), "x")
