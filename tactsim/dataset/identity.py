"""What a store says of itself, and whether a sweep is the one that a store holds."""

from __future__ import annotations

import json
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from tactsim.code_identity import code_identity
from tactsim.dataset.array_description import META, parsed_json
from tactsim.dataset.layout import Layout
from tactsim.dataset.sweep import Sweep
from tactsim.errors import StorageError
from tactsim.outside.text import one_line
from tactsim.results.provenance import PACKAGES

LICENCE = "CC-BY-4.0"


def attributes_of(sweep: Sweep, layout: Layout) -> dict[str, Any]:
    """Attributes of a new store."""
    return {
        "title": sweep.settings.title or str(sweep.document.value.get("title", "")),
        "description": layout.recorder.describe(),
        "license": LICENCE,
        "sweep": sweep.text,
        "sweep_id": sweep.identity,
        "samples_per_specimen": sweep.per_specimen,
        "seed": sweep.settings.seed,
        "kind": sweep.kind,
        "codes": [code_identity()],
        "versions": dict(_versions()),
        "limits": sweep.settings.limits,
        "options": {
            p.variable: [_shown(option) for option in p.distribution.options or ()] for p in sweep.places if _by_index(p)
        },
    }


def check_same(sweep: Sweep, attributes: dict[str, Any], place: Path) -> None:
    """Refuse a sweep that would make other data than the store holds.

    Raises
    ------
    StorageError
        Naming the first key that differs.
    """
    if attributes.get("sweep_id") == sweep.identity:
        return
    earlier, now = (parsed_json(text, f"the sweep in {place}") for text in (attributes["sweep"], sweep.text))
    where = one_line(_difference(earlier, now, ""))
    if not where:
        raise StorageError(f"{one_line(place)}/{META}: sweep_id is not that of its sweep; bring back a copy of it")
    raise StorageError(
        f"the data set {one_line(place)} holds another sweep: {where} differs; choose another with --out, "
        "or go on with the case it was made with"
    )


def _difference(one: Any, other: Any, place: str) -> str:
    """The first place at which two plain values differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in sorted(one.keys() | other.keys()):
            if one.get(key) != other.get(key):
                return _difference(one.get(key), other.get(key), f"{place}.{key}" if place else key)
    return place if one != other else ""


def _by_index(place: Any) -> bool:
    return place.distribution.options is not None and place.distribution.numbers is None


def _shown(option: Any) -> str:
    return option if isinstance(option, str) else json.dumps(option, sort_keys=True)


@cache
def _versions() -> dict[str, str]:
    """The versions of what data rest on; to ask for them reads a file for each package."""
    found = {"python": platform.python_version()}
    for package in (*PACKAGES, "zarr", "xarray"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found
