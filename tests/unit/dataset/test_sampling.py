"""Which samples a sweep draws: from the seed and their number only, possible ones, specimens shared."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
from sweeps import TEXT, sweep_file

from tactsim.cli import main
from tactsim.dataset.running.computing import computed
from tactsim.dataset.sampling.drawing import design_point, drawn_specimen
from tactsim.dataset.sampling.layout import first_case, layout_of, most_inclusions, split_of
from tactsim.dataset.sampling.suitable import check_suitable
from tactsim.dataset.sampling.sweep import Sweep, load_sweep, sweep_of_text
from tactsim.dataset.store.blocks import decoded
from tactsim.errors import CaseError
from tactsim.shipped import CASES

GRID = """\
schema: tactsim/sweep/1
experiment:
  kind: closed_form
  material: {kind: neo_hookean, c10: {values: [3 kPa, 5 kPa]}}
  outer_radius: {range: [3 mm, 5 mm, 3]}
  loading: {control: displacement, pieces: [{kind: ramp, to: {values: [0.1 mm, 0.2 mm]}, duration: 1 s}]}
sweep: {design: grid, within_specimen: [experiment.loading.pieces.0.to]}
"""


def sweep_of(folder: Path, text: str = TEXT, samples: int | None = None) -> Sweep:
    return load_sweep(sweep_file(folder, text), samples=samples)


def values_of(sweep: Sweep, specimens: range) -> list[dict]:
    return [drawn.values for specimen in specimens for drawn in drawn_specimen(sweep, specimen)]


@pytest.mark.parametrize("design", ["sobol", "random"])
def test_a_sample_depends_on_the_seed_and_its_number_only(tmp_path: Path, design: str) -> None:
    text = TEXT.replace("seed: 7", f"seed: 7\n  design: {design}")
    few, many = sweep_of(tmp_path, text), sweep_of(tmp_path, text, samples=3000)
    assert values_of(few, range(8)) == values_of(many, range(8))
    assert drawn_specimen(many, 700)[2].values == drawn_specimen(sweep_of_text(many.text), 700)[2].values
    other = sweep_of(tmp_path, text.replace("seed: 7", "seed: 8"))
    assert values_of(other, range(8)) != values_of(few, range(8))
    assert few.identity == many.identity != other.identity


def test_a_sobol_design_is_the_same_across_its_blocks() -> None:
    points = np.array([design_point("sobol", (1, 0), k, count=0, dimensions=2) for k in range(2048)])
    assert len(np.unique(points, axis=0)) == 2048
    cells = np.histogram2d(*points.T, bins=16, range=[[0, 1], [0, 1]])[0]
    assert (cells == 8).all()  # what a net of 2^11 points in two dimensions has in each of 256 squares


@pytest.mark.parametrize(("text", "samples"), [(TEXT, 3), (TEXT, 2), ((CASES / "sweep_rates.yaml").read_text(), 3)])
def test_what_varies_within_a_specimen_does_not_follow_the_specimen(tmp_path: Path, text: str, samples: int) -> None:
    sweep = sweep_of(tmp_path, text.replace("samples_per_specimen: 3", f"samples_per_specimen: {samples}"))
    drawn = [drawn_specimen(sweep, specimen) for specimen in range(128)]
    kept = [specimen for specimen in drawn if not specimen[0].redraws]
    assert len(kept) > 100
    for place in sweep.specimen_places:
        of_specimen = np.argsort(np.argsort([specimen[0].values[place.path] for specimen in kept]))
        for inner in sweep.sample_places:
            for within in range(samples):
                of_sample = np.argsort(np.argsort([specimen[within].values[inner.path] for specimen in kept]))
                together = np.histogram2d(of_specimen, of_sample, bins=4)[0] / len(kept)
                assert abs(np.corrcoef(of_specimen, of_sample)[0, 1]) < 0.1
                assert abs(together - 1 / 16).max() < 0.03
    numbers = [[specimen[within].values[sweep.sample_places[0].path] for within in range(samples)] for specimen in kept]
    shares = np.argsort(np.argsort(np.ravel(numbers))).reshape(-1, samples) / np.size(numbers)
    assert (np.ptp(shares, axis=1) > 0.2).all()  # spread over the samples of each specimen


def test_a_latin_hypercube_fills_every_row_once(tmp_path: Path) -> None:
    points = np.array([design_point("latin_hypercube", (3, 0), k, count=50, dimensions=3) for k in range(50)])
    for column in points.T:
        assert sorted((column * 50).astype(int)) == list(range(50))
    text = TEXT.replace("seed: 7", "seed: 7\n  design: latin_hypercube")
    assert sweep_of(tmp_path, text).identity != sweep_of(tmp_path, text, samples=30).identity


def test_a_grid_has_every_combination_and_groups_specimens(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, GRID)
    assert (sweep.samples, sweep.per_specimen) == (12, 2)
    values = values_of(sweep, range(6))
    assert len({tuple(sorted((str(path), value) for path, value in one.items())) for one in values}) == 12
    first, second = drawn_specimen(sweep, 4)
    different = [path for path in first.values if first.values[path] != second.values[path]]
    assert different == [("experiment", "loading", "pieces", 0, "to")]


def test_samples_of_a_specimen_share_what_is_not_named(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path)
    block = decoded(computed(sweep.text, range(9)))
    assert block["specimen"].tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    for name, count in (("outer_radius", 3), ("split", None), ("varied_loading_pieces_0_to", 9)):
        groups = block[name].reshape(3, 3)
        assert count == 9 or (groups == groups[:, :1]).all(), name
    assert len(np.unique(block["varied_loading_pieces_0_to"])) == 9
    assert len(np.unique(block["case_id"])) == 9


def test_impossible_cases_are_drawn_again_and_counted(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, samples=300)
    drawn = [drawn_specimen(sweep, specimen)[0] for specimen in range(100)]
    assert sum(one.redraws > 0 for one in drawn) >= 3
    for one in drawn:
        experiment = one.case.experiment  # type: ignore[union-attr]
        assert experiment.inner_radius <= 0.99 * experiment.outer_radius  # type: ignore[attr-defined]
    never = dataclasses.replace(sweep, settings=sweep.settings.model_copy(update={"redraws": 0}))
    refused = [drawn_specimen(never, k)[0] for k in range(100) if drawn_specimen(sweep, k)[0].redraws]
    assert all(one.case is None and "no case was accepted in 1 draws" in one.refusal for one in refused)


def test_a_specimen_is_drawn_whole_though_the_sweep_ends_within_it(tmp_path: Path) -> None:
    text = TEXT.replace("[experiment.loading.pieces.0.to]", "[experiment.inner_radius]")
    for samples in range(31, 60, 3):  # the last specimen has one sample
        few, many = sweep_of(tmp_path, text, samples=samples), sweep_of(tmp_path, text, samples=300)
        last = samples // 3
        assert values_of(few, range(last, last + 1)) == values_of(many, range(last, last + 1))
        assert decoded(computed(few.text, [samples - 1]))["checksum"].shape == (1, 32)
    redrawn = [specimen for specimen in range(100) if drawn_specimen(many, specimen)[0].redraws]
    assert redrawn  # or nothing was tried
    for drawn in drawn_specimen(many, redrawn[0]):
        assert drawn.case is not None


def test_batches_do_not_matter(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path)
    whole, alone = decoded(computed(sweep.text, range(6))), decoded(computed(sweep.text, [4]))
    assert whole["checksum"][4].tolist() == alone["checksum"][0].tolist()
    assert whole["checksum"][3].tolist() != alone["checksum"][0].tolist()


def test_splits_follow_specimens_and_rules(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, samples=900)
    block = decoded(computed(sweep.text, range(0, 900, 3), lost="nothing needs to be run"))
    names = sweep.settings.splits.names
    softer = block["instantaneous_shear_modulus"] < 4000
    assert names[3] == "softer"
    assert ((block["split"] == 3) == softer).all()
    shares = np.bincount(block["split"][~softer], minlength=3)[:3] / (~softer).sum()
    assert shares == pytest.approx([0.5, 0.25, 0.25], abs=0.1)  # three standard deviations of some 230 specimens


def test_no_other_part_has_a_sample_that_satisfies_the_rule_of_one(tmp_path: Path) -> None:
    inner = TEXT.replace("[experiment.loading.pieces.0.to]", "[experiment.material.c10]")
    block = decoded(computed(sweep_of(tmp_path, inner, samples=300).text, range(300), lost="nothing needs to be run"))
    softer, apart = block["instantaneous_shear_modulus"].reshape(-1, 3) < 4000, block["split"].reshape(-1, 3) == 3
    assert (apart == softer.any(axis=1, keepdims=True)).all()
    assert (softer.any(axis=1) != softer[:, 0]).any()
    assert (softer.any(axis=1) != softer.all(axis=1)).any()
    few = decoded(computed(sweep_of(tmp_path, inner, samples=301).text, [300], lost="nothing needs to be run"))
    whole = decoded(computed(sweep_of(tmp_path, inner, samples=303).text, [302, 300], lost="nothing needs to be run"))
    assert few["split"][0] == whole["split"][0] == whole["split"][1]


def test_a_rule_about_a_label_of_several_numbers_is_refused(tmp_path: Path) -> None:
    """Whether it is for x, y or z it could not say: all three had to satisfy it."""
    text = (CASES / "sweep_lumps.yaml").read_text().replace("inclusion_depth: {above: 0.009}", "inclusion_center: {above: 0.02}")
    with pytest.raises(CaseError, match=r"deeper.inclusion_center: has several numbers, along axis; .*inclusion_depth"):
        layout_of(sweep_of(tmp_path, text))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("tactsim/sweep/1", "tactsim/sweep/2", "a sweep begins with 'schema: tactsim/sweep/1'$"),
        ("tactsim/sweep/1", "tactsim/case/1", "'schema: tactsim/sweep/1'; compute a case with: tactsim run$"),
        ("uniform: [1 mm, 2.5 mm]", "uniform: [1 mm, 2.5 kPa]", r"sweep.yaml:6: experiment.inner_radius: .*wrong dimension"),
        ("kind: neo_hookean", "kind: neo_hokean", "unknown kind|neo_hookean"),
        ("inner_radius:", "iner_radius:", "did you mean 'inner_radius'"),
        ("uniform: [2 mm, 4 mm]", "uniform: [0.2 mm, 0.4 mm]", "no case was accepted in 101 draws"),
        ("pieces.0.to]", "pieces.0.too]", "did you mean 'experiment.loading.pieces.0.to'"),
        ("samples: 24\n", "samples: 24\n  sample: 3\n", r"sweep.sample: unknown key.*did you mean 'samples'"),
        ("samples: 24\n", "samples: 0\n", "sweep.samples"),
        ("  samples: 24\n", "", "sweep.samples: missing"),
        ("samples_per_specimen: 3", "samples_per_specimen: 1", "nothing varies within a specimen"),
        ("white: 1 mV", "white: 1", "has no unit"),
        ("instantaneous_shear_modulus: {below", "shear_modulus: {below", "unknown label"),
        ("modulus: {below: ", "modulus: {above: 1e9, below: ", r"modulus: nothing is above 1e\+09 and below "),
        ("{below: 4000}", "{below: 4 kPa}", "below: '4 kPa' is not allowed; expected a number in SI without its unit"),
        ("{below: 4000}", "{}", "a condition needs above, below or equal"),
        ("{softer: {instantaneous_shear_modulus: {below: 4000}}}", "{softer: {}}", "softer: no condition"),
        ("instantaneous_shear_modulus: {below", "shear_modulus: {below", r"sweep.yaml:\d+: sweep.splits.out_of_distribution"),
        ("kind: closed_form", "kind: closd_form", r"sweep.yaml:4: experiment.kind: .*did you mean 'closed_form'"),
        ("train: 0.5", "train: 0.9", "add up to more than 1"),
        ("train: 0.5\n    validation: 0.25", "train: 1", r"train 1 and validation 0.1 \(if not given\) add up to more than 1"),
        ("seed: 7", "design: grid", "a grid takes lists"),
        (
            "A small sweep",
            "{choice: [a, b]}",
            r"sweep.yaml:2: title: {'choice': \['a', 'b'\]} is a distribution, .* within",
        ),
        ("  points: 5", "output: {fields: {choice: [all, none]}}", r"sweep.yaml:12: output.fields: .* may only stand within"),
        ("kind: closed_form", "kind: {choice: [closed_form, grasp]}", "sweep.yaml:4: experiment.kind: .* whose kind is fixed"),
    ],
)
def test_what_cannot_be_swept_is_refused_with_its_place(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in TEXT
    with pytest.raises(CaseError, match=words):
        layout_of(sweep_of(tmp_path, TEXT.replace(old, new)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "{uniform: [1 mm, 2.5 mm]}",
            "{uniform: [0.001, 0.002]}",
            r"6: experiment.inner_radius: .*, 0.002\]} .* has no unit",
        ),
        (
            "{uniform: [1 mm, 2.5 mm]}",
            "{uniform: [1 kPa, 2 kPa]}",
            "6: experiment.inner_radius: .*'1 kPa' has the wrong dim",
        ),
        ("{uniform: [1 mm, 2.5 mm]}", "{choice: [1 mm, 2 mm, large]}", "6: experiment.inner_radius: .*'large' is not a quantity"),
        (
            "{uniform: [1 mm, 2.5 mm]}",
            "{choice: [1 mm, {uniform: [3, 4]}]}",
            "inner_radius.choice.1: .*3.0 has no unit",
        ),
        ("points: 5", "points: {uniform: [5, 9]}", r"12: experiment.points: .* whole number; these are drawn by {integer: \["),
        ("points: 5", "points: {values: [5, 6, 7.5, 8]}", "12: experiment.points: .* 7.5 is not allowed"),
        ("fractions: [0.5]", "fractions: [{uniform: [1 mm, 2 mm]}]", "fractions.0: .*'1 mm' is not allowed; expected a number"),
        ("points: 5", "formula: {choice: [exact, exat]}", r"formula: .*\(did you mean .exact.\?\)"),
    ],
)
def test_a_distribution_that_does_not_suit_its_place_is_refused_before_anything_is_drawn(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert old in TEXT
    with pytest.raises(CaseError, match=words) as caught:
        layout_of(sweep_of(tmp_path, TEXT.replace(old, new)))
    assert "no case was accepted" not in str(caught.value)
    assert "does not suit this place" in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("{uniform: [1 mm, 2.5 mm]}", "{uniform: [-3 mm, -1 mm]}", "6: experiment.inner_radius: .* at least 0 m, which none"),
        ("{uniform: [1 mm, 2.5 mm]}", "{values: [-1 mm, -3 mm, -2 mm]}", "inner_radius: .* at least 0 m, which none"),
        ("{uniform: [1 mm, 2.5 mm]}", "{choice: [1 mm, {uniform: [-3 mm, -1 mm]}]}", "inner_radius.choice.1: .* which none"),
        ("points: 5", "points: {integer: [-5, 1]}", "12: experiment.points: .* which none"),
    ],
)
def test_a_distribution_wholly_out_of_bounds_is_refused_before_anything_is_drawn(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert old in TEXT
    with pytest.raises(CaseError, match=words):
        check_suitable(sweep_of(tmp_path, TEXT.replace(old, new)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("points: 5", "points: {values: [5, 6]}\n  thicknes: 20 mm", "13: experiment.thicknes: unknown key"),
        ("outer_radius: ", "outer_radius: {choice: [{unifrm: [3 mm, 4 mm]}, 4 mm]} #", "choice.0: .*did you mean 'uniform'"),
        ("{uniform: [1 mm, 2.5 mm]}", "{unifrm: [1 mm, 2.5 mm]}", "6: experiment.inner_radius: .*did you mean 'uniform'"),
        ("{uniform: [1 mm, 2.5 mm]}", "{gauss: [1 mm, 2.5 mm]}", "'1 mm', or a distribution: uniform, log_uniform, normal,"),
        ("kind: ramp, to", "kind: {choice: [ramp, ramp]}, too: 1 mm, to", "pieces.0.too: unknown key"),
        ("material: ", "material: {choice: [{kind: neo_hookean, c10: 5}, icf_stable]} #", "material.choice.0.c10: 5 has no unit"),
    ],
)
def test_what_is_refused_whatever_is_drawn_is_refused_before_anything_is_drawn(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    """A misspelt distribution in an option was drawn again until another option came: all samples had that one."""
    assert old in TEXT
    with pytest.raises(CaseError, match=words) as caught:
        check_suitable(sweep_of(tmp_path, TEXT.replace(old, new)))
    assert "101 draws" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"samples: 24": "samples: 0", "[1 mm, 2.5 mm]": "[2.5 mm, 1 mm]", "uniform: [2 mm, 4 mm]": "uniform: 3 mm"},
            [r":6: experiment\.inner_radius: ", r":7: experiment\.outer_radius: ", r":14: sweep\.samples: "],
        ),
        (
            {"[1 mm, 2.5 mm]": "[1 kPa, 2 kPa]", "[2 mm, 4 mm]": "[-3 mm, -1 mm]", "points: 5": "pionts: 5"},
            [r":6: experiment\.inner_radius: .*wrong", r":7: experiment\.outer_radius: .*none of", r":12: experiment\.pionts: "],
        ),
    ],
    ids=["written wrongly", "not suited"],
)
def test_all_mistakes_of_a_sweep_are_named_at_once(tmp_path: Path, changes: dict[str, str], words: list[str]) -> None:
    text = TEXT
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    with pytest.raises(CaseError) as caught:
        check_suitable(sweep_of(tmp_path, text))
    lines = str(caught.value).splitlines()
    assert len(lines) == len(words)
    for line, expected in zip(lines, words, strict=True):
        assert re.search(expected, line)


def test_workers_do_not_hold_the_distributions_against_their_places_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checked: list[Sweep] = []
    monkeypatch.setattr("tactsim.dataset.sampling.layout.check_suitable", checked.append)
    sweep = sweep_of(tmp_path, TEXT.replace("A small sweep", "Of workers"))
    first_case(sweep)
    computed(sweep.text, [0])
    assert checked == [sweep]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("{uniform: [1 mm, 2.5 mm]}", "{uniform: [-1 mm, 2.5 mm]}"),
        ("{uniform: [1 mm, 2.5 mm]}", "{values: [-1 mm, 2 mm, -2 mm]}"),
        ("{uniform: [1 mm, 2.5 mm]}", "{normal: [2 mm, 1 mm]}"),
        ("kind: ramp, to", "kind: {choice: [ramp, hold]}, to"),
        ("points: 5", "points: {integer: [1, 9]}"),
        ("points: 5", "thickness: {choice: [null, 20 mm]}"),
    ],
)
def test_what_is_possible_in_part_is_drawn_again(tmp_path: Path, old: str, new: str) -> None:
    assert old in TEXT
    assert layout_of(sweep_of(tmp_path, TEXT.replace(old, new))).variables


def test_a_kind_without_recorder_needs_names(tmp_path: Path) -> None:
    text = TEXT.replace("title: A small sweep", "title: x").replace("kind: closed_form", "kind: film_creep")
    with pytest.raises(CaseError, match=r"sweep.yaml:\d+: sweep\.quantities: missing; .*those that tactsim run reports of one"):
        layout_of(sweep_of(tmp_path, text))


def test_options_of_inclusions_among_options_have_places_in_the_store() -> None:
    """Samples with more inclusions than the outermost options list failed, as if the store had no place for them."""
    nested = {"choice": [[], {"choice": [["one"], ["one", "another"]]}]}
    assert most_inclusions({"experiment": {"inclusions": nested}}) == 2
    assert most_inclusions({"experiment": {"inclusions": ["one"]}}) == 1
    assert most_inclusions({"experiment": {}}) == 0


def test_a_file_without_places_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="nothing varies"):
        sweep_of(tmp_path, "schema: tactsim/sweep/1\nexperiment: {kind: closed_form}\nsweep: {samples: 3}\n")


def test_what_a_kind_does_not_use_is_refused() -> None:
    for part, words in (
        ("times: 3", r"^--set sweep\.times: 3, but .* only the end"),
        ("reading: {}", r"sweep\.reading: .* closed_form"),
    ):
        name, value = part.split(": ")
        with pytest.raises(CaseError, match=words):
            layout_of(load_sweep(CASES / "sweep_rates.yaml", (f"sweep.{name}={value}",), option="--set"))


def test_a_grid_may_begin_with_impossible_cases(tmp_path: Path) -> None:
    text = TEXT
    for old, new in (
        ("{uniform: [1 mm, 2.5 mm]}", "{values: [3.5 mm, 1 mm]}"),
        ("{uniform: [2 mm, 4 mm]}", "{values: [2 mm, 2.5 mm, 3 mm, 3.9 mm]}"),
        ("{log_uniform: [1 kPa, 20 kPa]}", "2 kPa"),
        ("{uniform: [0.1 mm, 0.2 mm]}", "0.1 mm"),
        ("  samples_per_specimen: 3\n", ""),
        ("  within_specimen: [experiment.loading.pieces.0.to]\n", ""),
        ("samples: 24", "design: grid"),
    ):
        text = text.replace(old, new)
    sweep = sweep_of(tmp_path, text)
    assert layout_of(sweep).variables
    assert sum(drawn_specimen(sweep, k)[0].case is not None for k in range(8)) == 5


def test_more_samples_than_a_data_set_may_have_are_refused_before_it_is_made(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"sweep\.samples: 10000001 asked for; allowed: up to 10000000"):
        sweep_of(tmp_path, samples=10_000_001)
    assert sweep_of(tmp_path, samples=10_000_000).samples == 10_000_000


def test_shares_of_tenths_are_exact_in_every_ten_specimens() -> None:
    sweep = load_sweep("sweep_closed_form", ("sweep.splits={train: 0.7, validation: 0.2}",), 200)
    dealt = np.array([split_of(sweep, specimen, [], {}) for specimen in range(200)]).reshape(-1, 10)
    for part, wanted in enumerate((7, 2, 1)):
        np.testing.assert_array_equal((dealt == part).sum(axis=1), wanted)
    assert len({tuple(ten) for ten in dealt}) > 15, "in an order of its own each time"


def test_other_shares_hold_on_the_whole() -> None:
    sweep = load_sweep("sweep_closed_form", ("sweep.splits={train: 0.64, validation: 0.13}",), 200)
    dealt = np.array([split_of(sweep, specimen, [], {}) for specimen in range(2000)])
    np.testing.assert_allclose([(dealt == part).mean() for part in range(3)], [0.64, 0.13, 0.23], atol=0.02)


def test_a_refused_override_is_called_as_it_was_given(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From Python it was called ``--set``."""
    assert main(["sweep", "sweep_closed_form", "--set", "nothing", "--out", str(tmp_path / "s.zarr")]) == 2
    assert capsys.readouterr().err.startswith("error: --set nothing: ")
    with pytest.raises(CaseError, match=r"^override nothing: "):
        load_sweep(CASES / "sweep_closed_form.yaml", ("nothing",))
