"""Using a data set: loading, splits, checks, exports, the card, the command line."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow.parquet
import pytest
from fork_server import forked_python
from sweeps import TEXT, compute_once_here, sweep_file

from tactsim.cli import main
from tactsim.dataset import TorchSamples, checking, load, sample_case
from tactsim.dataset.checking import check
from tactsim.dataset.cost import COST
from tactsim.dataset.running.run import Tally
from tactsim.dataset.sampling.layout import Layout, layout_of
from tactsim.dataset.sampling.stored import stored_layout
from tactsim.dataset.sampling.sweep import sweep_of_text
from tactsim.dataset.store.arrays import DONE, FAILED, index_variables
from tactsim.dataset.store.blocks import checksum
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.verifying import ChunkRead
from tactsim.dataset.text_counts import CountedText, TextCounts
from tactsim.dataset.use.card import description
from tactsim.dataset.use.counts import failures
from tactsim.errors import InputError, StorageError, UnknownName
from tactsim.interfaces.variable import Variable, reading
from tactsim.storage.building import MARK
from tactsim.storage.own_files import OwnFiles


def test_variables_stand_in_the_order_in_which_they_were_declared(kept: Path) -> None:
    """A folder lists them in another order on every disk, so that card and export of equal data sets differed."""
    declared = Store.open(kept).attributes["arrays"]
    assert list(load(kept).data_vars) == declared


def test_splits_are_apart_and_together_all(kept: Path) -> None:
    parts = {name: load(kept, split=name) for name in ("train", "validation", "test", "softer")}
    specimens = [set(part["specimen"].values.tolist()) for part in parts.values()]
    assert sum(map(len, specimens)) == len(set.union(*specimens)) == 8
    assert sum(part.sizes["sample"] for part in parts.values()) == load(kept).sizes["sample"] == 24
    assert load(kept, split=["train", "test"]).sizes["sample"] == parts["train"].sizes["sample"] + parts["test"].sizes["sample"]
    assert list(load(kept, variables=["force"]).data_vars) == ["force"]
    assert load(kept)["sample"].values.tolist() == list(range(24))


def test_the_case_of_a_sample_repeats_it_to_the_last_bit(kept: Path) -> None:
    data = load(kept)
    for number in (0, 7, 23):
        case = sample_case(kept, number)
        one = data.sel(sample=number)
        assert case.case_id == str(one["case_id"].values)
        force = case.run(None).history_values("force")
        assert force[-1] == one["force"].values[-1]
    for number in (-1, 24):
        with pytest.raises(InputError, match=f"sample {number}: the data set has samples 0 to 23"):
            sample_case(kept, number)


def test_unknown_names_are_refused(kept: Path, tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="did you mean 'train'"):
        load(kept, split="trian")
    with pytest.raises(UnknownName, match="did you mean 'force'"):
        load(kept, variables=["forze"])
    with pytest.raises(InputError, match="empty list"):
        load(kept, split=[])
    with pytest.raises(StorageError, match=r"holds no zarr\.json"):
        load(tmp_path)


def test_one_name_stands_for_a_list_of_it_and_no_name_is_refused(kept: Path) -> None:
    assert list(load(kept, variables="force").data_vars) == ["force"]
    assert TorchSamples(kept, inputs="read_force", targets="inner_radius").inputs == ("read_force",)
    for given in ({"variables": 3}, {"split": 3}):
        with pytest.raises(InputError, match=rf"{next(iter(given))}: 3; needed: a name, or a list of names"):
            load(kept, **given)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"inputs: 3; needed: a name"):
        TorchSamples(kept, inputs=3)  # type: ignore[arg-type]


def test_a_whole_store_has_no_findings(kept: Path) -> None:
    checked = check(kept)
    assert checked.findings == ()
    assert checked.counts == {"pending": 0, "done": 24, "failed": 0}


def summed_again(store: Store, number: int) -> None:
    """Makes the checksum fit what is there."""
    variables = layout_of(sweep_of_text(store.attributes["sweep"])).variables
    sample = {variable.name: store.read(variable.name)[number] for variable in variables}
    store.group["checksum"][number] = checksum(sample, variables)


def changed(store: Store, name: str, number: int, value: object) -> None:
    """Changes a sample as a faulty program might, checksum and all."""
    store.group[name][number] = value
    summed_again(store, number)


def copied(store: Store, source: int = 2) -> None:
    """Sample 4 with the content of another."""
    for name in ("force", "displacement", "read_force", "read_force_clean", "voltage", "voltage_clean", "time_s"):
        store.group[name][4] = store.group[name][source]
    for name in ("largest_force", "largest_displacement", "tissue_rise_axis", "force_factor", "rise_factor"):
        store.group[name][4] = store.group[name][source]
    summed_again(store, 4)


FAULTS: dict[str, Callable[[Store], None]] = {
    "checksum": lambda store: store.group["force"].__setitem__(3, 0.5 + store.group["force"][3]),
    "not finite": lambda store: changed(store, "force", 3, np.nan),
    "constant": lambda store: changed(store, "force", 3, 0.25),
    "duplicate": copied,
    "missing": lambda store: store.group["status"].__setitem__(3, 0),
    "leakage": lambda store: changed(store, "split", 3, (store.read("split")[3] + 1) % 3),
    "damaged": lambda store: store.group["status"].__setitem__(3, 77),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_planted_faults_are_found(store: Path, kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    FAULTS[kind](Store.open(store, writing=True))
    findings = check(store).findings
    assert kind in [finding.kind for finding in findings]
    if kind not in ("leakage", "damaged"):  # which show in more than one way
        assert len(findings) == 1
    assert main(["data", "check", str(store)]) == 4
    assert kind in capsys.readouterr().out


@pytest.mark.parametrize(
    ("variable", "suspected"),
    [
        (reading("outside_force", "N", "beside the matrix", jaw=2), False),
        (reading("taxel_force", "N", "on each taxel", time=1, jaw=2, row=2, column=1), False),
        (reading("taxel_force", "N", "on each taxel", time=1, jaw=2, row=3, column=3), True),
        (reading("taxel_force", "N", "on each taxel", time=4, jaw=2, row=2, column=2), True),
        (reading("force", "N", "on the annulus", time=4), True),
        (reading("force", "N", "on the annulus", time=1), False),
        (reading("displacement", "m", "of the annulus", time=4, prescribed=True), False),
    ],
)
def test_equal_entries_are_suspected_unless_they_may_mirror_each_other(
    kept: Path, monkeypatch: pytest.MonkeyPatch, variable: Variable, suspected: bool
) -> None:
    """A grasp without a lump presses equally on both jaws, so that a data set of it had findings."""
    store = Store.open(kept)
    values = {"status": np.array([DONE]), "code": np.array([0]), variable.name: np.full((1, *variable.sizes), 0.25)}
    whole = (variable, *(one for one in index_variables(()) if one.name in values))
    monkeypatch.setattr(checking, "computed_chunks", lambda *_: [ChunkRead(0, np.array([0]), values)])
    findings = checking.value_findings(store, Layout(stored_layout(store)[1].recorder, whole), np.array([DONE]))
    assert [finding.kind for finding in findings] == (["constant"] if suspected else [])


def test_the_same_case_twice_is_found(store: Path) -> None:
    opened = Store.open(store, writing=True)
    changed(opened, "case_id", 3, opened.read("case_id")[4])
    (finding,) = check(store).findings
    assert (finding.kind, finding.samples) == ("duplicate", (3, 4))
    copied(opened, source=3)
    assert check(store).findings == (finding,), "one case has one answer: its readings are no second finding"


def test_a_byte_changed_on_the_disk_is_found(store: Path) -> None:
    chunk = next(path for path in (store / "force" / "c").rglob("*") if path.is_file())
    content = bytearray(chunk.read_bytes())
    content[len(content) // 2] ^= 1
    chunk.write_bytes(content)
    try:
        kinds = [finding.kind for finding in check(store).findings]
    except StorageError as error:  # the compression may notice first
        kinds = ["checksum"] if "force" in str(error) else []
    assert kinds == ["checksum"]


def test_a_lost_array_is_found(store: Path) -> None:
    (store / "force" / "zarr.json").unlink()
    (finding,) = check(store).findings
    assert str(finding).startswith("missing: the variable force; go on with --resume")


def test_hdf5_holds_the_same(kept: Path, tmp_path: Path) -> None:
    assert main(["data", "export", str(kept), "--to", str(tmp_path / "small.h5"), "--split", "train"]) == 0
    data = load(kept, split="train")
    with h5py.File(tmp_path / "small.h5") as file:
        for name, values in data.data_vars.items():
            if values.dtype.kind in "fiub":
                np.testing.assert_array_equal(file[str(name)][...], values.values)
        assert file["force"].attrs["units"] == "N"
        assert file["force"].attrs["dimensions"] == "sample,time"
        assert file["reason"][0] == b"end of the history"
        assert file["card"][()] == b"", "nothing wrote one"
        assert file["failed/sample"].shape == (0,)


@pytest.mark.usefixtures("hdf5_here")
def test_an_export_reports_what_failed(store: Path, tmp_path: Path) -> None:
    (store / "README.md").write_text("# A small sweep — its card\n", encoding="utf-8")
    group = Store.open(store, writing=True).group
    group["status"][3], group["reason"][3] = FAILED, "ConvergenceError: it — would not"
    for name in ("e.h5", "e"):
        assert main(["data", "export", str(store), "--to", str(tmp_path / name)]) == 0
    with h5py.File(tmp_path / "e.h5") as file:
        assert file["failed/sample"][...].tolist() == [3]
        assert file["failed/reason"][0].decode() == "ConvergenceError: it — would not"
        assert 3 not in file["sample"][...]
        assert (
            file["card"][()].decode().startswith("# A small sweep — its card\n\n## This export\n23 samples that are done, of all")
        )
    described = json.loads((tmp_path / "e" / "dataset.json").read_text(encoding="utf-8"))
    assert described["attributes"]["failed"] == [{"sample": 3, "reason": "ConvergenceError: it — would not"}]
    assert (tmp_path / "e" / "README.md").read_text(encoding="utf-8").startswith("# A small sweep — its card\n\n## This export\n")


@pytest.mark.usefixtures("hdf5_here")
@pytest.mark.parametrize("name", ["EXPORT.h5", "shards"])
def test_the_card_of_an_export_is_about_what_was_exported(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """It told to open a Zarr store, and showed pictures that were not there."""
    OwnFiles(store).replace("figures/spread.png", b"spread")
    text = "# Sweep\n\n## Figures\n![spread](figures/spread.png)\n"
    (store / "README.md").write_text(text, encoding="utf-8")
    assert main(["data", "export", str(store), "--to", str(tmp_path / name), "--split", "train"]) == 0
    monkeypatch.chdir(tmp_path if name.endswith(".h5") else tmp_path / name)
    if name.endswith(".h5"):
        with h5py.File(name) as file:
            written = file["card"][()].decode()
    else:
        written = Path("README.md").read_text(encoding="utf-8")
        assert Path("figures/spread.png").read_bytes() == b"spread"
    data, found = load(store, split="train"), dict[str, np.ndarray]()
    head, code, rest = written.split("```")
    assert head == f"# Sweep\n\n## This export\n{data.sizes['sample']} samples that are done, of the split train. " + (
        "What follows is about the whole data set; read the export so:\n"
    )
    assert rest == text.removeprefix("# Sweep")
    exec(code.removeprefix("python\n"), {}, found)  # noqa: S102  the card is ours
    np.testing.assert_array_equal(found["values"], data["force"].values)


def test_shards_hold_the_same_with_an_index(kept: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tactsim.dataset.use.export.SHARD_SAMPLES", 10)
    assert main(["data", "export", str(kept), "--to", str(tmp_path / "shards")]) == 0
    index = pyarrow.parquet.read_table(tmp_path / "shards" / "index.parquet").to_pydict()
    data = load(kept)
    assert index["sample"] == list(range(24))
    np.testing.assert_array_equal(index["inner_radius [m]"], data["inner_radius"])
    assert set(index["split"]) <= {"train", "validation", "test", "softer"}
    with np.load(tmp_path / "shards" / f"shard_{index['shard'][13]:05d}.npz", allow_pickle=False) as shard:
        np.testing.assert_array_equal(shard["force"][index["row"][13]], data["force"].values[13])
    described = json.loads((tmp_path / "shards" / "dataset.json").read_text(encoding="utf-8"))
    assert described["variables"]["force"]["units"] == "N"


def test_a_data_set_is_shown(kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(kept), "--save", str(tmp_path / "spread.png")]) == 0
    assert "A small sweep" in capsys.readouterr().out
    assert (tmp_path / "spread.png").read_bytes().startswith(b"\x89PNG")


def test_an_export_replaces_nothing(kept: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "there.h5").write_text("mine")
    assert main(["data", "export", str(kept), "--to", str(tmp_path / "there.h5")]) == 5
    assert main(["data", "export", str(kept)]) == 2
    assert main(["data", "export", str(kept), "--to", str(tmp_path / "x.h5"), "--split", "nothing"]) == 2
    assert "known: softer, test, train, validation" in capsys.readouterr().err
    assert not (tmp_path / "x.h5").exists()


def test_torch_samples_need_torch_only_for_a_sample(kept: Path) -> None:
    samples = TorchSamples(kept, inputs=["read_force"], targets=["inner_radius"], split="train")
    assert len(samples) == load(kept, split="train").sizes["sample"]
    with pytest.raises(InputError, match="reason holds text"):
        TorchSamples(kept, inputs=["reason"])
    assert samples._arrays()["read_force"].shape == (24, 4)
    assert samples.__getstate__()["_opened"] is None


@pytest.mark.filterwarnings("ignore:This DataLoader will create 8 worker processes:UserWarning")  # on fewer than eight cores
def test_torch_loaders_with_eight_workers(kept: Path) -> None:
    torch = pytest.importorskip("torch")
    samples = TorchSamples(kept, inputs=["read_force"], targets=["inner_radius"])
    loader = torch.utils.data.DataLoader(samples, batch_size=5, num_workers=8)
    batches = [inputs["read_force"] for inputs, _ in loader]
    np.testing.assert_allclose(torch.cat(batches).numpy(), load(kept)["read_force"], rtol=1e-6)


def test_reading_needs_no_torch_and_no_dask() -> None:
    program = "import sys, tactsim.dataset; print(sorted({'torch', 'dask', 'zarr', 'xarray', 'h5py'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.strip() == "[]"


def test_a_sweep_by_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    compute_once_here(monkeypatch)
    text = TEXT.replace("times: 4", "times: 4\n  license: CC0-1.0")
    case, place = str(sweep_file(tmp_path, text)), str(tmp_path / "s.zarr")
    assert main(["sweep", case, "--out", place, "--samples", "6", "--workers", "1", "--progress"]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("6 samples done, 0 failed in ")
    assert "samples, 0 failed, " in err
    assert main(["sweep", case, "--out", place, "--samples", "6"]) == 5
    assert main(["data", "info", place]) == 0
    printed = capsys.readouterr().out
    assert "A small sweep" in printed
    assert "voltage after the low pass, with noise" in printed
    assert Path(place, "figures", "spread.png").read_bytes().startswith(b"\x89PNG")
    card = Path(place, "README.md").read_text(encoding="utf-8")
    for part in (
        "license: cc0-1.0",
        "Design sobol, seed 7, 6 samples",
        "| done | 6 |",
        "| softer | ",
        "Known limits",
        "c10",
        "![spread]",
    ):
        assert part in card, part


@pytest.mark.parametrize(
    ("options", "words"),
    [(["--workers", "0"], "--workers 0 is out of range"), (["--samples", "-3"], "--samples -3 is out of range")],
)
def test_bad_options_are_refused(tmp_path: Path, options: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(sweep_file(tmp_path)), "--out", str(tmp_path / "s.zarr"), *options]) == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "s.zarr").exists()


def test_progress_reports_rate_time_left_and_reasons() -> None:
    tally = Tally(samples=100, before=10, begin=time.monotonic() - 10)
    assert tally.line() == "10 of 100 samples, 0 failed; computing the first for 10 s"
    warned = dict.fromkeys([40, 12], "the tissue buckles\nthe mesh is coarse") | dict.fromkeys(range(50, 66), "")
    tally.add(warned, {70: "stopped at 3.5e-2 mm", 3: "stopped at 7 mm"})
    assert tally.line() == "30 of 100 samples, 2 failed, 2 samples/s, 35 s left"
    one = Tally(samples=2, before=1, begin=time.monotonic() - 10)
    one.add({1: ""}, {})
    assert one.summary()[:2] == ["1 sample done, 0 failed in 10 s (360 samples/h)", "1 sample was there before"]
    lines = tally.summary()
    assert lines[0] == "18 samples done, 2 failed in 10 s (2 samples/s)"
    assert lines[2] == "  2 of 20 samples (3, 70): failed: stopped at 0.035 to 7 mm"
    warnings = {"the tissue buckles", "the mesh is coarse"}
    assert {*lines[3:]} == {f"  2 of 18 samples (12, 40): warning: {words}" for words in warnings}


def count_of(counts: TextCounts, texts: list[str]) -> None:
    """Counts texts, each of a sample of its own."""
    for sample, text in enumerate(texts):
        counts.add(sample, [text])


def texts_of(counts: TextCounts) -> list[tuple[str, int]]:
    """The texts with their counts."""
    return [(one.text, one.count) for one in counts.most_common()]


def test_reasons_that_differ_in_their_numbers_count_as_one_and_keep_them() -> None:
    counts = TextCounts()
    depths = ((1, "1.4"), (12, "0.9"), (3, "1.23456789"))
    touches = [f"touch {touch} was not reached within {depth} mm" for touch, depth in depths]
    count_of(counts, ["took longer than the 8 s that it was given"] * 3 + touches + ["stopped: #1", "no numbers"])
    assert texts_of(counts) == [
        ("took longer than the 8 s that it was given", 3),
        ("touch 1 to 12 was not reached within 0.9 to 1.4 mm", 3),
        ("stopped: #1", 1),
        ("no numbers", 1),
    ]
    assert counts.most_common(1) == counts.most_common()[:1]
    count_of(long := TextCounts(), [f"{number} " + 200 * "x" + f" {number}" for number in (1, 2)])
    assert texts_of(long) == [("1 to 2 " + 158 * "x", 2)]
    count_of(cut := TextCounts(), [159 * "x" + "1", 160 * "x" + "2", 160 * "x" + "3"])
    assert texts_of(cut) == [(160 * "x", 2), (159 * "x" + "1", 1)]
    count_of(ranges := TextCounts(), ["0.2% (ratios of 0.85 to 1.12)", "0.3% (ratios of 0.86 to 1.11)"])
    assert texts_of(ranges) == [("0.2 to 0.3% (ratios of 0.85 to 1.12)", 2)], "not 0.85 to 0.86 to 1.11 to 1.12"


def test_a_text_names_the_first_samples_that_have_it_in_whatever_order_they_come() -> None:
    counts = TextCounts()
    for sample in (90, 40, 3, 71, 12, 88, 5):
        counts.add(sample, ["a film creeps by 2 %", "a film creeps by 3 %"])
    (one,) = counts.most_common()
    assert one.of(100) == "7 of 100 samples (3, 5, 12, 40, 71, ...)"
    assert one.of(7) == "all 7 samples"
    assert CountedText("", 2, (4, 9)).of(3) == "2 of 3 samples (4, 9)"
    assert CountedText("", 1, (4,)).of(1) == "1 of 1 samples (4)"
    assert CountedText("other warnings", 12).of(3) == "12 times", "a sample may have several of them"


def test_the_description_and_the_card_say_the_numbers_of_failures(store: Path) -> None:
    opened = Store.open(store, writing=True)
    for number in (3, 4, 5):
        opened.group["status"][number] = FAILED
        opened.group["reason"][number] = "took longer than the 8 s that it was given"
    assert failures(Store.open(store)) == [CountedText("took longer than the 8 s that it was given", 3, (3, 4, 5))]
    assert "  3 of 24 samples (3, 4, 5): failed: took longer than the 8 s that it was given" in description(store)


def timed(samples: list[int], seconds: list[float]) -> dict[str, np.ndarray]:
    """What a tally reads of a block of samples that took so long and solved nothing."""
    return {"sample": np.array(samples), "wall_time": np.array(seconds)} | {name: np.zeros(len(samples), int) for name in COST}


def test_the_slowest_samples_are_named_at_the_end() -> None:
    tally = Tally(samples=6)
    steps = np.ones(3, int)
    mesh = {"unknowns": np.array([9000, 40000, 9500]), "newton_iterations": np.array([8, 31, 9])}
    tally.timed(timed([3, 4, 5], [4.0, 63.0, 5.0]) | {"steps": steps, "rejected_steps": steps - 1} | mesh)
    tally.timed(timed([0, 1], [6.0, 31.0]) | {"rejected_steps": np.array([0, 2])})
    assert tally.summary()[1:] == [
        "a sample took 6 s, 9000 unknowns, 1 step, 8 Newton iterations in the median; the slowest:",
        "  63 s, sample 4, 40000 unknowns, 1 step, 31 Newton iterations",
        "  31 s, sample 1, 2 rejected steps",
        "  6 s, sample 0",
    ]
    quick = Tally(samples=2)
    quick.timed(timed([0, 1], [0.1, 0.2]))
    assert len(quick.summary()) == 1, "of quick ones it says nothing"


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_a_sweep_in_good_order(tmp_path: Path, number: signal.Signals) -> None:
    case, place = sweep_file(tmp_path), tmp_path / "s.zarr"
    command = [
        sys.executable,
        "-m",
        "tactsim.cli",
        "sweep",
        str(case),
        "--out",
        str(place),
        "--samples",
        "20000",
        "--workers",
        "2",
    ]
    process = subprocess.Popen([*command, "--progress"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    while not (line := process.stderr.readline()).strip().endswith("left"):
        assert line, "it ended early"
    second = subprocess.run([*command, "--resume"], capture_output=True, text=True, timeout=60)
    assert second.returncode == 5
    assert "in use by another sweep" in second.stderr
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in err
    (going_on,) = (line.partition(": ")[2] for line in out.splitlines() if "samples are left; go on with: " in line)
    assert shlex.split(going_on) == ["tactsim", "sweep", str(case), "--samples", "20000", "--out", str(place), "--resume"]
    assert [finding.kind for finding in check(place).findings] == ["missing"]
    computed = int((Store.open(place).read("status") == 1).sum())
    assert 0 < computed < 20000
    assert f"| done | {computed} |" in (place / "README.md").read_text(encoding="utf-8")


@pytest.mark.usefixtures("hdf5_here")
def test_an_export_goes_on_after_one_that_was_broken_off(kept: Path, tmp_path: Path) -> None:
    for name in ("flat", "whole.h5"):
        waiting = tmp_path / f".{name}.partial"
        waiting.mkdir()
        (waiting / MARK).write_text("")
        (waiting / "content").write_text("half")
        assert main(["data", "export", str(kept), "--to", str(tmp_path / name)]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["flat", "whole.h5"]


@pytest.mark.parametrize("name", ["flat", pytest.param("whole.h5", marks=pytest.mark.slow)])
def test_an_export_to_a_full_disk_is_an_error_and_leaves_nothing(kept: Path, tmp_path: Path, name: str) -> None:
    program = (
        "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)); "
        f"from tactsim.cli import main; print(main({['data', 'export', str(kept), '--to', str(tmp_path / name)]}))"
    )
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}  # a compiled module cut off at that size would break later runs
    done = subprocess.run([*forked_python(), program], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout == "5\n"
    assert "cannot write" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_scheduler_that_is_not_there_leaves_no_store(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(sweep_file(tmp_path)), "--out", str(tmp_path / "s.zarr"), "--scheduler", "nowhere"]) == 2
    assert "--scheduler 'nowhere' is no address" in capsys.readouterr().err
    assert not (tmp_path / "s.zarr").exists()


def test_readings_without_noise_are_stored_beside_those_with(kept: Path) -> None:
    data = load(kept)
    noise = (data["voltage"] - data["voltage_clean"]).values
    assert 0.5e-3 * 0.3 < noise.std() < 2e-3  # 1 mV before the low pass
    assert abs(noise.mean()) < 4 * noise.std() / np.sqrt(noise.size)
    assert "without noise" in data["read_force_clean"].attrs["long_name"]
