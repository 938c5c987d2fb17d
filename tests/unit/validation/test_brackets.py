"""Brackets over several studies: the run at their lower end is the one that a row names; energies are the fits of their names."""

from __future__ import annotations

import pytest
from thesis_tables import shipped_table
from wrong_rows import misjudged

from tactsim.errors import InputError, UnknownName
from tactsim.identification.uniaxial import FORMS, fit_uniaxial
from tactsim.materials.library import named_material
from tactsim.materials.polynomial import Polynomial
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.brackets import Panel as BarPanel
from tactsim.validation.quantities.brackets import bracket, lowest_pressure, range_bars, threshold_spread
from tactsim.validation.quantities.materials import compression_curve, difference_of_fits
from tactsim.validation.study import RunOutcome

PRESSURES = {"wide": {"default": 40e3, "thin": 20e3}, "corners": {"thin, narrow": 30e3, "thick, narrow": None}}
BOTH = ("wide", "corners")


def run(name: str, pressure: float | None) -> RunOutcome:
    status = "failed" if pressure is None else "converged"
    quantities = {} if pressure is None else {"threshold_pressure": pressure}
    return RunOutcome(
        id=name, case_id=name, status=status, reason="collapsed", quantities=quantities, history={}, disc_share=0.75, seconds=1
    )


INPUTS = Inputs(studies={study: tuple(run(*item) for item in runs.items()) for study, runs in PRESSURES.items()})


@pytest.mark.parametrize(("area", "pressure"), [("annulus", 20e3), ("disc", 15e3)])
def test_the_lowest_run_gives_its_pressure(area: str, pressure: float) -> None:
    lowest = lowest_pressure(INPUTS, BOTH, "wide", "thin", area)  # type: ignore[arg-type]
    assert lowest == pytest.approx(pressure, rel=1e-12)
    assert bracket(INPUTS, BOTH, "threshold_pressure", area).low == lowest  # type: ignore[arg-type]


def test_another_run_than_the_lowest_is_refused_and_the_lowest_named() -> None:
    with pytest.raises(InputError, match="that of wide, thin, not of corners, thin, narrow"):
        lowest_pressure(INPUTS, BOTH, "corners", "thin, narrow", "disc")
    with pytest.raises(InputError, match="collapsed"):
        lowest_pressure(INPUTS, BOTH, "corners", "thick, narrow", "disc")
    with pytest.raises(UnknownName, match="thin"):
        lowest_pressure(INPUTS, BOTH, "wide", "thinn", "disc")


def test_a_run_without_the_quantity_is_named() -> None:
    with pytest.raises(InputError, match="the run default has no threshold_displacement: collapsed"):
        bracket(INPUTS, ("wide",), "threshold_displacement")


def test_a_spread_is_over_the_run_that_is_named() -> None:
    ends = [threshold_spread(INPUTS, BOTH, "wide", "default", end=end) for end in ("lowest", "highest")]  # type: ignore[arg-type]
    assert ends == pytest.approx([0.5, 1.0], rel=1e-12)
    assert threshold_spread(INPUTS, ("corners",), "wide", "thin", end="highest") == pytest.approx(1.5, rel=1e-12)


def test_the_figure_shows_runs_that_failed_and_where_a_study_ends() -> None:
    (panel,) = range_bars(INPUTS, "t", (BarPanel(studies=BOTH, title="a", printed=()),))["panels"]
    assert panel["groups"] == [2, 2]
    assert [bar["values"] for bar in panel["bars"]][-1] == []


def test_the_difference_of_fits_is_that_of_their_largest_and_smallest_stress() -> None:
    apart = difference_of_fits("icf_printed", ("3-parameter", "stable"))  # the first is the curve itself
    errors = fit_uniaxial(compression_curve("icf_printed"), "stable")
    assert apart == pytest.approx(errors.max_relative_error, rel=0.06)  # over either of the two, 5 % apart
    assert difference_of_fits("icf_printed", ("stable", "stable")) == 0


@pytest.mark.parametrize("elastomer", ["b1a", "icf"])
def test_the_energies_of_the_runs_are_the_fits_of_these_names(elastomer: str) -> None:
    (study,) = (study for study in shipped_table("table_3_2").studies if study.name == f"{elastomer}_energies")
    forms = [run.id for run in study.runs]
    assert forms == [form for form in FORMS if form.startswith("stable-")]
    for form, run_of_form in zip(forms, study.runs, strict=True):
        fit = fit_uniaxial(compression_curve(f"{elastomer}_printed"), form)
        (written,) = run_of_form.set.values()
        material = Polynomial.model_validate(written)
        assert fit.stability.strongly_elliptic
        assert material.terms == pytest.approx(fit.material.terms, rel=6e-5)  # five digits


@pytest.mark.parametrize("elastomer", ["b1a", "icf"])
def test_what_a_run_says_of_its_energy_is_what_the_table_holds(elastomer: str) -> None:
    rows = {row.id: row for row in shipped_table("table_3_2").rows}
    spread = named_material(f"{elastomer}_stable").threshold_spread
    assert spread == tuple(rows[f"{elastomer}.spread_{end}"].expected for end in ("low", "high"))


def test_the_rows_of_energies_hold_and_none_that_is_made_wrong() -> None:
    rows = [
        row
        for row in shipped_table("table_3_2").rows
        if row.evaluate and row.evaluate.kind in ("material_error", "difference_of_fits")
    ]
    assert len(rows) == 12
    assert misjudged(rows, Inputs()) == ([], [])
