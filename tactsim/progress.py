"""A progress bar on a terminal and in a notebook, and silence where nobody watches."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tactsim.results.result import StepRecord

FORM = "{desc} {percentage:3.0f}%|{bar}| {postfix} [{elapsed}<{remaining}]"
OPEN_FORM = "{desc} {n_fmt} steps {postfix} [{elapsed}]"
"""Where the end is not known beforehand."""


@contextmanager
def step_bar(name: str, extent: tuple[str, float] | None) -> Iterator[Callable[[StepRecord], None] | None]:
    """What is called with every accepted step; None where nobody watches.

    Parameters
    ----------
    name : of what runs
    extent : the history value that grows, and its last value; None if the end is not known
    """
    if not is_watched():
        yield None
        return
    from tqdm import tqdm

    with tqdm(total=extent and 100, desc=name, bar_format=FORM if extent else OPEN_FORM, leave=False) as bar:

        def advance(record: StepRecord) -> None:
            bar.set_postfix_str(f"step {record.step}", refresh=False)
            if extent is None:
                bar.update()
            else:
                bar.update(max(0.0, 100 * min(1.0, record.values.get(extent[0], 0.0) / extent[1]) - bar.n))

        yield advance


@contextmanager
def count_bar(name: str, total: int) -> Iterator[Callable[[int], None]]:
    """What is called with how many are done; it is silent where nobody watches."""
    if not is_watched():
        yield lambda done: None
        return
    from tqdm import tqdm

    with tqdm(total=total, desc=name) as bar:

        def advance(done: int) -> None:
            bar.update(done - bar.n)

        yield advance


def is_watched() -> bool:
    """Whether messages go to a terminal or a notebook."""
    return notes_are_watched() or "ipykernel" in sys.modules


def notes_are_watched() -> bool:
    """Whether standard error is a terminal."""
    with suppress(ValueError, AttributeError):  # closed, or none
        return sys.stderr.isatty()
    return False
