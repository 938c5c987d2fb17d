"""From a case to its file: quantities with their units, what was given and no other default, shipped materials by name."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from ruamel.yaml import YAML, RoundTripRepresenter
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from tactsim.case.model import SCHEMA, Case
from tactsim.errors import InputError, StorageError, shown
from tactsim.interfaces import Experiment, Material
from tactsim.materials.library import LIBRARY
from tactsim.outside.files import named_path
from tactsim.outside.text import one_line
from tactsim.storage.files import naming, write_bytes

HEADER = "# yaml-language-server: $schema=case.schema.json\n"
LONGEST_LINE = 100
LONGEST_TEXT = 4096
"""Characters of a single text, such as a title, that stay on one line."""
KEPT = ("kind", "control", "schema_version")
"""Fields that say what a mapping is, which are written whatever they are."""


def save_case(case: Case | Experiment, path: str | Path, *, force: bool = False) -> Path:
    """Writes a case file and returns its path; reading it gives a case of the same ``case_id``.

    >>> import tactsim as ts
    >>> press = ts.ClosedForm.example()
    >>> ts.load_case(ts.save_case(press, "press.yaml")).experiment == press
    True

    Parameters
    ----------
    case : a case, or an experiment, which becomes a case without a title
    path : the file
    force : whether a file that stands there may be replaced

    Raises
    ------
    InputError
        If it is neither, or the path is none.
    StorageError
        If the path is a folder, the file exists and ``force`` is not given, or it cannot be written.
    """
    if not isinstance(case, Case | Experiment):
        raise InputError(f"save_case: {shown(case)} is neither a case nor an experiment")
    place = named_path(path, "save_case")
    if place.is_dir():
        raise StorageError(f"{one_line(place)} is a folder; name the file to write in it")
    if place.exists() and not force:
        raise StorageError(f"{one_line(place)} exists; pass force=True to replace it")
    with naming(place):
        write_bytes(place, case_text(case).encode())
    return place


def case_text(case: Case | Experiment) -> str:
    """A case as the YAML text of a case file."""
    return yaml_text(case_document(case))


class _Writer(RoundTripRepresenter):
    """Writes null as such, not as nothing."""


_Writer.add_representer(type(None), lambda writer, _: writer.represent_scalar("tag:yaml.org,2002:null", "null"))


def yaml_text(value: Any) -> str:
    """Plain data as YAML: what holds no other list or mapping on one line if that is not too long, else a line for each entry."""
    text, yaml = io.StringIO(), YAML()
    yaml.Representer, yaml.width, yaml.default_flow_style = _Writer, LONGEST_TEXT, None
    yaml.dump(_lined(value), text)
    return text.getvalue()


def _lined(value: Any) -> Any:
    """Data whose lists and mappings that are too long for a line have a line for each entry."""
    if not isinstance(value, dict | list):
        return value
    entries = value.values() if isinstance(value, dict) else value
    nested = any(isinstance(entry, dict | list) for entry in entries)
    lined: Any = CommentedMap() if isinstance(value, dict) else CommentedSeq()
    if isinstance(value, dict):
        lined.update({key: _lined(entry) for key, entry in value.items()})
    else:
        lined.extend(map(_lined, value))
    if nested or len(str(value)) > LONGEST_LINE:
        lined.fa.set_block_style()
    return lined


def case_document(case: Case | Experiment, *, complete: bool = False) -> dict[str, Any]:
    """A case as the mapping that a case file holds, quantities as text with units.

    Parameters
    ----------
    case : a case, or an experiment, which becomes a case without a title
    complete : whether every default is written too, and the constants of shipped materials instead of their names
    """
    whole = case if isinstance(case, Case) else Case(schema=SCHEMA, experiment=case)
    dumped = whole.model_dump(mode="json", by_alias=True, context={"units": "written"})
    document: dict[str, Any] = dumped if complete else _without_defaults(whole, dumped)
    return document


def _without_defaults(value: Any, dumped: Any) -> Any:
    """What was dumped of a value, without the fields that nobody gave and that have their default; shipped materials by name.

    What was given stays though it equals the default: another version may have another default.
    """
    if isinstance(value, Material) and (name := _shipped_name(value)):
        return name
    if isinstance(value, BaseModel):
        kept = {}
        for name, field in type(value).model_fields.items():
            key, entry = field.serialization_alias or field.alias or name, getattr(value, name)
            given = name in KEPT or name in value.model_fields_set
            if given or entry != field.get_default(call_default_factory=True):
                kept[key] = _without_defaults(entry, dumped[key])
        return kept
    if isinstance(value, tuple | list):
        return [_without_defaults(item, part) for item, part in zip(value, dumped, strict=True)]
    if isinstance(value, dict):
        return {key: _without_defaults(item, dumped[str(key)]) for key, item in value.items()}
    return dumped


def _shipped_name(material: Material) -> str | None:
    return next((name for name in sorted(LIBRARY) if LIBRARY[name].material == material), None)
