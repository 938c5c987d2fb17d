"""``--set path.to.key=value``: changes of a case from the command line, validated like the file itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel

from tactsim.case.model import experiment_class
from tactsim.case.yaml_reading import Document, Path, Problem, YamlProblems, read_yaml
from tactsim.errors import UnknownName, shown


def apply_override(document: Document, override: str) -> Path:
    """Sets one value in the document, which it changes; returns the key path that the override made or replaced.

    A missing mapping on the way is created, as its default if it has one, so that a part of a default can be set; validation
    refuses unknown keys.

    Raises
    ------
    YamlProblems
        If the text is not ``path=value`` or the path leads through something that has no such entry.
    """
    path_text, equals, value_text = override.partition("=")
    keys = path_text.strip().split(".")
    if not equals or not all(keys):
        raise _refused(f"{shown(override)} is not of the form path.to.key=value")
    try:
        value = read_yaml(value_text).value
    except YamlProblems as error:
        raise _refused(f"the value {shown(value_text)} cannot be read: {error}") from None
    return set_value(document, keys, value)


def set_value(document: Document, keys: Sequence[str], value: Any) -> Path:
    """Sets the value at a key path of the document, which it changes; returns the key path that was made or replaced.

    Raises
    ------
    YamlProblems
        If the path leads through something that has no such entry.
    """
    target: Any = document.value
    place: Path = ()
    made: Path | None = None
    for key in keys[:-1]:
        step = _step(target, place, key)
        place = (*place, step)
        if (target[step] if isinstance(target, list) else target.get(step)) is None:
            target[step], made = _default(document, place), made or place
        target = target[step]
    step = _step(target, place, keys[-1])
    target[step] = value
    return made or (*place, step)


def _default(document: Document, place: Path) -> dict[str, Any]:
    """The default of a field of the experiment as a case file would hold it, empty if it has none that is a mapping."""
    experiment = document.value.get("experiment") if isinstance(document.value, dict) else None
    if len(place) != 2 or place[0] != "experiment" or not isinstance(experiment, dict):
        return {}
    try:
        field = experiment_class(experiment["kind"]).model_fields[str(place[1])]
    except (KeyError, TypeError, UnknownName):  # validation says what is wrong with it
        return {}
    default = field.get_default(call_default_factory=True)
    if not isinstance(default, BaseModel):
        return {}
    written: dict[str, Any] = default.model_dump(mode="json", by_alias=True, context={"units": "written"})
    return written


def _step(target: Any, place: Path, key: str) -> Any:
    """The key or list index by which ``key`` enters ``target``."""
    if isinstance(target, dict):
        return key
    where = ".".join(map(str, place)) or "the case"
    if not isinstance(target, list):
        raise _refused(f"{where} is {shown(target)}, which has no entry {shown(key)}")
    allowed = [str(index) for index in range(len(target))]
    if key not in allowed:
        known = f"0 to {len(target) - 1}" if target else "none, the list is empty"
        raise _refused(f"{where} is a list without an entry {shown(key)}; entries: {known}")
    return int(key)


def _refused(message: str) -> YamlProblems:
    return YamlProblems(Problem((), 0, message))
