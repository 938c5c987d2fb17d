"""Numbers that pages take from the record of the validation, or from the code, are those of the record and of the code."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tactsim.experiments.threshold.tip_model import FLAT_ERRORS
from tactsim.materials.library import named_material

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(scope="module")
def tables():
    return json.loads((DOCS / "verification" / "thesis.json").read_text(encoding="utf-8"))["tables"]


def page(name):
    return " ".join((DOCS / name).read_text(encoding="utf-8").split())


def test_the_lowest_threshold_pressures_over_the_printed_ones(tables):
    rows = tables["table_3_2"]["rows"]
    annular, either = ([rows[f"{set_}.fea{area}"] for set_ in ("b1a", "icf")] for area in ("_annulus", ""))
    first, second = (" and ".join(f"{min(row['computed']) / row['expected']:.1f}" for row in both) for both in (annular, either))
    assert f"the lowest pressures are {first} times the printed ones over the annular area, {second} times over the disc" in page(
        "theory/errata.md"
    )


def test_what_the_barrier_does_to_line_and_drift(tables):
    rows = {name: row["computed"] for name, row in tables["section_2_3"]["rows"].items()}
    line = [max(abs(rows[f"{film}_line_{side}"]) for side in ("above", "below")) for film in ("identified", "joint")]
    words = " and ".join(
        f"{what} from {100 * before:.0f} to {100 * after:.0f} %{of}"
        for what, of, before, after in (
            ("the error of the line", " of full scale", *line),
            ("the drift in a minute at 1 N", "", rows["identified_drift"], rows["joint_drift"]),
        )
    )
    assert words in page("guide/sensors.md")


def computed(tables, table):
    return {name: row["computed"] for name, row in tables[table]["rows"].items()}


def test_two_energies_that_fit_one_curve_and_their_thresholds(tables):
    rows = computed(tables, "table_3_2")
    highest = max(rows["icf.fea_annulus"])
    text = page("theory/materials.md")
    off, other = named_material("icf_stable").max_relative_error, rows["icf.energy_c20"]
    assert f"{100 * off:.1f} % off the curve at most) gives {highest / rows['icf.spread_high']:.1f} kPa" in text
    assert f"{100 * other:.1f} %) {highest:.0f} kPa" in text


@pytest.mark.parametrize("film", ["lingstat_identified", "lingstat_joint"])
def test_what_the_films_of_the_thesis_do_to_line_and_drift(tables, film):
    rows, short = computed(tables, "section_2_3"), film.removeprefix("lingstat_")
    lines = (DOCS / "theory" / "sensors.md").read_text(encoding="utf-8").splitlines()
    row = next(line for line in lines if line.startswith(f"| `{film}` |"))
    above, below = (100 * rows[f"{short}_line_{side}"] for side in ("above", "below"))
    error, drift = 100 * rows[f"{short}_line"], 100 * rows[f"{short}_drift"]
    assert (
        f"| {rows['exponent' if short == 'identified' else 'joint_exponent']:.1f} | {above:+.1f}, \N{MINUS SIGN}{-below:.1f} % |"
        in row
    )
    assert f"| {error:.2g} % | {drift:.0f} %, " in row


def test_the_closed_form_of_a_tip_against_finite_elements():
    text = page("theory/sensors.md")
    for recess, least, most in FLAT_ERRORS:
        numbers = " to ".join(
            f"{100 * error:+.0f}" if error > 0 else f"\N{MINUS SIGN}{-100 * error:.0f}" for error in (least, most)
        )
        assert f"| recess ${recess:.2f}\\, a$ | {numbers} % |" in text


def test_how_often_a_tip_meets_the_annulus(tables):
    rows = computed(tables, "chapter_7")
    shares = [f"{100 * rows[f'search.reached_{count}']:.0f}" for count in (3, 4, 8)]
    text = page("theory/sensors.md")
    assert f"3, 4, 5, 6 or 8 sensors has at least one mostly on it in {shares[0]}, {shares[1]}, " in text
    assert f" or {shares[2]} % (`tactsim validate chapter_7`)" in text


def test_solver_and_closed_form_on_tissue_that_relaxes(tables):
    rows = computed(tables, "cross_check_4")
    errors = [100 * rows[name] for name in ("step", "ramp", "preload_and_sine")]
    text = page("guide/time.md")
    assert f"with the closed form ({min(errors):.2f} to {max(errors):.2f} %)" in text
    assert (
        f"at a displacement of {rows['depth_icf_3_mm']:.2f} (3 mm thick) to {rows['depth_b1a_10_mm']:.2f} (B1-A, 10 mm)" in text
    )
    assert f"it stays within 10 % up to {rows['depth_neo_hookean_10_mm']:.1f} (" in text
