"""The places of a document where a distribution stands instead of one value, and the document with what was drawn for them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from tactsim.case.yaml_reading import Path, Problem, YamlProblems
from tactsim.errors import InputError
from tactsim.interfaces.distributions import READERS, Distribution, Listed, distribution


@dataclass(frozen=True)
class Place:
    """A key path of a document with what stands there instead of one value."""

    path: Path
    distribution: Distribution

    @property
    def key(self) -> str:
        """The key path as text."""
        return ".".join(map(str, self.path))

    @property
    def by_index(self) -> bool:
        """Whether what is drawn are options that are no numbers, of which the number of the option is stored."""
        return isinstance(self.distribution, Listed) and self.distribution.numbers is None

    @property
    def variable(self) -> str:
        """Name of the stored variable."""
        return "varied_" + "_".join(map(str, self.path[1:] if self.path[:1] == ("experiment",) else self.path))


def places_of(value: Any, path: Path) -> tuple[Place, ...]:
    """Every place in a value that stands at ``path``, by its keys, not their order in the text; those within options included.

    Raises
    ------
    YamlProblems
        With every distribution that is written wrongly.
    """
    read = list(_places_or_problems(value, path))
    if problems := [one for one in read if isinstance(one, Problem)]:
        raise YamlProblems(*problems)
    return tuple(one for one in read if isinstance(one, Place))


def _places_or_problems(value: Any, path: Path) -> Iterator[Place | Problem]:
    if is_distribution(value):
        try:
            read = distribution(value)
        except InputError as error:
            yield Problem(path, 0, str(error))
            return
        yield Place(path, read)
        if isinstance(read, Listed) and read.numbers is None:
            for index, option in enumerate(read.options):
                yield from _places_or_problems(option, (*path, "choice", index))
    elif isinstance(value, dict):
        for key, item in sorted(value.items()):
            yield from _places_or_problems(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _places_or_problems(item, (*path, index))


def sizes_of(places: tuple[Place, ...]) -> tuple[int, ...]:
    """Number of options of each place of a grid."""
    return tuple(len(place.distribution.options or ()) for place in places)


def is_distribution(value: Any) -> bool:
    """Whether a value of a document is meant as a distribution: a mapping to a list, by the name of one."""
    return isinstance(value, dict) and any(name in value for name in READERS) and "kind" not in value


def filled(value: Any, path: Path, drawn: Mapping[Path, tuple[Any, float]], used: dict[Path, float]) -> Any:
    """The value with what was drawn for each place; the stored number of every place that counts is added to ``used``."""
    if path in drawn:
        chosen, number = drawn[path]
        used[path] = number
        inner = (*path, "choice", int(number))
        return filled(chosen, inner, drawn, used) if isinstance(chosen, dict | list) else chosen
    if isinstance(value, dict):
        return {key: filled(item, (*path, key), drawn, used) for key, item in value.items()}
    if isinstance(value, list):
        return [filled(item, (*path, index), drawn, used) for index, item in enumerate(value)]
    return value
