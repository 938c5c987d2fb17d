"""What an author of a kind hands over for a result, looked at before it becomes part of one."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from tactsim.errors import InvalidQuantity, shown


def checked_texts(given: object, what: str) -> tuple[str, ...]:
    """Texts as a tuple; a single text is one of them, not its letters.

    Raises
    ------
    InvalidQuantity
        If anything else is given; ``what`` is how the message calls them.
    """
    texts = (given,) if isinstance(given, str) else tuple(given) if isinstance(given, Iterable) else None
    if texts is None or not all(isinstance(one, str) for one in texts):
        raise InvalidQuantity(f"{what}: {shown(given)}; needed: a tuple of texts, such as ('a text',)")
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
