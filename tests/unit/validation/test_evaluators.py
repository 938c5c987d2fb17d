"""Evaluators and figures of the shipped tables that need no simulation."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tactsim.case import load_case
from tactsim.registry import kinds
from tactsim.validation import compare, load_tables
from tactsim.validation.evaluator import Drawing, Evaluator, Inputs
from tactsim.validation.evaluators.equal_force_ratio import EqualForceRatio
from tactsim.validation.evaluators.ranking_agreement import RankingAgreement
from tactsim.validation.study import RunOutcome

SHIPPED = Path(__file__).parents[3] / "cases" / "thesis"
WITHOUT_SIMULATION = ("table_3_1", "table_3_3", "figure_3_8", "section_2_2", "section_2_3")


@pytest.mark.parametrize("name", WITHOUT_SIMULATION)
def test_shipped_tables_hold(name: str) -> None:
    loaded = load_tables(SHIPPED, [name])
    outcome = compare(name, loaded.tables[name], SHIPPED, {})
    assert loaded.faults == ()
    assert [row.row.id for row in outcome.rows if not row.held] == []
    for drawing in outcome.table.figures.values():
        json.dumps(drawing.data(outcome.inputs))


def test_every_shipped_table_is_counted_and_its_cases_are_valid() -> None:
    loaded = load_tables(SHIPPED)
    assert loaded.faults == ()
    for table in loaded.tables.values():
        for study in table.studies:
            cases = [load_case(SHIPPED / study.case, study.overrides(run)) for run in study.runs]
            assert len({case.case_id for case in cases}) == len(study.runs)


@pytest.mark.parametrize(("package", "base"), [("evaluators", Evaluator), ("drawings", Drawing)])
def test_every_kind_has_a_valid_example(package: str, base: type) -> None:
    found = kinds(base)
    assert found
    for kind, cls in found.items():
        assert cls.example().kind == kind


def test_a_pair_in_another_order_lowers_the_agreement() -> None:
    assert RankingAgreement(first=(1, 2, 3), second=(10, 30, 20)).found(Inputs()) == pytest.approx(1 / 3, rel=1e-12)  # by hand


def test_the_thickness_limit_of_the_shipped_sensor() -> None:
    (row,) = (row for row in load_tables(SHIPPED, ["section_3_1_1"]).tables["section_3_1_1"].rows if row.id == "thickness_limit")
    assert row.evaluate is not None
    assert row.evaluate.found(Inputs(folder=SHIPPED)) == pytest.approx(0.8e-3, rel=1e-6)  # 24 halvings of 1.6 mm


def test_a_linear_rise_needs_half_the_recess_for_twice_the_hardness() -> None:
    history = {"tissue_rise": (0.0, 0.4e-3, 0.8e-3), "reaction_force": (0.0, 1.0, 2.0)}
    run = RunOutcome(id="a", case_id="a", status="converged", reason="", quantities={}, history=history, seconds=1)
    ratio = EqualForceRatio(study="s", run="a", recess=0.8e-3, hardness=2).found(Inputs(studies={"s": (run,)}))
    assert ratio == pytest.approx(2, rel=1e-12)  # exact for a straight line
