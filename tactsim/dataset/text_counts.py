"""Texts of many samples, such as the reasons of failed ones, counted by what they say whatever their numbers are."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
LONGEST, LONGEST_WARNING = 160, 400
"""Characters by which reasons of failures, and warnings, are told apart, a number counted as one."""


SHOWN = 5
"""Samples that are named, the first of those with a text."""
RANGE = " to "
"""Between two numbers of a text that are the ends of a range."""


@dataclass(frozen=True)
class CountedText:
    """A text, how many samples have it, and the first of their numbers."""

    text: str
    count: int
    first: tuple[int, ...] = ()

    @property
    def which(self) -> str:
        """The first samples that have it, such as ``3, 12, 40, ...``."""
        return ", ".join([*map(str, self.first), *(["..."] if 0 < len(self.first) < self.count else [])])

    def of(self, samples: int) -> str:
        """Of how many of ``samples`` it is, and of which, such as ``7 of 100 samples (3, 12, 40, ...)``."""
        if not self.first:  # texts of several kinds, of which a sample may have more than one
            return f"{self.count} times"
        return f"all {samples} samples" if self.count == samples > 1 else f"{self.count} of {samples} samples ({self.which})"


@dataclass
class _Kind:
    """Texts that differ in their numbers only: how many, of which samples the first, and the least and the largest number of each
    place as written."""

    count: int
    first: list[int]
    least: list[str]
    largest: list[str]

    def add(self, sample: int, numbers: list[str]) -> None:
        self.count += 1
        self.first = sorted([*self.first, sample])[:SHOWN]
        self.least = [min(pair, key=float) for pair in zip(self.least, numbers, strict=True)]
        self.largest = [max(pair, key=float) for pair in zip(self.largest, numbers, strict=True)]

    def text(self, words: tuple[str, ...]) -> str:
        """The words with the numbers between them, such as ``0.9 to 1.4`` where they differ; of a range the widest one."""
        numbers = []
        for place, (low, high) in enumerate(zip(self.least, self.largest, strict=True)):
            begins, ends = words[place + 1] == RANGE, words[place] == RANGE
            if float(low) == float(high) or begins != ends:
                numbers.append(high if ends else low)
            else:
                numbers.append(f"{_rounded(low)} to {_rounded(high)}")
        return "".join(itertools.chain(*zip(words, [*numbers, ""], strict=True)))


class TextCounts:
    """Counts of texts; those that differ in their numbers only count as one, which says the range of each number.

    ``longest`` is how many of their first characters tell them apart.
    """

    def __init__(self, longest: int = LONGEST) -> None:
        self._kinds: dict[tuple[str, ...], _Kind] = {}
        self._longest = longest

    def add(self, sample: int, texts: Iterable[str]) -> None:
        """Counts texts of one sample, each kind once."""
        for words, numbers in dict(map(self._parts, texts)).items():
            if words in self._kinds:
                self._kinds[words].add(sample, numbers)
            else:
                self._kinds[words] = _Kind(1, [sample], numbers, numbers)

    def most_common(self, most: int | None = None) -> list[CountedText]:
        """Texts and their counts, the most frequent first."""
        pairs = sorted(self._kinds.items(), key=lambda pair: -pair[1].count)[:most]
        return [CountedText(kind.text(words), kind.count, tuple(kind.first)) for words, kind in pairs]

    def _parts(self, text: str) -> tuple[tuple[str, ...], list[str]]:
        """The beginning of a text: its words, and the numbers between them."""
        words: list[str] = []
        numbers: list[str] = []
        room = self._longest
        for piece, number in itertools.zip_longest(NUMBER.split(text), NUMBER.findall(text)):
            words.append(piece[:room])
            room -= len(piece) + 1
            if number is None or room < 0:
                break
            numbers.append(number)
        return tuple(words), numbers


def _rounded(number: str) -> str:
    """A number that is one end of a range: whole as written, others to four digits."""
    return number if number.lstrip("+-").isdecimal() else f"{float(number):.4g}"
