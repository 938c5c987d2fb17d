"""The card of a data set: what it says, and that the lines of code in it run."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import xarray
from drawn import colliding_words, text_of
from sweeps import TEXT, Inline, run_sweep, sweep_file

import tactsim as ts
from tactsim.dataset.cost import cost_of
from tactsim.dataset.figures.card import Spread, _numbers, spread, taxels
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.sampling.layout import layout_of
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.opening import Store
from tactsim.dataset.use import card
from tactsim.dataset.use.card import _use, card_text
from tactsim.shipped import CASES, PROGRAM

GALLERY = PROGRAM / "docs/gallery/stored"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A small store and the text of its card."""
    folder = tmp_path_factory.mktemp("card")
    sweep = load_sweep(sweep_file(folder))
    with opened_run(sweep, folder / "s.zarr") as going:
        going.compute(Inline(sweep), lambda tally: None)
    return folder / "s.zarr", card_text(Store.open(folder / "s.zarr"), sweep, layout_of(sweep))


def test_numbers_that_stand_for_words_are_named(store: tuple[Path, str]) -> None:
    _, written = store
    assert "| status |  | 1 | whether the sample was computed: 0 pending, 1 done, 2 failed |" in written
    assert "by specimen: 0 train, 1 validation, 2 test, 3 softer |" in written


def test_what_samples_warn_of_is_counted(tmp_path: Path) -> None:
    deep = TEXT.replace("0.2 mm", "0.9 mm")
    assert deep != TEXT
    sweep = load_sweep(sweep_file(tmp_path, deep))
    with opened_run(sweep, tmp_path / "s.zarr") as going:
        going.compute(Inline(sweep), lambda tally: None)
    stored = Store.open(tmp_path / "s.zarr")
    counts = {one.text: one for one in card.warnings_of(stored)}
    (beyond,) = (words for words in counts if "linear theory" in words)
    these = [number for number, text in enumerate(stored.read("warnings")) if "linear theory" in text]
    assert (counts[beyond].count, list(counts[beyond].first)) == (len(these), these[:5])
    assert these
    assert beyond in card.description(tmp_path / "s.zarr")
    assert "## Warnings of samples that are done" in card_text(stored, sweep, layout_of(sweep))


def test_an_option_whose_cases_are_all_refused_is_named(tmp_path: Path) -> None:
    """A law lacks a constant, so that half of the draws are refused and drawn again: a possible case takes their place."""
    listed = "inner_radius: {values: [1 mm, 1.1 mm, 1 mm]}\n  base: {choice: [bonded, slipping]}"
    text = TEXT.replace("inner_radius: {uniform: [1 mm, 2.5 mm]}", listed)
    text = text.replace("kind: neo_hookean", "kind: {choice: [neo_hookean, mooney_rivlin_2]}")
    sweep = load_sweep(sweep_file(tmp_path, text))
    stored = run_sweep(sweep, tmp_path / "s.zarr").store
    assert set(stored.read("varied_material_kind")) == {0.0}
    (line,) = card.never_drawn_lines(stored, sweep)
    assert "no sample has 'mooney_rivlin_2' for experiment.material.kind, which 50 % of the draws have" in line
    assert line in card_text(stored, sweep, layout_of(sweep))


def test_nothing_is_said_of_options_without_a_refusal(store: tuple[Path, str]) -> None:
    assert "no sample has" not in store[1].replace("no sample that is done", "")


def test_columns_of_long_names_align(store: tuple[Path, str], monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [("force", "time 4", "N", "short"), ("varied_" + 40 * "x", "jaw 2, row 3, column 3, axis 3", "m", "long")]
    monkeypatch.setattr(card, "variable_rows", lambda store: rows)
    short, long = card.description(store[0]).splitlines()[-2:]
    assert short.index("short") == long.index("long")


def test_the_code_in_the_card_runs(store: tuple[Path, str], monkeypatch: pytest.MonkeyPatch) -> None:
    place, card = store
    loaders = ModuleType("torch.utils.data")
    loaders.DataLoader = lambda samples, **options: (samples, options)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "torch.utils.data", loaders)
    parts = re.findall(r"```python\n(.*?)```", card, flags=re.DOTALL)
    assert len(parts) == 3
    names: dict = {}
    for part in parts:
        exec(part.replace("STORE", str(place)), names)  # noqa: S102  the card is ours
    assert names["done"].sizes["sample"] == 24
    assert names["train"].sizes["sample"] + names["test"].sizes["sample"] < 24
    assert names["loader"][0].inputs == ("read_force",)
    assert names["loader"][0].targets == ("inner_radius",)
    assert len(names["samples"]) == names["train"].sizes["sample"]


def test_the_card_reports_what_the_store_holds(store: tuple[Path, str]) -> None:
    place, card = store
    held = Store.open(place)
    for name, array in held.described.items():
        assert f"| {name} | " in card
        assert str(array.attributes["long_name"]).replace("|", "/") in card
    assert "| done | 24 |" in card
    assert "| force_at_the_moon | " not in card


def test_the_code_in_the_card_learns_from_forces_and_not_from_the_mesh() -> None:
    """A count that is the same in every sample and the error of the contact are no example of what is learned."""
    alone = ("experiment.readout=null", "sweep.within_specimen=[]", "sweep.samples_per_specimen=1")
    for name, overrides in (("read_force", ()), ("taxel_force", alone)):
        use = "\n".join(_use(layout_of(load_sweep(CASES / "sweep_lumps.yaml", overrides))))
        assert f'inputs=["{name}"], targets=["inclusion_center"]' in use


def test_the_code_in_the_card_learns_what_varies_from_forces_over_time(tmp_path: Path) -> None:
    """The card of a timed indentation by a ball learned the radius of its hole, 0 in all samples, from the times."""
    ball = (
        "schema: tactsim/sweep/1\nexperiment:\n  kind: timed_indentation\n  specimen: {material: icf_stable, thickness: 4 mm}\n"
    )
    body = "  body: {kind: sphere, radius: {uniform: [2 mm, 4 mm]}}\n  loading: {control: displacement, pieces: "
    loading = "[{kind: ramp, to: 0.2 mm, duration: 1 s}]}\nsweep: {samples: 4, times: 8}\n"
    layout = layout_of(load_sweep(sweep_file(tmp_path, ball + body + loading)))
    assert 'inputs=["reaction_force_history"], targets=["outer_radius"]' in "\n".join(_use(layout, {"outer_radius"}))


def test_the_figures_of_a_card_have_a_title_and_words_that_stand_clear() -> None:
    """The numbers of 16 rows stood on each other, and forces of some micronewtons had a power of ten beside the colours."""
    force = 1e-5 * np.random.default_rng(1).random((2, 16, 16))
    figures = [taxels(force, "Lumps: 3 samples"), spread({"largest_force": Spread(force[0, 0], "N")}, "Lumps: 3 samples")]
    for figure in figures:
        assert colliding_words(figure) == []
        assert figure.get_suptitle() == "Lumps: 3 samples"
    assert "mean force in µN" in text_of(figures[0])


def test_what_was_drawn_has_a_histogram_unless_a_label_says_the_same() -> None:
    """The tilt of a jaw, which is no label, was in no picture of the card."""
    modulus = np.array([6e3, 8e3, 7e3])
    spreads = {
        "shear_modulus": ("label", modulus),
        "varied_c10": ("varied", np.where(modulus > 7e3, np.nan, modulus / 2)),  # of samples that drew another material
        "varied_tilt": ("varied", np.array([-0.01, 0.02, 0.0])),
        "volume_ratio": ("reading", np.array([0.9, 0.95, 0.93])),
    }
    variables = {name: ("sample", values, {"role": role, "units": "1"}) for name, (role, values) in spreads.items()}
    assert list(_numbers(xarray.Dataset(variables))) == ["shear_modulus", "varied_tilt", "volume_ratio"]


def test_ticks_of_narrow_ranges_are_not_written_over_each_other() -> None:
    """Of a direction from -0.06 to 0.07 they ran together."""
    shares = np.linspace(0, 1, 30)
    ranges = {
        "direction_z": (-0.058, 0.069),
        "volume_ratio": (0.804, 0.94),
        "tiny": (1.00012, 1.00019),
        "large": (-2600.0, 2666.0),
    }
    figure = spread({name: Spread(low + (high - low) * shares, "1") for name, (low, high) in ranges.items()}, "Lumps: 30 samples")
    figure.draw_without_rendering()
    for axis in figure.axes:
        low, high = axis.get_xlim()
        ticks = [tick for tick in axis.xaxis.get_major_ticks() if low <= tick.get_loc() <= high]
        boxes = sorted((box.x0, box.x1) for tick in ticks if (box := tick.label1.get_window_extent()).width > 1)
        assert len(boxes) >= 2
        assert all(first[1] + 4 < second[0] for first, second in pairwise(boxes)), axis.get_title(loc="left")


def test_the_card_and_the_description_say_what_the_slowest_samples_cost(tmp_path: Path) -> None:
    sweep = load_sweep(sweep_file(tmp_path))
    run_sweep(sweep, tmp_path / "s.zarr")
    stored = Store.open(tmp_path / "s.zarr", writing=True)
    steps, *others = np.unique(stored.read("steps")).tolist()
    assert (steps > 4, others) == (True, []), "the moments of the closed form"
    stored.array("wall_time")[:] = np.linspace(1, 24, 24)
    stored.array("unknowns")[23], stored.array("newton_iterations")[23] = 40_000, 31
    told = f"24 s, sample 23, 40000 unknowns, {steps} steps, 31 Newton iterations"
    assert f"\n- {told}\n" in card_text(stored, sweep, layout_of(sweep))
    assert f"    {told}\n" in card.description(tmp_path / "s.zarr")


def test_the_cost_of_a_run_is_that_of_its_solver() -> None:
    result = ts.load_result(GALLERY / "indentation")
    cost = cost_of(result)
    assert cost["newton_iterations"] == result.scene.solver.newton_iterations > len(result.steps) == cost["steps"]
    assert (cost["unknowns"], cost["rejected_steps"]) == (result.scene.solver.unknowns, result.scene.solver.rejected_steps)
    assert cost["unknowns"] > 1000
    grasp = ts.load_result(GALLERY / "grasp_lump")
    stopped = replace(grasp, scene=None, steps=())
    assert cost_of(stopped) == dict.fromkeys(cost, 0) | {"unknowns": cost_of(grasp)["unknowns"]}
