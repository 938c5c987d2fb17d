"""A progress bar on a terminal and in a notebook, and silence where nobody watches."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tactsim.results.result import StepRecord

FORM = "{desc} {percentage:3.0f}%|{bar}| {postfix} [{elapsed}<{remaining}]"
OPEN_FORM = "{desc} {n_fmt} steps {postfix} [{elapsed}]"
"""Where the end is not known beforehand."""
ELAPSED_FORM, TICK = "{desc} [{elapsed}]", 0.5
"""Of what cannot say how far it is, and the seconds after which its time is written anew."""
_quiet: ContextVar[bool] = ContextVar("quiet", default=False)
_note: ContextVar[Callable[[str], None] | None] = ContextVar("note", default=None)
COMPILING = "compiling element loops, which later runs find on this machine (about 25 s)"
"""Source: 17 s of the processor for those of a grasp, of which two busy cores make 20 to 30; numba keeps them from then on."""


class Compilation:
    """What compiling has taken in this process; it is said once in a run, as it begins, that it goes on.

    The first run in a section compiles the loops of sections, the first one in 3D those of 3D. One loop is compiled within
    another, on whatever thread: only the outermost counts.

    Attributes
    ----------
    seconds : time in s of all that is compiled
    """

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth, self._begun, self._said = 0, 0.0, False
        self._lock = threading.Lock()

    def of_another_run(self) -> None:
        """A run begins: what it compiles is said again, for a run before it may have compiled other loops."""
        self._said = False

    def begin(self) -> None:
        """A loop is about to be compiled."""
        with self._lock:
            self._depth += 1
            if self._depth == 1:
                self._begun = time.monotonic()
        self._said = self._said or noted(COMPILING)

    def end(self) -> None:
        """It is compiled."""
        with self._lock:
            self._depth -= 1
            if self._depth == 0:
                self.seconds += time.monotonic() - self._begun


COMPILATION = Compilation()
"""That of this process, whose loops numba keeps compiled until it ends."""


@dataclass(frozen=True)
class Extent:
    """How far a run goes: the history value that grows during it, by its name, and its last value in SI."""

    name: str
    end: float

    def share(self, record: StepRecord) -> float:
        """The part of it that a step has reached, 0 at the start; beyond 1 if the step went farther."""
        return max(0.0, record.values.get(self.name, 0.0) / self.end)


@contextmanager
def step_bar(name: str, extent: Extent | None) -> Iterator[Callable[[StepRecord], None] | None]:
    """What is called with every accepted step; None where nobody watches.

    Parameters
    ----------
    name : of what runs
    extent : how far it goes; None if the end is not known
    """
    if not is_watched():
        yield None
        return
    from tqdm import tqdm

    compiled = COMPILATION.seconds
    with tqdm(total=extent and 100, desc=name, bar_format=FORM if extent else OPEN_FORM, leave=False) as bar:

        def advance(record: StepRecord) -> None:
            nonlocal compiled
            later, compiled = COMPILATION.seconds - compiled, COMPILATION.seconds
            bar.start_t, bar.last_print_t = bar.start_t + later, bar.last_print_t + later
            bar.set_postfix_str(f"step {record.step}", refresh=False)
            if extent is None:
                bar.update()
            else:
                bar.update(max(0.0, 100 * min(1.0, extent.share(record)) - bar.n))

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
def noted_by(note: Callable[[str], None] | None) -> Iterator[None]:
    """A block whose notes go to a function, watched or not; None leaves them to the terminal or the notebook."""
    token = _note.set(note)
    try:
        yield
    finally:
        _note.reset(token)


def noted(text: str) -> bool:
    """Writes a note about what is going on, above the bars; whether anybody is there to read it."""
    if (note := _note.get()) is not None:
        note(text)
        return True
    if _quiet.get() or not is_watched():
        return False
    from tqdm import tqdm

    tqdm.write(text, file=sys.stderr)
    return True


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
