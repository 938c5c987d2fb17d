"""Inventories of outside documentation, kept as text, so that links to it need no network while the pages are built."""

from __future__ import annotations

import zlib
from pathlib import Path


def local_inventory(listed: Path, folder: Path) -> str:
    """Path of an ``objects.inv`` made of a text file; each line there is ``name domain:role priority place display``.

    The format is version 2 of Sphinx's inventories: a header of four lines, then the lines compressed by zlib.
    """
    lines = [line for line in listed.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    header = f"# Sphinx inventory version 2\n# Project: {listed.stem}\n# Version: \n# The remainder is compressed using zlib.\n"
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / f"{listed.stem}.inv"
    place.write_bytes(header.encode() + zlib.compress("".join(f"{line}\n" for line in lines).encode()))
    return str(place)
