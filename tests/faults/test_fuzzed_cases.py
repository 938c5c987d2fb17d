"""Every shipped case and sweep, changed at random: loaded, or refused by an error of ours. Long runs: see `test_fuzzed_files`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from damage import accepted, fuzz
from hypothesis import given
from hypothesis import strategies as st
from ruamel.yaml import YAML

from tactsim.case import load_case
from tactsim.dataset.sampling.sweep import load_sweep

ROOT = Path(__file__).parents[2]
CASES = sorted(path.name for path in (ROOT / "cases").glob("*.yaml"))
VALUES: list[Any] = [
    None,
    True,
    0,
    -1,
    10**30,
    1e300,
    1e-320,
    "nan",
    "1e-400 mm",
    "1e400 mm",
    "0 mm",
    "-1 mm",
    "1e300 m",
    "1e300 N",
    "1e9 Pa",
    "1e-30 s",
    "\x00",
    "\x1b[31m",
    "x" * 5000,
    "1 furlong",
    "../../../etc/passwd",
    "/dev/zero",
    [],
    [[]],
    {},
    [0] * 2000,
    ["1 mm"] * 500,
    {"kind": "none"},
    {"kind": ["x"]},
    "sphere",
]
Change = tuple[float, str, int]
CHANGES = st.lists(
    st.tuples(
        st.floats(0, 1, exclude_max=True),
        st.sampled_from(["delete", "value", "value", "value", "repeat", "wrap", "rename"]),
        st.integers(0, 999),
    ),
    min_size=1,
    max_size=3,
)


@cache
def case_content(name: str) -> str:
    """A shipped case as JSON."""
    return json.dumps(YAML(typ="safe", pure=True).load((ROOT / "cases" / name).read_text(encoding="utf-8")))


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every container in a document with each of its keys."""
    entries = list(value.items()) if isinstance(value, dict) else list(enumerate(value)) if isinstance(value, list) else []
    for key, item in entries:
        yield value, key
        yield from places(item)


def changed(content: Any, changes: Sequence[Change]) -> Any:
    """The document after all changes."""
    for where, what, number in changes:
        listed = list(places(content))
        if not listed:
            return content
        holder, key = listed[int(where * len(listed))]
        if what == "delete":
            del holder[key]
        elif what == "repeat":
            holder[key] = [holder[key]] * (2 + number % 3)
        elif what == "wrap":
            holder[key] = {"kind": holder[key]}
        elif what == "rename" and isinstance(holder, dict):
            holder["x\x1b" if number % 2 else "kind"] = holder.pop(key)
        else:
            holder[key] = VALUES[number % len(VALUES)]
        content = json.loads(json.dumps(content))  # so that no part stands in two places
    return content


@fuzz(0.2)
@given(st.sampled_from(CASES), CHANGES)
def test_changed_cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, changes: list[Change]) -> None:
    monkeypatch.chdir(ROOT)
    path = tmp_path / name
    path.write_text(json.dumps(changed(json.loads(case_content(name)), changes)), encoding="utf-8")
    with np.errstate(all="ignore"):  # the command line collects numpy's warnings of overflow and prints them
        accepted(lambda: (load_sweep if name.startswith("sweep") else load_case)(path))
