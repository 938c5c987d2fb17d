"""The fast forward model of a stored plain grasp, computed once and kept."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tactsim.code_identity import code_identity
from tactsim.errors import StorageError
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.experiments.localization.source import computed_grasp
from tactsim.localization.lump_response import LumpResponse
from tactsim.outside.arrays import read_arrays
from tactsim.outside.files import opened
from tactsim.progress import elapsed_time
from tactsim.storage.files import replace_file
from tactsim.user_cache import user_cache


def stored_response(folder: str, *, cache: Path | None = None) -> LumpResponse:
    """Response of the tissue of a grasp whose result lies in a folder, its inclusions left out.

    Parameters
    ----------
    folder : of the result of a grasp
    cache : folder of responses computed before; by default the user's cache folder

    Raises
    ------
    StorageError
        If there is no result.
    InputError
        If the folder does not hold the case of a grasp.
    ConvergenceError
        If the plain tissue cannot be grasped.
    """
    from tactsim.experiments.localization.lump_sensitivity import lump_response

    setup = computed_grasp(folder).model_copy(update={"inclusions": ()})
    return kept_response(setup, lambda: lump_response(setup), cache=cache)


def kept_response(
    setup: GraspSetup, compute: Callable[[], LumpResponse], *, how: str = "", cache: Path | None = None
) -> LumpResponse:
    """The response of a grasp as it was kept, or else computed now; ``how`` distinguishes the methods."""
    identity = [setup.model_dump(mode="json", exclude={"mesh", "readout"}), code_identity(), *([how] if how else [])]
    place = (cache or user_cache("responses")) / f"{hashlib.sha256(json.dumps(identity).encode()).hexdigest()[:16]}.npz"
    stored = _read(place)
    if stored is None:
        with elapsed_time("response of the tissue to lumps"):
            stored = compute()
        _keep(stored, place)
    return stored


def _read(place: Path) -> LumpResponse | None:
    """What was kept, None if there is nothing usable."""
    try:
        file = read_arrays(opened(place, "kept file").read(), place.name)
        return LumpResponse((file["x"], file["y"], file["z"]), file["radii"], file["values"])
    except (StorageError, ValueError, LookupError):
        return None


def _keep(response: LumpResponse, place: Path) -> None:
    """Keep a response; a cache that cannot be written costs only time."""
    content = io.BytesIO()
    x, y, z = response.axes
    np.savez_compressed(content, x=x, y=y, z=z, radii=response.radii, values=response.values)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        replace_file(place, content.getvalue())
    except (OSError, StorageError):
        return
