"""Processes of ``tactsim`` forked from one that has loaded it already: a fork takes milliseconds, loading takes seconds.

Only for tests in which a process is the vehicle: what starting and loading do is tried with processes of their own.
"""

from __future__ import annotations

import atexit
import gc
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
import types
from functools import cache
from pathlib import Path
from typing import NoReturn

CLIENT = Path(__file__).with_name("forked_tactsim.py")
SHARED = "TACTSIM_TEST_FORKS"
"""Variable that holds the socket of the server which all processes of one run of the tests use."""


@cache
def _served() -> str:
    """The socket of the run's server, or of this process's own, which ends with it."""
    if SHARED in os.environ:
        return os.environ[SHARED]
    folder = tempfile.TemporaryDirectory(prefix="tactsim-forks-")
    place = str(Path(folder.name) / "socket")
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, str(Path(__file__)), place]
    server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
    assert server.stdin is not None
    assert server.stdout is not None
    assert server.stdout.readline() == b"ready\n"
    server.stdout.close()

    def end() -> None:
        server.communicate()
        folder.cleanup()

    atexit.register(end)
    return place


def share() -> None:
    """Start the server for this process and for those that it will start; it loads beside them."""
    os.environ[SHARED] = _served()


def forked_command(*options: str) -> list[str]:
    """The beginning of a command that does what ``python OPTIONS -m tactsim.cli`` does; the options are none or ``-W error``."""
    assert options in ((), ("-W", "error"))
    return [sys.executable, "-IS", str(CLIENT), _served(), "strict" if options else "lax"]


def forked_python() -> list[str]:
    """The beginning of a command that does what ``python -c`` does, with tactsim loaded."""
    return [sys.executable, "-IS", str(CLIENT), _served(), "python"]


def forked_pretended_command() -> list[str]:
    """The beginning of a command that does what ``python -W error pretended_cli.py`` does."""
    return [sys.executable, "-IS", str(CLIENT), _served(), "pretended"]


class _Server:
    """Forks a child for every connection and reports its number and in the end its exit status."""

    def __init__(self, place: str):
        self.listening = socket.socket(socket.AF_UNIX)
        self.listening.bind(place)
        self.listening.listen(64)
        self.clients: dict[int, socket.socket] = {}
        self.woken, waking = socket.socketpair()
        for end in (self.woken, waking):
            end.setblocking(False)
        self.waking = waking
        signal.set_wakeup_fd(waking.fileno(), warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda number, frame: None)
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in the terminal is for pytest, which ends this process

    def serve(self) -> None:
        """Until the standard input is closed."""
        with selectors.DefaultSelector() as selector:
            for source in (self.listening, self.woken, 0):
                selector.register(source, selectors.EVENT_READ)
            while True:
                for key, _ in selector.select():
                    if key.fileobj is self.listening:
                        connection, _ = self.listening.accept()
                        request = self._asked(connection)
                        child = os.fork()
                        if not child:
                            self._run(connection, *request)
                        self._watch(selector, connection, child, request[1])
                    elif key.fileobj is self.woken:
                        self.woken.recv(4096)
                        self._bury(selector)
                    elif key.fileobj == 0:
                        return self._kill(list(self.clients))
                    elif key.fileobj in self.clients.values():  # the client was killed
                        self._kill([child for child, client in self.clients.items() if client is key.fileobj])
                        selector.unregister(key.fileobj)

    def _asked(self, connection: socket.socket) -> tuple[dict[str, object], list[int]]:
        text, descriptors, _, _ = socket.recv_fds(connection, 1 << 20, 3)
        while not text.endswith(b"\n"):
            text += connection.recv(1 << 20)
        return json.loads(text), list(descriptors)

    def _watch(self, selector: selectors.BaseSelector, connection: socket.socket, child: int, descriptors: list[int]) -> None:
        for descriptor in descriptors:
            os.close(descriptor)
        self.clients[child] = connection
        connection.sendall(f"{child}\n".encode())
        selector.register(connection, selectors.EVENT_READ)

    def _bury(self, selector: selectors.BaseSelector) -> None:
        """Tell the clients of the children that have ended."""
        while self.clients:
            child, status = os.waitpid(-1, os.WNOHANG)
            if not child:
                return
            with self.clients.pop(child) as client:
                if client in (key.fileobj for key in selector.get_map().values()):
                    selector.unregister(client)
                    client.sendall(f"{os.waitstatus_to_exitcode(status)}\n".encode())

    def _kill(self, children: list[int]) -> None:
        for child in children:
            os.kill(child, signal.SIGKILL)

    def _run(self, connection: socket.socket, request: dict[str, object], descriptors: list[int]) -> NoReturn:
        """In the child: the command, with the client's streams, folder and environment."""
        import warnings

        from tactsim.cli.entry import main

        signal.set_wakeup_fd(-1)
        for number in (signal.SIGCHLD, signal.SIGHUP, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for place in (connection, self.listening, self.woken, self.waking, *self.clients.values()):
            place.close()
        given = iter(descriptors)
        for number, is_open in enumerate(request["open"]):  # type: ignore[arg-type]
            os.dup2(next(given), number) if is_open else os.close(number)
        for descriptor in descriptors:
            os.close(descriptor)
        there: list[bool] = request["open"]  # type: ignore[assignment]
        sys.stdin = open(0, closefd=False) if there[0] else None  # noqa: SIM115
        sys.stdout = open(1, "w", closefd=False) if there[1] else None  # type: ignore[assignment]  # noqa: SIM115
        stderr = {"buffering": 1, "errors": "backslashreplace", "closefd": False}
        sys.stderr = open(2, "w", **stderr) if there[2] else None  # type: ignore[assignment, call-overload]  # noqa: SIM115
        os.chdir(str(request["folder"]))
        os.environ.clear()
        os.environ.update(request["environment"])  # type: ignore[call-overload]
        if request["mode"] in ("strict", "pretended"):
            warnings.simplefilter("error")
        if request["mode"] == "pretended":
            from pretended_cli import pretend

            pretend()
        sys.argv = ["tactsim", *request["arguments"]]  # type: ignore[misc]
        code = _program(sys.argv[1]) if request["mode"] == "python" else main()
        for stream in filter(None, (sys.stdout, sys.stderr)):
            stream.flush()
        os._exit(code)  # taking apart what was loaded costs more than the command


def _program(text: str) -> int:
    """In the child: what ``python -c TEXT`` does, its exit code."""
    main = types.ModuleType("__main__")
    sys.modules["__main__"] = main
    sys.path.insert(0, "")
    try:
        exec(compile(text, "<string>", "exec"), vars(main))  # noqa: S102  the text is a block of our own pages
    except BaseException:  # noqa: BLE001  the child ends with it, the server does not
        traceback.print_exc()
        return 1
    return 0


def _load() -> None:
    """Import what the commands use; what they write must outlive no power cut."""
    import matplotlib.backends.backend_agg
    import matplotlib.figure  # noqa: F401

    import tactsim.dataset.checking
    import tactsim.live.server  # noqa: F401
    from tactsim.cli.entry import main  # noqa: F401
    from tactsim.interfaces import Experiment
    from tactsim.registry import kinds

    kinds(Experiment)
    os.fsync = lambda descriptor: None
    assert len(os.listdir("/proc/self/task")) == 1, "a process with threads must not be forked"


if __name__ == "__main__":
    server = _Server(sys.argv[1])
    os.write(1, b"ready\n")  # clients may come; they wait until it is loaded
    _load()
    gc.freeze()  # a collection in a child would copy every page
    server.serve()
