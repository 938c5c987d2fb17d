"""The closed form as an experiment: force and displacement answer each other, formulas, layers, and where it ends."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scenes import unmarked_figures

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.analytic.force_factor import force_factor
from tactsim.errors import CaseError
from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.materials.library import named_material
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.paths.loading import DisplacementLoading, ForceLoading
from tactsim.plotting import figures_for
from tactsim.relaxation import Relaxation

ELASTIC = NeoHookean(c10=500.0)


def displaced(*pieces):
    return DisplacementLoading.model_validate({"control": "displacement", "pieces": list(pieces)})


def column(result, name):
    return np.array([step.values[name] for step in result.steps])


def held(**changes):
    loading = displaced({"kind": "jump", "to": 1e-5, "duration": 1.0})
    return ClosedForm(**({"material": ELASTIC, "loading": loading} | changes)).run()


def test_elastic_force_by_formula_and_on_a_layer():
    unit = 8 * 1000.0 * 3e-3 * 1e-5
    assert column(held(), "force") == pytest.approx(unit * force_factor(0.5))
    assert column(held(formula="thesis_4_2_21"), "force") == pytest.approx(unit * force_factor(0.5, "thesis_4_2_21"))
    layer = solve_annular_punch(0.5, radius_over_thickness=1.0)
    assert column(held(thickness=3e-3), "force") == pytest.approx(unit * layer.force_factor)
    assert column(held(thickness=3e-3), "tissue_rise_axis") == pytest.approx(1e-5 * layer.rise_factor)


def test_force_gives_the_displacement_back():
    ramps = ({"kind": "ramp", "to": 1e-5, "duration": 1.0}, {"kind": "hold", "duration": 2.0})
    atrial = named_material("atrial").material
    first = ClosedForm(material=atrial, loading=displaced(*ramps), points=500).run()
    times, force = column(first, "time"), column(first, "force")
    samples = {"kind": "samples", "times": times.tolist(), "values": force.tolist()}
    loading = ForceLoading.model_validate({"control": "force", "pieces": [samples]})
    second = ClosedForm(material=atrial, loading=loading, points=2).run()
    expected = np.interp(column(second, "time"), times, column(first, "displacement"))
    np.testing.assert_allclose(column(second, "displacement"), expected, atol=1e-3 * 1e-5, err_msg="chords of 500 samples")


def test_a_pull_and_a_deep_displacement_are_reported_and_drawn():
    result = ClosedForm.example().run()
    assert result.status == "converged"
    assert any("outer radius" in warning for warning in result.warnings)
    assert not any("negative" in warning for warning in result.warnings), "0.2 N and 0.2 N just touch zero"
    pieces = [
        {"kind": "jump", "to": 0.2, "duration": 2.0},
        {"kind": "sine", "amplitude": 0.25, "frequency": 1.0, "duration": 2.0},
    ]
    pulling = ForceLoading.model_validate({"control": "force", "pieces": pieces})
    pulled = ClosedForm.example().model_copy(update={"loading": pulling}).run()
    assert any("a real contact opens there" in warning for warning in pulled.warnings)
    assert all(draw().startswith(b"\x89PNG") for draw in figures_for(pulled).values())
    assert unmarked_figures(pulled) == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"inner_radius": 3e-3}, "at most 0.99"),
        ({"thickness": 3e-3, "formula": "smythe"}, "is for a half-space"),
        ({"material": NeoHookean(c10=500.0, bulk_modulus=1e5)}, "incompressible"),
        ({"points": 1}, "at least 2"),
    ],
)
def test_impossible_cases_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        held(**changes)


def test_the_peak_before_a_jump_is_the_largest():
    """A Prony series under a ramp, integrated by hand; the mutants sample the jump only from behind, or miss a part."""
    fractions, times = np.array([0.4, 0.2]), np.array([0.1, 2.0])
    relaxing = NeoHookean(c10=500.0, relaxation=Relaxation(fractions=tuple(fractions), times=tuple(times)))
    pieces = [{"kind": "ramp", "to": 1e-4, "duration": 1.0}, {"kind": "jump", "to": 1e-5, "duration": 1.0}]
    result = ClosedForm(material=relaxing, loading=displaced(*pieces)).run()
    mean = 1 - fractions.sum() + fractions @ (times * -np.expm1(-1 / times))

    def check(displacement, force):
        assert displacement == pytest.approx(1e-4, rel=1e-12)
        assert force == pytest.approx(8 * 3e-3 * force_factor(0.5) * 1000.0 * 1e-4 * mean, rel=1e-9)

    check(*(result.quantities[f"largest_{name}"].value for name in ("displacement", "force")))
    rows, at_jump = [column(result, name) for name in ("displacement", "force")], column(result, "time") < 1 - 1e-9
    assert_kills(check, behind=tuple(float(values[at_jump].max()) for values in rows))
    assert np.count_nonzero(np.abs(column(result, "time") - 1) < 1e-9) == 2
    smooth = displaced(pieces[0], {"kind": "hold", "duration": 1.0})
    assert np.count_nonzero(np.abs(column(ClosedForm(material=relaxing, loading=smooth).run(), "time") - 1) < 1e-9) == 1


def test_a_sine_of_which_little_is_sampled_is_warned_of():
    def warned(points):
        pieces = [{"kind": "jump", "to": 0.2, "duration": 2.0}]
        pieces.append({"kind": "sine", "amplitude": 0.02, "frequency": 50.0, "duration": 4.0})
        loading = ForceLoading.model_validate({"control": "force", "pieces": pieces})
        return [text for text in held(loading=loading, points=points).warnings if "period" in text]

    assert warned(4001) == []
    (words,) = warned(4000)
    assert "sine of 50 Hz" in words
    assert "take 4001" in words
