"""Defects of the server: each is reported once, in one line. What clients do wrong is answered, not reported."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from aiohttp import ClientError, WebSocketError, web
from aiohttp.http_exceptions import HttpProcessingError

from tactsim.outside.defect_place import unless_own
from tactsim.outside.text import one_line

LOGGER = logging.getLogger("tactsim.live")
SERVERS = ("tactsim.live", "aiohttp", "asyncio")
"""Loggers of this page and of the libraries that serve it."""
MOST_REPORTED = 10
"""Different defects that are reported while the page is open; a client that provokes more of them cannot fill the terminal."""
OF_CLIENTS = (
    HttpProcessingError,
    web.HTTPException,
    web.RequestPayloadError,
    ClientError,
    WebSocketError,
    ConnectionError,
    EOFError,
)
"""What a client that sends nonsense or goes away makes the libraries log; it has been answered."""


def report(error: BaseException) -> str:
    """Words for a client about a defect, which is also logged for the user."""
    LOGGER.error("%s", one_line(error), exc_info=error)
    return f"internal error ({type(error).__name__}); please report it{unless_own(error)}"


@contextmanager
def reporting_defects(write: Callable[[str], None]) -> Iterator[None]:
    """A block whose logged errors are passed to ``write`` in one line each; nothing else of the libraries' logs is shown."""
    handler = _Reporter(write)
    loggers = [logging.getLogger(name) for name in SERVERS]
    before = [(logger.propagate, logger.level) for logger in loggers]
    for logger in loggers:
        logger.addHandler(handler)
        logger.propagate = False
        logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        for logger, (propagate, level) in zip(loggers, before, strict=True):
            logger.removeHandler(handler)
            logger.propagate = propagate
            logger.setLevel(level)


class _Reporter(logging.Handler):
    """Makes one line of a record, unless a client caused it or it was reported before."""

    def __init__(self, write: Callable[[str], None]):
        super().__init__(logging.ERROR)
        self._write = write
        self._reported: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Reports the record."""
        error = record.exc_info[1] if record.exc_info else None
        if isinstance(error, OF_CLIENTS):
            return
        first = record.getMessage().partition("\n")[0]  # asyncio adds the source of tasks and coroutines below
        words = first if error is None else f"{type(error).__name__}: {one_line(error, 200)}"
        place = "" if error is None else unless_own(error)
        line = f"warning: internal error of the page ({one_line(words, 300)}); please report it{place}"
        if line not in self._reported and len(self._reported) < MOST_REPORTED:
            self._reported.add(line)
            self._write(line)
