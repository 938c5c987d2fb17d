"""What a result rests on: versions, the resolved case, the kind of machine; no names of users, hosts or folders."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from tactsim.code_identity import code_identity, installed_versions
from tactsim.errors import StorageError
from tactsim.outside.files import opened
from tactsim.outside.json_text import read_json
from tactsim.outside.text import one_line
from tactsim.version import __version__

PROVENANCE_FILE = "provenance.json"
PACKAGES = ("numpy", "scipy", "scikit-fem", "meshio", "numba", "pypardiso", "pydantic", "ruamel.yaml", "pint")


def provenance(
    case: Mapping[str, Any],
    case_id: str,
    *,
    case_file: str = "",
    overrides: Sequence[str] = (),
    seeds: Mapping[str, int] | None = None,
) -> dict[str, Any]:
    """The content of ``provenance.json`` for a resolved case and its ``seeds`` by key path, with only the name of ``case_file``.

    ``code`` is the version of tactsim and a hash of its source: a result can be compared with one of the same code only.
    """
    return {
        "case_id": case_id,
        "case_file": _without_folders(case_file),
        "overrides": [_without_folders(override) for override in overrides],
        "seeds": dict(seeds or {}),
        "code": code_identity(),
        "versions": {"tactsim": __version__, "python": platform.python_version(), **_package_versions()},
        "platform": {"system": platform.system(), "machine": platform.machine()},
        "case": _without_folders(dict(case)),
    }


def read_provenance(path: Path) -> dict[str, Any]:
    """The content of such a file.

    Raises
    ------
    StorageError
        If it is missing or damaged.
    """
    content = read_json(opened(path, "result").text(), str(path))
    if not isinstance(content, dict):
        raise StorageError(f"{one_line(path)} is damaged: it is not a mapping")
    case = content.get("case", {})
    if not isinstance(case, dict) or not isinstance(case.get("experiment", {}), dict):
        raise StorageError(f"{one_line(path)} is damaged: it holds no case")
    return content


@cache
def _package_versions() -> dict[str, str]:
    return installed_versions(PACKAGES)


def _without_folders(value: Any) -> Any:
    """``value`` with every absolute path in it cut to its last name."""
    if isinstance(value, dict):
        return {key: _without_folders(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_without_folders(item) for item in value]
    if isinstance(value, str):
        key, equals, text = value.rpartition("=")
        for flavour in (PurePosixPath, PureWindowsPath):
            if flavour(text).is_absolute():
                return f"{key}{equals}{flavour(text).name}"
    return value
