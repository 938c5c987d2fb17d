"""The closed form as an experiment: force and displacement answer each other, formulas, layers, and where it ends."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import unmarked_figures

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.analytic.force_factor import force_factor
from tactsim.errors import CaseError
from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.materials.library import named_material
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.paths.loading import DisplacementLoading, ForceLoading
from tactsim.plotting import figures_for

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
