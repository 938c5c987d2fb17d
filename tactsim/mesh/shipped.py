"""Where the meshes and surfaces that come with the cases lie: in the folder one works in, else in this program's checkout."""

from __future__ import annotations

from pathlib import Path

FOLDER = "meshes"
CHECKOUT = Path(__file__).parents[2]


def shipped_folders() -> tuple[Path, ...]:
    """The folders of shipped meshes, in the order in which they are searched."""
    return Path(FOLDER), CHECKOUT / FOLDER


def shipped_path(path: str) -> Path:
    """The place of a file: as given, else in the checkout if ``path`` begins with the folder of shipped meshes and lies there."""
    given, kept = Path(path), CHECKOUT / path
    if not given.exists() and given.parts[:1] == (FOLDER,) and ".." not in given.parts and kept.is_file():
        return kept
    return given
