"""Texts of many samples, such as the reasons of failed ones, counted by what they say whatever their numbers are."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
LONGEST, LONGEST_WARNING = 160, 400
"""Characters by which reasons of failures, and warnings, are told apart, a number counted as one."""


RANGE = " to "
"""Between two numbers of a text that are the ends of a range."""


@dataclass
class _Kind:
    """Texts that differ in their numbers only: how many, and the least and the largest number of each place as written."""

    count: int
    least: list[str]
    largest: list[str]

    def add(self, numbers: list[str]) -> None:
        self.count += 1
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

    def update(self, texts: Iterable[str]) -> None:
        """Counts texts."""
        for text in texts:
            self._add(*self._parts(text))

    def update_of_one(self, texts: Iterable[str]) -> None:
        """Counts texts of one sample, each kind once."""
        for words, numbers in dict(map(self._parts, texts)).items():
            self._add(words, numbers)

    def most_common(self, most: int | None = None) -> list[tuple[str, int]]:
        """Texts and their counts, the most frequent first."""
        pairs = sorted(self._kinds.items(), key=lambda pair: -pair[1].count)[:most]
        return [(kind.text(words), kind.count) for words, kind in pairs]

    def _add(self, words: tuple[str, ...], numbers: list[str]) -> None:
        if words in self._kinds:
            self._kinds[words].add(numbers)
        else:
            self._kinds[words] = _Kind(1, numbers, numbers)

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
