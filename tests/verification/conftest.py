"""What the checks against exact solutions found, kept for the documentation when it is asked for.

``pytest tests/verification --verification-records docs/verification/records.json`` writes a row for each check: what
was compared with what, on which mesh, how far it was off, what was allowed. Rows of tests that were not run stay as they are.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tactsim

Row = dict[str, Any]
COMMAND = "pytest tests/verification --verification-records docs/verification/records.json"
FOUND = pytest.StashKey[dict[tuple[str, str, str], Row]]()
OPTION = "--verification-records"
KINDS = ("exact", "published", "invariance", "convergence")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(OPTION, metavar="FILE", type=Path, default=None, help="write what the verification tests found")


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption(OPTION, None) is not None and config.getoption("numprocesses", None):
        raise pytest.UsageError(f"{OPTION} keeps what one process found; leave --numprocesses out")
    config.stash[FOUND] = {}


@pytest.fixture
def verification_record(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Keeps what a check found; of the cases of one test with one mesh, the one that is farthest off.

    ``found`` and ``expected`` are compared relative to ``scale``, by default the largest size expected; an ``order`` is compared
    with ``theory`` and needs its tolerance. ``kind`` is one of ``KINDS``.
    """
    kept = request.config.stash.setdefault(FOUND, {})
    test = request.node.nodeid.partition("[")[0]

    def record(
        check: str,
        found: Any = None,
        expected: Any = None,
        *,
        reference: str,
        kind: str,
        mesh: str,
        tolerance: float | None = None,
        scale: float | None = None,
        order: float | None = None,
        theory: float | None = None,
    ) -> None:
        assert kind in KINDS
        assert theory is None or tolerance is not None, "the page of records shows what an order may be off"
        error = None if found is None else _relative_error(found, expected, scale)
        row = {"test": test, "check": check, "reference": reference, "kind": kind, "mesh": mesh, "error": error}
        row |= {"tolerance": tolerance, "order": order, "theory": theory}
        key = (test, check, mesh)
        if key not in kept or _how_far(row) > _how_far(kept[key]):
            kept[key] = row

    return record


def _relative_error(found: Any, expected: Any, scale: float | None) -> float:
    size = float(np.abs(expected).max()) if scale is None else scale
    return float(np.abs(np.asarray(found, float) - np.asarray(expected, float)).max()) / size


def _how_far(row: Row) -> float:
    return row["error"] if row["error"] is not None else abs(row["order"] - row["theory"])


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Writes the rows; those of tests that failed are not known to be checks, so that nothing is written then."""
    place = session.config.getoption(OPTION, None)
    found = session.config.stash.get(FOUND, {})
    if place is None or not found:
        return
    if session.testsfailed:
        raise pytest.UsageError("a test failed; no record is written")
    run = {row["test"] for row in found.values()}
    old = json.loads(place.read_text(encoding="utf-8"))["records"] if place.is_file() else []
    rows = [*(row for row in old if row["test"] not in run), *found.values()]
    rows.sort(key=lambda row: (row["test"], row["check"], row["mesh"]))
    rounded = [{key: float(f"{value:.3g}") if isinstance(value, float) else value for key, value in row.items()} for row in rows]
    content = {"tactsim": tactsim.__version__, "command": COMMAND, "records": rounded}
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
