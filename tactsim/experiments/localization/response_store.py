"""The fast forward model of a stored plain grasp, computed once and kept."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from tactsim.code_identity import code_identity
from tactsim.errors import InputError, StorageError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.localization.lump_response import LumpResponse
from tactsim.outside.arrays import read_arrays
from tactsim.outside.files import opened
from tactsim.progress import elapsed_time
from tactsim.results.reading import read_result
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

    setup = _plain(read_result(folder, fields=False).provenance, folder)
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


def _plain(provenance: dict[str, Any], folder: str) -> Grasp:
    """The grasp that a result was computed from, without inclusions."""
    experiment = (provenance.get("case") or {}).get("experiment") or {}
    if experiment.get("kind") != "grasp":
        raise InputError(f"{folder} does not hold the case of a grasp; give the folder that `tactsim run` wrote for a grasp")
    try:
        return Grasp.model_validate(experiment).model_copy(update={"inclusions": ()})
    except ValidationError as error:
        raise InputError(f"the case in {folder} is not one of this version of tactsim: {error.errors()[0]['msg']}") from None


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
