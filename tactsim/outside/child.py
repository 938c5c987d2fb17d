"""How a child process begins: bounded, and bound to its parent, before anything else is imported. ``processes`` starts it.

Only the standard library is imported here; the parent names the folder from which tactsim itself is imported.
"""

import os
import runpy
import sys
import threading
import time

LOOK = 1.0
"""Seconds between looks at whether the parent still lives, where the system does not signal its end."""
DEATH_SIGNAL = 1
"""Linux: PR_SET_PDEATHSIG."""
KILL = 9


def bounded(memory: int) -> None:
    """Limits the memory that this process may write to, in bytes; 0 means no limit."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if memory:
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        most = memory if hard == resource.RLIM_INFINITY else min(memory, hard)
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def bound_to(parent: int) -> None:
    """Ends this process when its parent does."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(DEATH_SIGNAL, KILL, 0, 0, 0)
    if os.getppid() != parent:
        os._exit(1)
    threading.Thread(target=_look, args=(parent,), daemon=True).start()


def _look(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(LOOK)
    os._exit(1)


def main(root: str, memory: str, parent: str, module: str, *arguments: str) -> None:
    """Run a module of tactsim as the main program."""
    bounded(int(memory))
    bound_to(int(parent))
    sys.path.insert(0, root)
    sys.argv = [module, *arguments]
    runpy.run_module(module, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
