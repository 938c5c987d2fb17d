"""The sweep of a store: what a new store says of it, and how it is read from a store, whatever the text there holds."""

from __future__ import annotations

import json
import platform
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from tactsim.code_identity import code_identity, installed_versions
from tactsim.dataset.cost import COST
from tactsim.dataset.sampling.layout import Layout, layout_of
from tactsim.dataset.sampling.sweep import Sweep, deciding, sweep_of_text
from tactsim.dataset.store.arrays import META, parsed_json
from tactsim.dataset.store.opening import Store
from tactsim.errors import InputError, StorageError
from tactsim.outside.files import Unreadable
from tactsim.outside.text import one_line
from tactsim.results.provenance import PACKAGES

UNUSABLE = (InputError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RuntimeError)
"""What reading a sweep raises on a text that no sweep wrote."""


def attributes_of(sweep: Sweep, layout: Layout) -> dict[str, Any]:
    """Attributes of a new store."""
    return {
        **attributes_of_sweep(sweep),
        "description": layout.recorder.describe(),
        "sweep_id": sweep.identity,
        "samples_per_specimen": sweep.per_specimen,
        "seed": sweep.settings.seed,
        "kind": sweep.kind,
        "codes": [code_identity()],
        "versions": dict(_versions()),
        "options": {p.variable: [_shown(option) for option in p.distribution.options or ()] for p in sweep.places if p.by_index},
    }


def attributes_of_sweep(sweep: Sweep) -> dict[str, Any]:
    """Those that may change when a store is gone on with: the text of the sweep, and what of it the card says."""
    title = sweep.settings.title or str(sweep.document.value.get("title", ""))
    return {"title": title, "sweep": sweep.text, "limits": sweep.settings.limits, "license": sweep.settings.license}


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
    earlier, now = (deciding(text) if isinstance(text, dict) else text for text in (earlier, now))
    where = one_line(_difference(earlier, now, ""))
    if not where:
        raise StorageError(f"{one_line(place)}/{META}: sweep_id is not that of its sweep; bring back a copy of it")
    raise StorageError(
        f"the data set {one_line(place)} holds another sweep: {where} differs; choose another folder, "
        "or go on with the case it was made with"
    )


def _difference(one: Any, other: Any, place: str) -> str:
    """The first place at which two plain values differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in sorted(one.keys() | other.keys()):
            if one.get(key) != other.get(key):
                return _difference(one.get(key), other.get(key), f"{place}.{key}" if place else key)
    return place if one != other else ""


def _shown(option: Any) -> str:
    return option if isinstance(option, str) else json.dumps(option, sort_keys=True)


@cache
def _versions() -> dict[str, str]:
    """The versions of what data rest on; to ask for them reads a file for each package."""
    return {"python": platform.python_version(), **installed_versions((*PACKAGES, "zarr", "xarray"))}


def stored_sweep(store: Store) -> Sweep:
    """The sweep of a store.

    Raises
    ------
    StorageError
        If its text is damaged, or of another version.
    """
    text = store.attributes["sweep"]
    if not isinstance(parsed_json(text, f"the sweep in {one_line(store.path)}"), dict):
        raise StorageError(f"{one_line(store.path)}: the sweep in it is no mapping; bring back a copy of zarr.json")
    try:
        return sweep_of_text(text, str(store.path.absolute().parent))
    except UNUSABLE as error:
        raise _unusable(store, error) from None


def layout_within(store: Store, layout: Layout) -> Layout:
    """The layout without the cost of samples if an earlier version of tactsim began the store, which did not keep it.

    Raises
    ------
    StorageError
        If the metadata of the store are missing or damaged.
    """
    known = {*store.described, *store.faults, *store.missing}
    kept = (one for one in layout.variables if one.name in known or one.name not in COST or one.role != "index")
    return replace(layout, variables=tuple(kept))


def stored_layout(store: Store) -> tuple[Sweep, Layout]:
    """The sweep of a store and the variables that it stores.

    Raises
    ------
    StorageError
        If its text is damaged, or of another version.
    """
    sweep = stored_sweep(store)
    try:
        return sweep, layout_within(store, layout_of(sweep))
    except Unreadable as error:
        advice = f"{error}; files that a sweep names are looked for beside the store and in the working folder: run tactsim there"
        raise StorageError(f"{one_line(store.path)}: {advice}") from None
    except UNUSABLE as error:
        raise _unusable(store, error) from None


def _unusable(store: Store, error: BaseException) -> StorageError:
    reason = one_line(error, 300)
    return StorageError(
        f"{one_line(store.path)}: the case in it cannot be read by this tactsim: {reason}; bring back a copy of it"
    )
