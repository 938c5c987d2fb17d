"""Which code computed something that is kept: the version of tactsim, a hash of its source, and the versions of libraries."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from tactsim.version import __version__

ABSENT = "absent"
"""The version of a package that is not installed."""


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


def installed_version(package: str) -> str:
    """Version of a package, `ABSENT` if there is none; to ask for it reads a file."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ABSENT


def installed_versions(packages: Iterable[str]) -> dict[str, str]:
    """Versions of those of the packages that are installed, by name."""
    versions = {package: installed_version(package) for package in packages}
    return {package: number for package, number in versions.items() if number != ABSENT}
