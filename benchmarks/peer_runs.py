"""The programs that squeeze the block, each run in a process of its own: what it measured, or why it measured nothing.

tactsim and FElupe must succeed. CalculiX, GetFEM and FEniCSx join where Debian's packages are installed:
``apt-get install --no-install-recommends calculix-ccx python3-getfem python3-dolfinx``. The last two live in the system's Python,
``/usr/bin/python3``, which needs no tactsim.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

PROGRAMS = Path(__file__).parent / "peer_programs"
sys.path.insert(0, str(PROGRAMS))

from block_problem import read  # noqa: E402  it stands in the folder that the line above makes known

Array = np.ndarray
Run = dict[str, Array]

FELUPE = ("felupe==11.3.0", "tensortrax==0.29.0", "pypardiso==0.4.7")
SYSTEM_PYTHON = "/usr/bin/python3"
MODULES = {"getfem": "getfem", "fenicsx": "dolfinx"}
"""Programs of the system's Python, and the module each needs there."""
OPTIONAL = ("calculix", *MODULES)
ABSENT = "not installed"
REASON_LENGTH = 160
"""Characters of an error message that fit into a table."""


class Failed(RuntimeError):
    """A program ended with an error, or without a result; the message ends with its own."""


def tactsim(place: Path, problem: Path) -> Run:
    """The mixed form."""
    return _run(place, "tactsim", [sys.executable, "tactsim_block.py", place / "warm_up.npz", problem])


def felupe(place: Path, problem: Path, python: Path, form: str) -> Run:
    """The ``displacement`` or the ``mixed`` form."""
    return _run(place, f"felupe_{form}", [python, "felupe_block.py", form, place / "warm_up.npz", problem])


def felupe_python(place: Path) -> Path:
    """An interpreter that has FElupe: this one, or one of an environment made in ``place``."""
    if all(importlib.util.find_spec(name) for name in ("felupe", "tensortrax", "pypardiso")):
        return Path(sys.executable)
    python = place / "felupe" / ("Scripts" if os.name == "nt" else "bin") / "python"
    if not python.exists():
        sys.stderr.write(f"installing {', '.join(FELUPE)} into {python.parents[1]}\n")
        subprocess.run([sys.executable, "-m", "venv", python.parents[1]], check=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *FELUPE], check=True)
    return python


def optional(place: Path, program: str, problem: Path, limit: float) -> Run | str:
    """What one of ``OPTIONAL`` measured in at most ``limit`` seconds, or a word on its absence, its halt or its failure."""
    if not _is_present(program):
        return ABSENT
    try:
        if program == "calculix":
            answer = _run(place, program, [sys.executable, "calculix_block.py", str(limit), problem])
        else:
            answer = _run(place, program, [SYSTEM_PYTHON, f"{program}_block.py", place / "warm_up.npz", problem], limit)
    except subprocess.TimeoutExpired:
        return _halt(limit)
    except Failed as error:
        sys.stderr.write(f"{error}\n")
        return f"failed: {_last_line(str(error))}"
    return _halt(limit) if "stopped_seconds" in answer else answer


def _is_present(program: str) -> bool:
    """Whether its command, or its module in the system's Python, is installed; that it also works is not said."""
    if program == "calculix":
        return shutil.which("ccx") is not None
    if not Path(SYSTEM_PYTHON).exists():
        return False
    look = f"import importlib.util, sys; sys.exit(importlib.util.find_spec({MODULES[program]!r}) is None)"
    return subprocess.run([SYSTEM_PYTHON, "-c", look], capture_output=True, check=False).returncode == 0


def _run(place: Path, name: str, command: Sequence[str | Path], limit: float | None = None) -> Run:
    """What a program wrote to its result file, the last of its arguments."""
    result = place / f"{name}.npz"
    result.unlink(missing_ok=True)
    done = subprocess.run([*command, result], cwd=PROGRAMS, capture_output=True, text=True, check=False, timeout=limit)
    if done.returncode:
        raise Failed(f"{name} ended with {done.returncode}: {done.stderr[-3000:].strip()}")
    if not result.exists():
        raise Failed(f"{name} wrote no result")
    return read(result)


def _halt(limit: float) -> str:
    return f"stopped after {limit:g} s"


def _last_line(text: str) -> str:
    return text.splitlines()[-1].strip()[:REASON_LENGTH]
