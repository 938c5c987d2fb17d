"""``tactsim data``: checks, describes and exports a data set."""

from __future__ import annotations

import argparse
from pathlib import Path

from tactsim.cli import console
from tactsim.errors import ValidationError

NAME = "data"
SUMMARY = "check, describe or export a data set"
DESCRIPTION = """\
check reads every sample and finds damaged content (checksums), missing, doubled, constant and
not finite samples, and specimens that are in two splits; the exit code is 4 if it finds one.
info prints counts, splits and variables with their units. export writes the samples that are
done as one HDF5 file, or as a folder with an index (Parquet) and shards (npz).
"""
EXAMPLES = """\
examples:
  tactsim data check lumps.zarr
  tactsim data info lumps.zarr
  tactsim data export lumps.zarr --to lumps.h5
  tactsim data export lumps.zarr --to lumps_shards --split train
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("action", choices=("check", "info", "export"), help="what to do")
    parser.add_argument("store", metavar="STORE", type=Path, help="folder that tactsim sweep wrote")
    parser.add_argument("--to", metavar="PLACE", type=Path, help="export: file ending in .h5, or folder for Parquet and npz")
    parser.add_argument("--split", metavar="NAME", action="append", help="export: only this part; may be repeated")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command."""
    return {"check": _check, "info": _info, "export": _export}[arguments.action](arguments)


def _check(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.checking import check

    checked = check(arguments.store)
    for finding in checked.findings:
        console.out(str(finding))
    counts = ", ".join(f"{count} {name}" for name, count in checked.counts.items())
    verdict = f"{len(checked.findings)} findings" if checked.findings else "nothing found"
    console.out(f"{arguments.store}: {counts or 'not read'}; {verdict}")
    return ValidationError.exit_code if checked.findings else 0


def _info(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.description import description

    console.out(description(arguments.store))
    return 0


def _export(arguments: argparse.Namespace) -> int:
    from tactsim.dataset.export import exported
    from tactsim.errors import InputError

    if arguments.to is None:
        raise InputError("export: --to is missing; name a file ending in .h5, or a folder for Parquet and npz")
    count = exported(arguments.store, arguments.to, split=arguments.split)
    console.out(f"{count} samples in {arguments.to}")
    return 0
