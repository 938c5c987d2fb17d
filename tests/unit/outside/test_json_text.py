"""JSON of others: how deep it may be."""

from __future__ import annotations

import pytest

from tactsim.errors import StorageError
from tactsim.outside.json_text import read_json


@pytest.mark.parametrize(("begin", "end"), [("[", "]"), ('{"a": ', "}")])
def test_lists_and_mappings_are_as_deep_as_allowed_and_no_deeper(begin: str, end: str) -> None:
    for text in ("1", *(begin * depth + "1" + end * depth for depth in (1, 3))):
        read_json(text, "it", deepest=3)
    with pytest.raises(StorageError, match="it is damaged: more than 3 lists and mappings inside each other"):
        read_json(begin * 4 + "1" + end * 4, "it", deepest=3)
