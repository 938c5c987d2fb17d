"""What an author of a kind hands over for a result, looked at before it becomes part of one."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from tactsim.errors import InvalidQuantity, shown

NEEDED_TEXTS = "needed: a tuple of texts, such as ('a text',)"


def are_texts(given: object) -> bool:
    """Whether it is a tuple or list of texts; a text alone is not, as whoever takes it for one takes its letters."""
    return isinstance(given, tuple | list) and all(isinstance(one, str) for one in given)


def checked_texts(given: object, what: str) -> tuple[str, ...]:
    """Texts as a tuple; a single text is one of them, not its letters.

    Raises
    ------
    InvalidQuantity
        If anything else is given; ``what`` is how the message calls them.
    """
    texts = (given,) if isinstance(given, str) else tuple(given) if isinstance(given, Iterable) else None
    if texts is None or not are_texts(texts):
        raise InvalidQuantity(f"{what}: {shown(given)}; {NEEDED_TEXTS}")
    return texts


def without_number(quantities: Mapping[str, Any]) -> list[str]:
    """Names of the quantities that hold NaN or an infinite number; None says that there is none."""
    return [name for name, one in quantities.items() if not _finite(getattr(one, "value", None))]


def _finite(value: Any) -> bool:
    if isinstance(value, list | tuple):
        return all(map(_finite, value))
    if isinstance(value, np.ndarray | np.generic):
        return value.dtype.kind not in "fc" or bool(np.isfinite(value).all())
    return not isinstance(value, float) or math.isfinite(value)
