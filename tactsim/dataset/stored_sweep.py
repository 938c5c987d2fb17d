"""The sweep that a store says it was made by, whatever that text holds."""

from __future__ import annotations

from tactsim.dataset.array_description import parsed_json
from tactsim.dataset.layout import Layout, layout_of
from tactsim.dataset.store import Store
from tactsim.dataset.sweep import Sweep, sweep_of_text
from tactsim.errors import InputError, StorageError
from tactsim.outside.files import Unreadable
from tactsim.outside.text import one_line

UNUSABLE = (InputError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RuntimeError)
"""What reading a sweep raises on a text that no sweep wrote."""


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


def stored_layout(store: Store) -> tuple[Sweep, Layout]:
    """The sweep of a store and the variables that it stores.

    Raises
    ------
    StorageError
        If its text is damaged, or of another version.
    """
    sweep = stored_sweep(store)
    try:
        return sweep, layout_of(sweep)
    except Unreadable as error:
        told = f"{error}; files that a sweep names are looked for beside the store and in the working folder: run tactsim there"
        raise StorageError(f"{one_line(store.path)}: {told}") from None
    except UNUSABLE as error:
        raise _unusable(store, error) from None


def _unusable(store: Store, error: BaseException) -> StorageError:
    reason = one_line(error, 300)
    return StorageError(
        f"{one_line(store.path)}: the case in it cannot be read by this tactsim: {reason}; bring back a copy of it"
    )
