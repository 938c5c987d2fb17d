"""Damage to a data set that is finished: found by name, never read as data, mended by a resumed sweep."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from sweeps import TEXT, assert_same, compute_once_here, run_sweep, small_store, sweep_file

from tactsim.cli import main
from tactsim.dataset import TorchSamples, load
from tactsim.dataset.checking import check
from tactsim.dataset.figures import card as dataset_card
from tactsim.dataset.sampling.sweep import load_sweep
from tactsim.dataset.store.opening import Store
from tactsim.errors import StorageError, shown

OLD_SWEEP = "arrays"
"""Attribute that stores of earlier versions lack."""


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small store of two chunks that stays as it is; samples 0 to 15 are in the first."""
    return small_store(tmp_path_factory.mktemp("kept"))


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sweeps start no processes and draw nothing, and samples are computed once."""
    compute_once_here(monkeypatch)
    monkeypatch.setattr(dataset_card, "card_figures", lambda store: {})


@pytest.fixture
def store(kept: Path, tmp_path: Path) -> Path:
    """The same to be spoilt."""
    return Path(shutil.copytree(kept, tmp_path / "small.zarr"))


def edited(store: Path, name: str, change: Callable[[dict[str, Any]], object]) -> None:
    """Changes a description."""
    path = store / name / "zarr.json"
    metadata = json.loads(path.read_text())
    change(metadata)
    path.write_text(json.dumps(metadata))


def resumed(store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Exit code and words of ``tactsim sweep --resume``."""
    code = main(["sweep", str(sweep_file(tmp_path)), "--out", str(store), "--resume", "--workers", "1"])
    printed = capsys.readouterr()
    return code, printed.out + printed.err


def lose_chunk(store: Path) -> None:
    (store / "force/c/1/0").unlink()


def lose_array(store: Path) -> None:
    shutil.rmtree(store / "force")


def lose_content(store: Path) -> None:
    shutil.rmtree(store / "force/c")


def truncate(store: Path) -> None:
    path = store / "force/c/1/0"
    path.write_bytes(path.read_bytes()[:40])


def zero(store: Path) -> None:
    path = store / "force/c/1/0"
    path.write_bytes(bytes(path.stat().st_size))


def empty(store: Path) -> None:
    (store / "force/c/1/0").write_bytes(b"")


def swap(store: Path) -> None:
    shutil.copyfile(store / "read_force/c/1/0", store / "force/c/1/0")


def spoil_text(store: Path) -> None:
    shutil.copyfile(store / "case_id/c/1", store / "reason/c/1")


def lose_status(store: Path) -> None:
    (store / "status/c/1").unlink()


def spoil_status(store: Path) -> None:
    (store / "status/c/1").write_bytes(b"nonsense")


DAMAGE: dict[str, tuple[Callable[[Path], object], int]] = {
    "chunk gone": (lose_chunk, 8),
    "array gone": (lose_array, 24),
    "chunks gone": (lose_content, 24),
    "truncated": (truncate, 8),
    "zeroed": (zero, 8),
    "emptied": (empty, 8),
    "another's": (swap, 8),
    "text": (spoil_text, 8),
    "status gone": (lose_status, 8),
    "status spoilt": (spoil_status, 8),
}
READ_LATE = {"another's", "text", "truncated", "zeroed", "emptied"}
"""Seen when the content is read, or by the checksum; a data set is opened without reading all of it."""


@pytest.mark.parametrize("kind", DAMAGE)
def test_damage_is_found_refused_and_mended(
    kind: str, kept: Path, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spoil, lost = DAMAGE[kind]
    spoil(store)
    assert main(["data", "check", str(store)]) in (4, 5)
    printed = capsys.readouterr()
    assert "--resume" in printed.out + printed.err
    assert "internal error" not in printed.err
    if kind not in READ_LATE:
        with pytest.raises(StorageError, match="bring back a copy"):
            load(store)
    code, words = resumed(store, tmp_path, capsys)
    assert code == 0
    assert f"{lost} samples were there and damaged" in words
    assert f"{lost} samples done, 0 failed" in words
    assert_same(kept, store)
    assert check(store).findings == ()


@pytest.mark.parametrize("kind", ["truncated", "zeroed", "emptied"])
def test_a_damaged_chunk_is_refused_when_it_is_read(kind: str, store: Path, tmp_path: Path) -> None:
    DAMAGE[kind][0](store)
    lazy = load(store)
    assert np.isfinite(lazy["largest_force"].values).all()
    with pytest.raises(StorageError, match=r"the chunk force/c/1/0 of .* is damaged"):
        lazy["force"].load()
    assert main(["data", "export", str(store), "--to", str(tmp_path / "shards")]) == 5
    assert not (tmp_path / "shards").exists()
    with pytest.raises(StorageError, match="force/c/1/0"):
        _ = np.asarray(TorchSamples(store, inputs=["force"])._arrays()["force"][20])


def test_holes_are_refused_by_variable_and_sample(store: Path) -> None:
    lose_chunk(store)
    with pytest.raises(StorageError, match=r"holes: force of 8 samples \(16, 17, 18, 19, 20, 21, 22, 23\) are gone"):
        load(store)
    with pytest.raises(StorageError, match="holes: force"):
        TorchSamples(store, inputs=["force"])
    assert load(store, variables=["read_force"]).sizes["sample"] == 24
    shutil.rmtree(store / "voltage")
    with pytest.raises(StorageError, match=r"holes: force, voltage of 24 samples \(0, 1, .* 9 and 14 more\)"):
        load(store)


def as_earlier(store: Path) -> None:
    """The store as tactsim wrote it when chunks of nothing but fill values were no files."""
    (metadata := json.loads((store / "zarr.json").read_text()))["attributes"].pop(OLD_SWEEP)
    (store / "zarr.json").write_text(json.dumps(metadata))
    for name in ("redraws", "code"):
        shutil.rmtree(store / name / "c")


def test_a_store_of_an_earlier_version_is_read_and_verified_by_its_checksums(
    kept: Path, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    as_earlier(store)
    assert load(store).sizes["sample"] == 24
    assert check(store).findings == ()
    assert "earlier tactsim" in check(store).notes[0]
    lose_chunk(store)
    with pytest.raises(StorageError, match=r"holes: force, redraws of 8 samples"):  # zeros look like a loss beside one
        load(store)
    code, words = resumed(store, tmp_path, capsys)
    assert code == 0
    assert "8 x force is gone" in words
    assert_same(kept, store)


def test_a_chunk_of_nothing_but_fill_values_is_a_file(kept: Path) -> None:
    assert not Store.open(kept).read("redraws").any()
    assert {path.name for path in (kept / "redraws/c").iterdir()} == {"0", "1"}
    assert (xarray.open_zarr(kept)["redraws"].values == 0).all()


def test_an_array_that_is_gone_does_not_stop_an_extension(store: Path, tmp_path: Path) -> None:
    lose_array(store)
    run_sweep(load_sweep(sweep_file(tmp_path), samples=30), store, resume=True)
    (tmp_path / "whole").mkdir()
    whole = tmp_path / "whole/s.zarr"
    run_sweep(load_sweep(sweep_file(tmp_path), samples=30), whole)
    assert_same(whole, store)
    assert check(store).findings == ()


@pytest.mark.parametrize("name", ["wall_time", "status", "split", "code"])
def test_what_is_left_of_a_store_without_an_array_is_told(name: str, store: Path) -> None:
    shutil.rmtree(store / name)
    assert main(["data", "info", str(store)]) in (0, 5)


def test_a_store_with_nothing_but_its_description_is_filled_anew(
    store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What earlier versions left when they were killed while they made a store."""
    for array in [entry for entry in store.iterdir() if entry.is_dir()]:
        shutil.rmtree(array)
    for other in [entry for entry in store.iterdir() if entry.name != "zarr.json"]:
        other.unlink()
    code, printed = resumed(store, tmp_path, capsys)
    assert (code, "24 samples done" in printed) == (0, True), printed
    assert check(store).findings == ()


CHANGES = [
    (True, "units", "mN"),
    (True, "scale_factor", 1000.0),
    (True, "nothing", None),
    (False, "data_type", "uint64"),
    (False, "dimension_names", ["sample", "row"]),
]
"""Whether it is an attribute, its name, and a value with which what is stored would be read as something else."""


@pytest.mark.parametrize(("attribute", "name", "value"), CHANGES)
def test_a_changed_unit_or_type_is_not_read_as_data(
    attribute: bool, name: str, value: Any, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill = {} if name != "data_type" else {"fill_value": 0}
    edited(store, "force", lambda metadata: (metadata["attributes"] if attribute else metadata).update({name: value} | fill))
    words = rf"force/zarr\.json: {name} is {re.escape(shown(value))}, but .* in the zarr\.json of the store"
    with pytest.raises(StorageError, match=words):
        load(store)
    for command in (["data", "info", str(store)], ["show", str(store)]):
        assert main(command) == 5
        printed = capsys.readouterr()
        assert (printed.out, re.search(words, printed.err) is not None) == ("", True)
    assert main(["data", "export", str(store), "--to", str(tmp_path / "shards")]) == 5
    assert f"{name} is {value!r}" in capsys.readouterr().err
    assert not (tmp_path / "shards").exists()


DESCRIPTIONS: dict[str, tuple[str, Callable[[dict[str, Any]], object]]] = {
    "unit": ("force", lambda metadata: metadata["attributes"].update(units="mN")),
    "no unit": ("force", lambda metadata: metadata["attributes"].pop("units")),
    "meaning": ("force", lambda metadata: metadata["attributes"].update(long_name="something else")),
    "no meaning": ("force", lambda metadata: metadata["attributes"].pop("long_name")),
    "role": ("force", lambda metadata: metadata["attributes"].update(role="label")),
    "more": ("force", lambda metadata: metadata["attributes"].update(scale_factor=1000.0)),
    "type": ("force", lambda metadata: metadata.update(data_type="int64", fill_value=0)),
    "object": ("force", lambda metadata: metadata.update(data_type="object")),
    "half": ("force", lambda metadata: metadata.update(data_type="float32")),
    "dimension": ("force", lambda metadata: metadata.update(dimension_names=["sample", "row"])),
    "fill": ("redraws", lambda metadata: metadata.update(fill_value=7)),
    "flags": ("split", lambda metadata: metadata["attributes"].update(flag_meanings="test validation train softer")),
    "shape": ("force", lambda metadata: metadata.update(shape=[10**12, 4])),
    "short": ("force", lambda metadata: metadata.update(shape=[16, 4])),
    "wide": ("force", lambda metadata: metadata.update(shape=[24, 10**12])),
    "chunk": ("force", lambda metadata: metadata["chunk_grid"]["configuration"].update(chunk_shape=[10**9, 4])),
    "no chunk": ("force", lambda metadata: metadata["chunk_grid"]["configuration"].update(chunk_shape=[0, 4])),
    "transformed": ("force", lambda metadata: metadata.update(storage_transformers=[{"name": "nonsense"}])),
    "smaller": ("force", lambda metadata: metadata["chunk_grid"]["configuration"].update(chunk_shape=[8, 4])),
    "codec": ("force", lambda metadata: metadata["codecs"].append({"name": "nonsense"})),
    "order": ("force", lambda metadata: metadata["codecs"][0]["configuration"].update(endian="big")),
    "status": ("status", lambda metadata: metadata.update(shape=[10**12])),
    "status flags": ("status", lambda metadata: metadata["attributes"].update(flag_meanings=None)),
    "status type": ("status", lambda metadata: metadata.update(data_type="float64", fill_value="NaN")),
}


READABLE = ("meaning", "flags", "short", "unit", "no unit")
"""Changes with which the sweep may go on, or which it puts right by itself."""
MENDED = ("type", "shape", "no chunk", "codec", "status")
"""One of each sort, whose mending the quick run tries: it is the same for all, a description that is gone and written anew."""


@pytest.mark.parametrize("kind", DESCRIPTIONS)
def test_a_changed_description_is_found_and_not_written_to(
    kind: str, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name, change = DESCRIPTIONS[kind]
    edited(store, name, change)
    code = main(["data", "check", str(store)])
    printed = capsys.readouterr()
    assert code in (4, 5)
    assert f"{name}" in printed.out + printed.err
    assert kind != "transformed" or "storage_transformers" in printed.out
    assert "bring back" in printed.out + printed.err or "--resume" in printed.out + printed.err
    for command in (["data", "info"], ["show"]):
        assert main([*command, str(store)]) in (0, 5)
        assert "internal error" not in capsys.readouterr().err
    code, words = resumed(store, tmp_path, capsys)
    assert kind in READABLE or code == 5, words


@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=() if kind in MENDED else pytest.mark.slow) for kind in DESCRIPTIONS if kind not in READABLE],
)
def test_a_changed_description_is_mended_once_it_is_gone(
    kind: str, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name, change = DESCRIPTIONS[kind]
    edited(store, name, change)
    assert resumed(store, tmp_path, capsys)[0] == 5
    (store / name / "zarr.json").unlink()
    assert resumed(store, tmp_path, capsys)[0] == 0
    assert check(store).findings == ()


GROUP: dict[str, Callable[[dict[str, Any]], object]] = {
    "sweep_id": lambda metadata: metadata["attributes"].update(sweep_id="0" * 16),
    "seed": lambda metadata: metadata["attributes"].update(seed=8),
    "title": lambda metadata: metadata["attributes"].update(title="Another"),
    "license": lambda metadata: metadata["attributes"].update(license="all rights reserved"),
    "arrays": lambda metadata: metadata["attributes"]["arrays"].remove("force"),
    "samples": lambda metadata: metadata["attributes"].update(
        sweep=metadata["attributes"]["sweep"].replace('"samples": 24', '"samples": 25')
    ),
    "gathered": lambda metadata: metadata["consolidated_metadata"]["metadata"]["force"]["attributes"].update(units="mN"),
}


@pytest.mark.parametrize("kind", GROUP)
def test_changed_words_of_the_store_are_found(kind: str, store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = store / "zarr.json"
    metadata = json.loads(path.read_text())
    GROUP[kind](metadata)
    path.write_text(json.dumps(metadata))
    assert main(["data", "check", str(store)]) == 4
    assert kind in capsys.readouterr().out


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 50_000, "{}", "[1]", "7", "not json", '{"sweep": {"samples": -1}}'])
def test_garbage_for_a_sweep_is_reported(text: str, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = store / "zarr.json"
    metadata = json.loads(path.read_text())
    metadata["attributes"]["sweep"] = text
    path.write_text(json.dumps(metadata))
    assert main(["data", "check", str(store)]) == 5
    error = capsys.readouterr().err
    assert "internal error" not in error
    assert error.count("\n") == 1
    metadata["attributes"]["sweep_id"] = "0" * 16
    path.write_text(json.dumps(metadata))
    assert resumed(store, tmp_path, capsys)[0] == 5


def foreign(store: Path) -> None:
    (store / "mine.txt").write_text("mine")
    (store / "force/notes").write_text("mine")


def test_files_of_others_are_found(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    foreign(store)
    assert main(["data", "check", str(store)]) == 4
    assert "force/notes, mine.txt: not written by tactsim" in capsys.readouterr().out


LINKED = ("force/c/1/0", "force/c", "force", "zarr.json", "force/zarr.json", "README.md")


@pytest.mark.parametrize("name", LINKED)
def test_links_in_a_store_are_not_followed(name: str, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (store / "README.md").write_text("mine")
    aside = tmp_path / "aside"
    shutil.move(store / name, aside)
    (store / name).symlink_to(aside)
    before = sorted((path, path.stat().st_mtime_ns) for path in aside.rglob("*"))
    assert main(["data", "check", str(store)]) == 5
    error = capsys.readouterr().err
    assert "link" in error
    assert error.count("\n") == 1
    assert main(["data", "export", str(store), "--to", str(tmp_path / "shards")]) == 5
    assert resumed(store, tmp_path, capsys)[0] == 5
    assert sorted((path, path.stat().st_mtime_ns) for path in aside.rglob("*")) == before


@pytest.mark.parametrize("name", ["zarr.json", "force/zarr.json", "force/c/1/0", ".journal", ".tactsim.json", "README.md"])
def test_pipes_in_a_store_do_not_block(name: str, store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (store / name).unlink(missing_ok=True)
    os.mkfifo(store / name)
    for command in (["data", "check"], ["data", "info"], ["show"]):
        assert main([*command, str(store)]) in (0, 4, 5)
    main(["data", "export", str(store), "--to", str(tmp_path / "shards"), "--variables", "force"])
    assert resumed(store, tmp_path, capsys)[0] == 5
    assert "internal error" not in capsys.readouterr().err


@pytest.mark.parametrize("action", ["check", "info", "export", "rank", "train", "confusion"])
def test_pipes_and_devices_for_a_store_are_refused(action: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.mkfifo(tmp_path / "pipe")
    more = {"export": ["--to", str(tmp_path / "x.h5")], "train": ["--out", str(tmp_path / "x.npz")]}.get(action, [])
    for place in (tmp_path / "pipe", Path("/dev/zero"), tmp_path / "nothing", sweep_file(tmp_path)):
        assert main(["data", action, str(place), "--reference", str(tmp_path), *more]) in (2, 5)
        assert "internal error" not in capsys.readouterr().err


def test_a_bomb_is_refused_before_it_is_unpacked(store: Path) -> None:
    from numcodecs import zstd

    (store / "force/c/1/0").write_bytes(zstd.compress(bytes(4 * 2**20), 1))
    with pytest.raises(StorageError, match=f"unpacks to {4 * 2**20} bytes; expected: {16 * 4 * 8}"):
        load(store)["force"].load()
    size = (2**40).to_bytes(8, "little")
    (store / "reason/c/1").write_bytes(b"\x28\xb5\x2f\xfd\xe0" + size + b"\x01\x00\x00")
    with pytest.raises(StorageError, match=f"unpacks to {2**40} bytes"):
        load(store)["reason"].load()


FEW_FILES = """
import os, resource, sys, tactsim.dataset.checking, xarray, zarr
from tactsim.cli import main
for most in (5, 8, 12):
    if child := os.fork():
        print(most, os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    else:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
        sys.stdout = sys.stderr
        code = main(["data", "check", sys.argv[1]])
        sys.stderr.flush()
        os._exit(code)
"""
"""Forks a process for every limit from one that has loaded the package."""


def test_few_files_may_be_open_at_once(kept: Path) -> None:
    command = [sys.executable, "-u", "-c", FEW_FILES, str(kept)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    assert done.returncode == 0, done.stderr
    codes = dict(line.split() for line in done.stdout.splitlines())
    assert set(codes) == {"5", "8", "12"}
    assert set(codes.values()) <= {"0", "5"}, done.stdout + done.stderr
    assert "internal error" not in done.stderr
    assert "Traceback" not in done.stderr


def test_words_of_a_store_cannot_forge_lines(store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    forged = "x\n\x1b[31m# done\n---\n24 x converged"
    edited(store, "", lambda metadata: metadata["attributes"].update(title=forged, description=forged, license=forged))
    edited(store, "force", lambda metadata: metadata["attributes"].update(units=forged, long_name=forged))
    opened = Store.open(store, writing=True)
    opened.array("reason")[3], opened.array("status")[3] = forged, 2
    for command in (["data", "check"], ["data", "info"], ["show"]):
        main([*command, str(store)])
        printed = capsys.readouterr()
        assert "\x1b" not in printed.out + printed.err
        assert not any(line.startswith(("24 x", "---", "# done")) for line in (printed.out + printed.err).splitlines())


@pytest.mark.parametrize("title", ["x\n---\nlicense: mine\n---\n# Other", "# Other", "---", "[a](http://b) `c` <script>"])
def test_a_title_cannot_break_the_card(title: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = TEXT.replace("title: A small sweep", f"title: {json.dumps(title)}").replace(
        "  times: 4", f"  times: 4\n  limits: {json.dumps(title)}"
    )
    case, place = sweep_file(tmp_path, text), tmp_path / "s.zarr"
    assert main(["sweep", str(case), "--out", str(place), "--samples", "3", "--workers", "1", "--quiet"]) == 0
    card = (place / "README.md").read_text(encoding="utf-8").splitlines()
    assert [line for line in card if line == "---"] == ["---"] * 2
    assert len([line for line in card if line.startswith("# ")]) == 1
    assert sum(line.startswith("license:") for line in card) == 1
    assert "<script>" not in card[4].replace("\\<", "")
    assert check(place).findings == ()
