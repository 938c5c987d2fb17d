"""Faults in what does not vary in a sweep: each befalls every draw that has the part where it stands."""

from __future__ import annotations

from dataclasses import dataclass, field

from pydantic import BaseModel, ValidationError

from tactsim.case.yaml_reading import Path, Problem
from tactsim.errors import suggestion
from tactsim.interfaces.distributions import READERS
from tactsim.refusals import details, path_in_file, refusals_of
from tactsim.schema_of_model import value_at

CERTAIN = {"extra_forbidden", "missing"}
"""Refusals by pydantic that depend on the kind of what is around a place, and on no number."""


@dataclass
class FixedParts:
    """What was refused in the cases that were tried, by key paths of the document, in which an option stands in its choice."""

    document: object
    """The plain content of the sweep."""
    _tried: list[dict[Path, float]] = field(default_factory=list)
    _refused: dict[Path, list[str]] = field(default_factory=dict)

    def accept(self, used: dict[Path, float]) -> None:
        """Count a case with what was drawn in it, which nothing was wrong with."""
        self._tried.append(dict(used))

    def refuse(
        self, used: dict[Path, float], error: ValidationError, value: object, model: type[BaseModel], wrong_in_type: set[Path]
    ) -> None:
        """Count a case that was refused; ``wrong_in_type`` are the places of it with another type, unit or dimension."""
        self.accept(used)
        certain = {path_in_file(one["loc"], value, str(one["type"])) for one in details(error) if one["type"] in CERTAIN}
        reasons = refusals_of(error, value, model)
        for path in wrong_in_type | certain:
            place = self._in_document(path, used)
            if path in reasons and not any(drawn[: len(place)] == place for drawn in used):
                self._refused.setdefault(place, []).append(reasons[path])

    def problems(self) -> list[Problem]:
        """A problem for every place that was refused in all tried cases that have it."""
        return [
            Problem(place, 0, f"{reasons[0]}{self._meant(place)}")
            for place, reasons in self._refused.items()
            if len(reasons) == sum(_has(used, place) for used in self._tried)
        ]

    def _in_document(self, path: Path, used: dict[Path, float]) -> Path:
        """The key path in the document of a place in a case, where the option that was drawn stands in place of its choice."""
        place: Path = ()
        for key in path:
            place = (*_option(place, used), key)
        option = _option(place, used)
        return option if isinstance(value_at(self.document, option), dict | list) else place

    def _meant(self, place: Path) -> str:
        """The distribution that a mapping of one key may have been meant as."""
        written = value_at(self.document, place)
        key = next(iter(written)) if isinstance(written, dict) and len(written) == 1 else ""
        if not key:
            return ""
        if meant := suggestion(str(key), READERS):
            return meant
        return f", or a distribution: {', '.join(READERS)}" if isinstance(written[key], list) else ""


def _option(place: Path, used: dict[Path, float]) -> Path:
    """The place, or where the option stands that was drawn for it."""
    while place in used:
        place = (*place, "choice", int(used[place]))
    return place


def _has(used: dict[Path, float], place: Path) -> bool:
    """Whether a case has the place: whether the options around it were drawn."""
    choices = [k for k, key in enumerate(place) if key == "choice" and k + 1 < len(place)]
    return all(used.get(place[:k]) == place[k + 1] for k in choices)
