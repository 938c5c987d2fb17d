"""Which libraries and meshes a kept study was computed with, beside the code of tactsim itself."""

from __future__ import annotations

import hashlib
from functools import cache

from tactsim.code_identity import installed_version
from tactsim.mesh.manifest import MANIFEST
from tactsim.mesh.shipped import shipped_folders

SOLVER_LIBRARIES = ("numpy", "scipy", "scikit-fem", "pypardiso", "mkl", "numba", "pytetwild")
"""Packages whose version may change the last digits of a solution, or a mesh."""


@cache
def solver_identity() -> str:
    """Twelve hexadecimal digits over the versions of the solver's libraries and the list of shipped meshes with their hashes."""
    summed = hashlib.sha256("".join(f"{name}={installed_version(name)};" for name in SOLVER_LIBRARIES).encode())
    manifest = next((folder / MANIFEST for folder in shipped_folders() if (folder / MANIFEST).is_file()), None)
    if manifest is not None:
        summed.update(manifest.read_bytes())
    return summed.hexdigest()[:12]
