"""Where the meshes that come with the cases lie: in the folder one works in, else in this program's checkout."""

from __future__ import annotations

from pathlib import Path

from tactsim.outside.files import SHIPPED
from tactsim.shipped import PROGRAM


def shipped_folders() -> tuple[Path, ...]:
    """The folders of shipped meshes, in the order in which they are searched."""
    return Path(SHIPPED), PROGRAM / SHIPPED
