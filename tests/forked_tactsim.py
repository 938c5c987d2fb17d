"""``python -IS forked_tactsim.py SOCKET MODE ARGUMENTS``: a child of the fork server as if it were itself.

Modes: strict, lax, pretended, python.
"""

import contextlib
import json
import os
import signal
import socket
import sys


def is_open(descriptor: int) -> bool:
    try:
        os.fstat(descriptor)
    except OSError:
        return False
    return True


def main() -> None:
    place, mode, *arguments = sys.argv[1:]
    streams = [is_open(number) for number in range(3)]
    handed_on = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    signal.pthread_sigmask(signal.SIG_BLOCK, handed_on)  # until there is somebody to hand them on to
    with socket.socket(socket.AF_UNIX) as server:
        server.connect(place)
        request = {
            "arguments": arguments,
            "mode": mode,
            "open": streams,
            "folder": os.getcwd(),
            "environment": dict(os.environ),
        }
        given = [number for number in range(3) if streams[number]]
        socket.send_fds(server, [json.dumps(request).encode() + b"\n"], given)
        with server.makefile() as answers:
            child = int(answers.readline())

            def hand_on(number: int, frame: object) -> None:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(child, number)

            for number in handed_on:
                signal.signal(number, hand_on)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, handed_on)
            code = int(answers.readline())
    if code < 0:
        signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    os._exit(code)


main()
