"""The store: kills, resumption, locks, changes, full disks, lost workers, and what xarray sees."""

from __future__ import annotations

import errno
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
import zarr
from fork_server import forked_python
from sweeps import TEXT, Inline, assert_same, compute_once, content, load_once, run_sweep, small_store, sweep_file
from zarr.storage import LocalStore

from tactsim import code_identity
from tactsim.dataset.checking import check
from tactsim.dataset.running import resuming
from tactsim.dataset.running import run as running
from tactsim.dataset.running.executors import Executor, LocalWorkers
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.sampling.drawing import drawn_specimen, noise_seed, used_seed
from tactsim.dataset.sampling.sweep import Sweep, load_sweep
from tactsim.dataset.store import writing
from tactsim.dataset.store.blocks import JOURNAL, Journal
from tactsim.dataset.store.opening import Store
from tactsim.dataset.store.writing import chunk_samples, set_attributes
from tactsim.dataset.use.card import description
from tactsim.dataset.use.counts import redrawn, split_counts
from tactsim.dataset.use.loading import load
from tactsim.errors import CaseError, InputError, OutOfMemory, StorageError, TactsimError
from tactsim.interfaces.seeds import seeds_in
from tactsim.interfaces.variable import Variable
from tactsim.results.folder import claimed
from tactsim.shipped import CASES

TESTS = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """How often it is told to is seen by the tally."""
    compute_once(monkeypatch)


@pytest.fixture
def whole(kept: Path) -> Path:
    """A store that nothing disturbed."""
    return kept


def test_an_interruption_waits_until_a_store_is_made_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """zarr's thread went on writing into what was removed, which then stood in the way as not of tactsim."""
    variables = [Variable(name, "1", name, "reading") for name in ("one", "two", "three")]
    added = []

    def interrupted(*of_one: Any) -> None:
        if not added:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.1)
        add(*of_one)
        added.append(of_one[1].name)

    add = writing._add
    monkeypatch.setattr(writing, "_add", interrupted)
    with pytest.raises(KeyboardInterrupt):
        writing.create(tmp_path / "s.zarr", variables, 4, {})
    assert added == ["one", "two", "three"]
    assert os.listdir(tmp_path) == []


def test_xarray_opens_it_without_our_code(whole: Path) -> None:
    program = (
        "import sys, xarray; data = xarray.open_zarr(sys.argv[1]); assert 'tactsim' not in sys.modules; "
        "print(dict(data.sizes), data.force.attrs['units'], data.force.dims, float(data.force.max()), data.reason.values[0])"
    )
    command = [sys.executable, "-W", "error", "-c", program, str(whole)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout
    assert "'sample': 24" in printed
    assert "'time': 4" in printed
    assert "N ('sample', 'time')" in printed
    assert "end of the history" in printed


def test_every_variable_has_a_unit_and_a_meaning(whole: Path) -> None:
    data = xarray.open_zarr(whole)
    assert all(values.attrs["units"] and values.attrs["long_name"] for values in data.data_vars.values())
    assert data["varied_inner_radius"].attrs["units"] == "m"
    np.testing.assert_array_equal(data["varied_inner_radius"], data["inner_radius"])
    assert data.attrs["license"] == "CC-BY-4.0"
    assert json.loads(data.attrs["sweep"])["schema"] == "tactsim/sweep/1"
    assert (data["status"] == 1).all()


def test_noise_is_apart_from_what_is_clean(whole: Path) -> None:
    data = xarray.open_zarr(whole)
    assert not np.allclose(data["force"], data["read_force"], rtol=1e-6)
    assert np.corrcoef(data["force"].values.ravel(), data["read_force"].values.ravel())[0, 1] > 0.9


@pytest.mark.parametrize("tasks", [0, 1, 5])
def test_an_interrupted_sweep_goes_on(whole: Path, tmp_path: Path, tasks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "MOST_IN_TASK", 2)
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    with opened_run(sweep, place) as going, pytest.raises(KeyboardInterrupt):
        going.compute(Inline(sweep, stop_after=tasks), lambda tally: None)
    assert len(Store.open(place).pending()) > 0
    assert not (place / JOURNAL).exists()
    going = run_sweep(sweep, place, resume=True)
    assert going.tally.before + going.tally.done == 24
    assert_same(whole, place)


def killed_often(case: Path, kills: int, seed: int) -> Path:
    """The store of a sweep that was killed at random moments and went on each time."""
    moments, place = random.Random(seed), case.with_name("killed.zarr")
    program = f"import sys; sys.path.insert(0, {str(TESTS)!r}); import sweeps; sweeps.main({str(case)!r}, {str(place)!r})"
    command = [*forked_python(), program]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
        for kill in range(kills + 1):
            server.stdin.write("go on\n")  # type: ignore[union-attr]
            server.stdin.flush()  # type: ignore[union-attr]
            process = int(server.stdout.readline())  # type: ignore[union-attr]
            if kill < kills:
                time.sleep(moments.uniform(0.0, 0.5))
                os.kill(process, signal.SIGKILL)
            code = int(server.stdout.readline())  # type: ignore[union-attr]
            assert code == (-signal.SIGKILL if kill < kills else 0), "the kill came too late to try anything"
        server.communicate()
    return place


@pytest.mark.parametrize(("kills", "seed"), [(1, 1), pytest.param(20, 2, marks=pytest.mark.slow)])
def test_kills_at_random_moments_lose_nothing(tmp_path: Path, kills: int, seed: int) -> None:
    text = TEXT.replace("samples: 24", f"samples: {20 + 22 * kills}")
    place = killed_often(sweep_file(tmp_path, text), kills, seed)
    assert_same(small_store(tmp_path, text), place)
    assert check(place).findings == ()


def test_blocks_of_a_torn_journal_are_kept_up_to_the_tear(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "journal")
    journal.append(b"one")
    journal.append(b"two" * 50)
    whole = journal.path.read_bytes()
    for size in range(len(whole)):
        journal.path.write_bytes(whole[:size])
        assert list(journal.blocks()) == ([b"one"] if size >= 51 else [])
    journal.path.write_bytes(whole)
    assert list(journal.blocks()) == [b"one", b"two" * 50]
    journal.path.write_bytes(whole[:60] + b"x" + whole[61:])
    assert list(journal.blocks()) == [b"one"]


def test_a_second_sweep_is_refused_while_the_first_runs(tmp_path: Path) -> None:
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    with opened_run(sweep, place), pytest.raises(StorageError, match="in use by another sweep"):
        run_sweep(sweep, place, resume=True)
    (tmp_path / ".s.zarr.lock").write_text("what a dead process left")
    run_sweep(sweep, place, resume=True)


def test_too_little_memory_is_not_called_damage(whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise MemoryError("Unable to allocate 12 GiB")

    store = Store.open(whole)
    monkeypatch.setattr(type(store.files), "rows", full)
    with pytest.raises(OutOfMemory, match=r"the memory does not suffice to read .*status; read fewer variables or samples"):
        store.read("status")


def test_an_existing_store_needs_resume_and_the_same_sweep(whole: Path, tmp_path: Path) -> None:
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    with pytest.raises(StorageError, match=r"no data set .* to resume"):
        run_sweep(sweep, place, resume=True)
    run_sweep(sweep, place)
    with pytest.raises(StorageError, match="--resume"):
        run_sweep(sweep, place)
    changed = load_once(sweep_file(tmp_path, TEXT.replace("2.5 mm", "2.4 mm")))
    with pytest.raises(StorageError, match=r"experiment\.inner_radius\.uniform differs"):
        run_sweep(changed, place, resume=True)
    with pytest.raises(StorageError, match="would lose some"):
        run_sweep(load_once(sweep_file(tmp_path), samples=12), place, resume=True)
    run_sweep(load_once(sweep_file(tmp_path), samples=30), place, resume=True)
    retold = TEXT.replace(
        "times: 4", "times: 4\n  title: Told anew\n  limits: None known\n  license: CC0-1.0\n  time_limit: 1 min"
    )
    run_sweep(load_once(sweep_file(tmp_path, retold), samples=30), place, resume=True)
    assert [Store.open(place).attributes[name] for name in ("title", "limits", "license")] == [
        *("Told anew", "None known", "CC0-1.0"),
    ]
    longer = content(place)
    for name, values in content(whole).items():
        np.testing.assert_array_equal(values, longer[name][:24], err_msg=name)
    assert check(place).findings == ()


def test_changed_code_is_refused_or_marked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    with opened_run(sweep, place) as going, pytest.raises(KeyboardInterrupt):
        going.compute(Inline(sweep, stop_after=1), lambda tally: None)
    monkeypatch.setattr(resuming, "code_identity", lambda: "9.9.9+other")
    with pytest.raises(StorageError, match="--accept-changed-code"), opened_run(sweep, place, resume=True):
        pass
    run_sweep(sweep, place, resume=True)
    store = Store.open(place)
    assert store.attributes["codes"] == [code_identity.code_identity(), "9.9.9+other"]
    assert sorted(set(store.read("code").tolist())) == [0, 1]


@pytest.mark.parametrize("thing", ["file", "folder"])
def test_what_is_not_a_data_set_is_left_alone(tmp_path: Path, thing: str) -> None:
    place = tmp_path / "mine"
    (place if thing == "folder" else tmp_path).mkdir(exist_ok=True)
    target = place / "notes.txt" if thing == "folder" else place
    target.write_text("mine")
    with pytest.raises(StorageError, match="not a data set of tactsim"):
        run_sweep(load_once(sweep_file(tmp_path)), place)
    assert target.read_text() == "mine"
    with pytest.raises(StorageError, match="not a data set"):
        Store.open(place)


def test_a_store_of_another_schema_is_refused(whole: Path, tmp_path: Path) -> None:
    place = Path(shutil.copytree(whole, tmp_path / "s.zarr"))
    set_attributes(Store.open(place, writing=True), schema="tactsim/dataset/2")
    with pytest.raises(StorageError, match=r"schema 'tactsim/dataset/2'; this tactsim reads 'tactsim/dataset/1'"):
        Store.open(place)


@pytest.mark.parametrize("room", [1_500, 40_000])
def test_a_full_disk_ends_with_an_error_and_keeps_what_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, room: int
) -> None:
    """The largest file that may be written stands for the room: there is none for the first task, or for a later one."""
    monkeypatch.setattr(running, "MOST_IN_TASK", 2)
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    limits, earlier = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    with opened_run(sweep, place) as going:
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, limits[1]))
            with pytest.raises(StorageError, match=r"cannot write .*: File too large"):
                going.compute(Inline(sweep), lambda tally: None)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
            signal.signal(signal.SIGXFSZ, earlier)
    assert going.tally.done == (0 if room < 2_000 else 24 - len(Store.open(place).pending()))
    assert (going.tally.done > 0) == (room > 2_000)
    run_sweep(sweep, place, resume=True)
    assert check(place).findings == ()


def test_a_disk_that_is_full_before_the_first_sample_is_not_called_damage(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The advice was to bring back a copy of a store that did not exist yet."""

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(zarr, "consolidate_metadata", full)
    with (
        pytest.raises(StorageError, match=r"^cannot write .*: No space left on device$"),
        opened_run(load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"),
    ):
        pytest.fail("it was opened")
    assert not (tmp_path / "s.zarr").exists()


def test_nothing_new_is_put_into_a_store(whole: Path, tmp_path: Path) -> None:
    """Its own check then called what a sweep or a run had put there foreign."""
    kept = tmp_path / "kept.zarr"
    shutil.copytree(whole, kept)
    for place in (kept / "inner.zarr", kept / "force" / "inner.zarr"):
        with pytest.raises(StorageError, match=r"inner\.zarr lies in the data set .*kept\.zarr; choose a place outside it"):
            run_sweep(load_once(sweep_file(tmp_path)), place)
        with pytest.raises(StorageError, match="lies in the data set"), claimed(place):
            pytest.fail("it was claimed")
    assert check(kept).findings == ()


def left_in_journal(sweep: Sweep, place: Path, monkeypatch: pytest.MonkeyPatch, *, resume: bool = False) -> int:
    """How many samples a run left in the journal whose arrays could not be written."""

    def full(*_: object) -> None:
        raise StorageError("no room")

    with monkeypatch.context() as patch, opened_run(sweep, place, resume=resume) as going:
        patch.setattr(running, "write", full)
        with pytest.raises(StorageError, match="no room"):
            going.compute(Inline(sweep), lambda tally: None)
    return int(going.tally.done)


def test_arrays_that_cannot_be_written_wait_in_the_journal(whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    waiting = left_in_journal(sweep, place, monkeypatch)
    findings = check(place).findings
    assert [finding.kind for finding in findings] == ["missing", "unfinished"]
    assert f"24 samples are not in the arrays, {waiting} of them computed and in the journal" in findings[0].words
    lines = description(place).splitlines()
    assert f"pending {24 - waiting}" in [" ".join(line.split()) for line in lines]
    assert any(line.split()[:2] == ["waiting", f"{waiting}"] for line in lines)
    with opened_run(sweep, place, resume=True, accept_changes=True):
        pass
    assert_same(whole, place)


@pytest.mark.parametrize("before", [0, 1], ids=["of the journal alone", "with computed samples"])
def test_a_chunk_that_cannot_be_read_does_not_keep_the_journal_out(
    before: int, whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A machine that loses its power leaves chunks empty; --resume ended with the advice to go on with --resume."""
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    if before:
        with pytest.raises(KeyboardInterrupt):
            run_sweep(sweep, place, stop_after=before)
    assert left_in_journal(sweep, place, monkeypatch, resume=before > 0)
    computed, chunk = 24 - len(Store.open(place).pending()), place / "force/c/0/0"
    chunk.parent.mkdir(parents=True, exist_ok=True)
    chunk.write_bytes(b"")
    going = run_sweep(sweep, place, resume=True)
    assert going.tally.again == computed
    assert (computed > 0) == (before > 0)
    assert_same(whole, place)
    assert not (place / JOURNAL).exists()
    assert check(place).findings == ()


def test_samples_that_come_into_the_arrays_while_they_are_counted_count_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They were taken off those that are pending twice, and counted as waiting and as done."""
    sweep, place = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr"
    waiting, read, reads = left_in_journal(sweep, place, monkeypatch), Store.read, []

    def meanwhile(store: Store, name: str, *rows: Any) -> np.ndarray:
        values = read(store, name, *rows)
        if name == "status" and not reads:
            reads.append(name)
            with opened_run(sweep, place, resume=True):
                pass
        return values

    monkeypatch.setattr(Store, "read", meanwhile)
    counts = dict(line.split()[:2] for line in description(place).splitlines()[3:7])
    assert counts == {"pending": f"{24 - waiting}", "done": "0", "failed": "0", "waiting": f"{waiting}"}


def test_a_store_that_was_being_extended_is_not_described(whole: Path, tmp_path: Path) -> None:
    place = Path(shutil.copytree(whole, tmp_path / "s.zarr"))
    split = Store.open(place, writing=True).array("split")
    split.resize((30,))
    with pytest.raises(StorageError, match="have 24 to 30 samples: a run was killed while it made room; go on with --resume"):
        description(place)


def test_a_store_that_is_written_is_in_use_by_whatever_link_it_is_named(tmp_path: Path) -> None:
    sweep, place, link = load_once(sweep_file(tmp_path)), tmp_path / "s.zarr", tmp_path / "link.zarr"
    link.symlink_to(place)
    with opened_run(sweep, place):
        for other in (place, link):
            with (
                pytest.raises(StorageError, match="in use by another sweep"),
                opened_run(sweep, other, resume=True, accept_changes=True),
            ):
                pass


def test_a_lost_worker_costs_a_try_and_at_last_only_the_sample_that_kills(whole: Path, tmp_path: Path) -> None:
    sweep = load_once(sweep_file(tmp_path))
    run_sweep(sweep, tmp_path / "lucky.zarr", losing={5: 2})
    assert_same(whole, tmp_path / "lucky.zarr")
    going = run_sweep(sweep, tmp_path / "unlucky.zarr", losing={5: 99})
    store = Store.open(tmp_path / "unlucky.zarr")
    assert (store.read("status") == 2).nonzero()[0].tolist() == [5]
    assert store.read("reason")[5].startswith("lost 3 times: its process ended (SIGKILL)")
    assert going.tally.failed == 1
    assert store.read("varied_inner_radius")[5] > 0
    assert np.isnan(store.group["force"][5]).all()
    assert check(tmp_path / "unlucky.zarr").findings == ()


@pytest.mark.parametrize("count", [0, -1, "2", 1.5])
def test_a_number_of_workers_that_is_none_is_refused(tmp_path: Path, count: Any) -> None:
    with pytest.raises(InputError, match=r"workers is .*; allowed: whole numbers from 1 on"):
        LocalWorkers.of(load_once(sweep_file(tmp_path)), count)


def test_workers_that_always_die_end_the_sweep_and_mark_little(tmp_path: Path) -> None:
    sweep = load_once(sweep_file(tmp_path), samples=300)
    with opened_run(sweep, tmp_path / "s.zarr") as going, pytest.raises(TactsimError, match="30 tasks in a row were lost"):
        going.compute(Inline(sweep, losing=dict.fromkeys(range(300), 999)), lambda tally: None)
    assert (Store.open(tmp_path / "s.zarr").read("status") == 2).sum() <= 30


def test_a_sample_that_fails_is_kept_with_its_reason(tmp_path: Path) -> None:
    text = TEXT.replace("times: 4", "times: 4\n  redraws: 0").replace("[1 mm, 2.5 mm]", "[1 mm, 3.9 mm]")
    store = Store.open(small_store(tmp_path, text))
    failed = store.read("status") == 2
    assert 0 < failed.sum() < 24
    assert all(str(reason).startswith("no case was accepted in 1 draws") for reason in store.read("reason")[failed])
    specimens = len(set(store.read("specimen")[failed].tolist()))
    assert redrawn(store) == (specimens, specimens)
    assert sum(split_counts(store).values()) == 24 - failed.sum()


OF_ANOTHER_DIMENSION = "largest_force: 'Pa' is not a unit of what is in 'N'; expected a unit of its dimension"
NO_SUCH_QUANTITY = r"sweep.yaml:\d+: sweep.quantities.largest_froce: the result has no such quantity; it has .*largest_force"


@pytest.mark.parametrize(
    ("asked", "words", "executor"),
    [
        ("largest_force: Pa", OF_ANOTHER_DIMENSION, Inline),
        ("largest_froce: N", NO_SUCH_QUANTITY, Inline),
        pytest.param("largest_froce: N", NO_SUCH_QUANTITY, lambda sweep: LocalWorkers(sweep.text, 1), marks=pytest.mark.slow),
    ],
    ids=["another unit", "another name", "another name in a worker"],
)
def test_a_quantity_that_no_result_has_ends_the_sweep_at_once(
    tmp_path: Path, asked: str, words: str, executor: Callable[[Sweep], Executor]
) -> None:
    sweep = load_once(sweep_file(tmp_path, TEXT.replace("times: 4", f"times: 4\n  quantities: {{{asked}}}")))
    workers = executor(sweep)
    with pytest.raises(CaseError, match=words), closing(workers), opened_run(sweep, tmp_path / "s.zarr") as going:
        going.compute(workers, lambda tally: None)
    assert not (tmp_path / "s.zarr").exists(), "an empty store would refuse the sweep once it is corrected"


def test_a_quantity_is_stored_in_the_unit_that_is_asked_for(tmp_path: Path) -> None:
    asked = "{largest_force: mN, largest_displacement: m, rise_factor: '1'}"
    stores = []
    for words in (asked, asked.replace("mN", "N")):
        (folder := tmp_path / str(len(stores))).mkdir()
        stores.append(load(small_store(folder, TEXT.replace("times: 4", f"times: 4\n  quantities: {words}"))))
    in_millinewtons, in_newtons = (store["largest_force"] for store in stores)
    assert (in_millinewtons.attrs["units"], in_newtons.attrs["units"]) == ("mN", "N")
    assert in_millinewtons.values == pytest.approx(1e3 * in_newtons.values, rel=1e-14)
    assert np.array_equal(stores[0]["largest_displacement"].values, stores[1]["largest_displacement"].values)
    with pytest.raises(CaseError, match=r"sweep.yaml:\d+: sweep.quantities.largest_force: 'furlongs' is no known unit"):
        load_sweep(sweep_file(tmp_path, TEXT.replace("times: 4", "times: 4\n  quantities: {largest_force: furlongs}")))


def test_noise_differs_from_sample_to_sample_without_a_word_in_the_file(tmp_path: Path) -> None:
    sweep = load_sweep(CASES / "sweep_lumps.yaml", ("sweep.samples=6",))
    drawn = [drawn_specimen(sweep, specimen)[0] for specimen in range(2)]
    assert [used_seed(sweep, one) for one in drawn] == [one.case.experiment.readout.seed for one in drawn]
    text = re.sub(r"\n.*readout\.seed|\n +seed: \{integer: .*", "", (CASES / "sweep_lumps.yaml").read_text())
    (tmp_path / "unseeded.yaml").write_text(text)
    unseeded = load_sweep(tmp_path / "unseeded.yaml", ("sweep.samples=6",))
    drawn = drawn_specimen(unseeded, 0) + drawn_specimen(unseeded, 1)
    seeds = [one.case.experiment.readout.seed for one in drawn]
    assert seeds == [noise_seed(unseeded, one.sample) for one in drawn] == [used_seed(unseeded, one) for one in drawn]
    assert len(set(seeds)) == 6


@pytest.mark.parametrize(
    ("experiment", "path"),
    [
        (
            "kind: sensor_response, force: {kind: square, high: {values: [1 N, 2 N]}, frequency: 1 Hz, duration: 1 s}",
            "seed",
        ),
        ("kind: film_creep, data: {kind: synthetic, noise: {uniform: [0.001, 0.01]}}", "data.seed"),
    ],
)
def test_noise_differs_between_samples_of_kinds_that_store_what_the_sweep_names(
    tmp_path: Path, experiment: str, path: str
) -> None:
    """The store said other seeds than the samples had, which all were read with the noise of seed 1."""
    text = f"schema: tactsim/sweep/1\nexperiment: {{{experiment}}}\nsweep: {{samples: 4, quantities: {{rms_error: N}}}}\n"
    sweep = load_once(sweep_file(tmp_path, text))
    drawn = [drawn_specimen(sweep, specimen)[0] for specimen in range(4)]
    seeds = [dict(seeds_in(one.case.experiment))[path] for one in drawn]
    assert seeds == [used_seed(sweep, one) for one in drawn] == [noise_seed(sweep, one.sample) for one in drawn]
    fixed = drawn_specimen(load_once(sweep_file(tmp_path, text), (f"experiment.{path}=7",)), 1)[0]
    assert dict(seeds_in(fixed.case.experiment))[path] == used_seed(sweep, fixed) == 7


@pytest.mark.slow
def test_processes_give_the_same_and_a_killed_one_is_replaced(whole: Path, tmp_path: Path) -> None:
    sweep = load_once(sweep_file(tmp_path))
    workers = LocalWorkers(sweep.text, 2)
    killed: list[int] = []

    def kill_once(tally: object) -> None:
        if not killed and workers.processes:
            killed.append(workers.processes[0])
            os.kill(killed[0], signal.SIGKILL)

    with opened_run(sweep, tmp_path / "s.zarr") as going:
        try:
            going.compute(workers, kill_once)
        finally:
            workers.close()
    assert killed
    assert_same(whole, tmp_path / "s.zarr")


def test_chunks_hold_many_small_samples_or_a_few_large_ones() -> None:
    small, large = Variable("a", "1", "a", "reading"), Variable("b", "1", "b", "reading", ("time",), (100_000,))
    assert chunk_samples([small], 10_000) == 1024
    assert chunk_samples([small, large], 10_000) == 2
    assert chunk_samples([small], 24) == 16


def test_opening_ten_thousand_samples_reads_no_sample(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sweep = load_once(sweep_file(tmp_path), samples=10_000)
    with opened_run(sweep, tmp_path / "s.zarr"):
        pass
    asked, get = [], LocalStore.get

    async def noted(store: LocalStore, key: str, *more: Any, **options: Any) -> Any:
        asked.append(key)
        return await get(store, key, *more, **options)

    monkeypatch.setattr(LocalStore, "get", noted)
    data = xarray.open_zarr(tmp_path / "s.zarr")
    assert "zarr.json" in asked
    assert not [key for key in asked if "/" in key], "the description of all arrays is in one file"
    assert data["status"].values.shape == (10_000,)
    assert [key for key in asked if key.startswith("status/c/")], "what is read is noted"
