"""A progress bar on a terminal and in a notebook, and silence where nobody watches."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tactsim.results.result import StepRecord

FORM = "{desc} {percentage:3.0f}%|{bar}| {postfix} [{elapsed}<{remaining}]"
OPEN_FORM = "{desc} {n_fmt} steps {postfix} [{elapsed}]"
"""Where the end is not known beforehand."""
ELAPSED_FORM, TICK = "{desc} [{elapsed}]", 0.5
"""Of what cannot say how far it is, and the seconds after which its time is written anew."""
_quiet: ContextVar[bool] = ContextVar("quiet", default=False)


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


@contextmanager
def quiet(silent: bool = True) -> Iterator[None]:
    """A block in which nothing shows that it takes time, such as a run that reports to nobody."""
    token = _quiet.set(silent)
    try:
        yield
    finally:
        _quiet.reset(token)


@contextmanager
def elapsed_time(name: str) -> Iterator[None]:
    """A block that cannot say how far it is: its name with the time that it has taken; nothing in a quiet one."""
    if _quiet.get() or not is_watched():
        yield
        return
    from tqdm import tqdm

    ended = threading.Event()
    with tqdm(desc=name, bar_format=ELAPSED_FORM, leave=False) as bar:

        def tick() -> None:
            while not ended.wait(TICK):
                bar.refresh()

        clock = threading.Thread(target=tick, daemon=True)
        clock.start()
        try:
            yield
        finally:
            ended.set()
            clock.join()


def is_watched() -> bool:
    """Whether messages go to a terminal or a notebook."""
    return notes_are_watched() or "ipykernel" in sys.modules


def notes_are_watched() -> bool:
    """Whether standard error is a terminal."""
    with suppress(ValueError, AttributeError):  # closed, or none
        return sys.stderr.isatty()
    return False
