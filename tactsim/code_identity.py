"""Which code computed something that is kept: the version of tactsim and a hash of its source."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from tactsim.version import __version__


@cache
def code_identity() -> str:
    """Version and twelve hexadecimal digits over every source file of the package but figures, command line and validation."""
    root = Path(__file__).parent
    summed = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        place = path.relative_to(root).as_posix()
        if (
            not place.startswith(("plotting/", "cli/", "validation/"))
            and "figures" not in path.relative_to(root).with_suffix("").parts
        ):
            summed.update(place.encode() + b"\0" + path.read_bytes())
    return f"{__version__}+{summed.hexdigest()[:12]}"
