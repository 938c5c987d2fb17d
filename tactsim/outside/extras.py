"""Packages that only some jobs need, and the command that installs each."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from tactsim.errors import InputError

EXTRAS = {
    "aiohttp": ("the live page", "web"),
    "zarr": ("data sets", "data"),
    "numcodecs": ("data sets", "data"),
    "dask": ("--scheduler", "cluster"),
    "distributed": ("--scheduler", "cluster"),
    "h5py": ("HDF5", "export"),
    "pyarrow": ("Parquet", "export"),
    "torch": ("TorchSamples", "torch"),
    "sklearn": ("training", "learned"),
    "pymoo": ("the genetic algorithm", "identification"),
}
"""Name of a module -> what needs it, and the extra of the distribution that brings it."""


def missing_extra(error: ImportError) -> InputError | None:
    """What to install, if an import failed for want of a package that only some jobs need; else None."""
    package = (error.name or "").partition(".")[0]
    if package not in EXTRAS:
        return None
    what, extra = EXTRAS[package]
    return InputError(f"the package {package}, needed for {what}, is not installed: pip install 'tactsim[{extra}]'")


@contextmanager
def extras_named() -> Iterator[None]:
    """A block of imports of packages that only some jobs need.

    Raises
    ------
    InputError
        If one of them is not installed, with the command that installs it.
    """
    try:
        yield
    except ImportError as error:
        raise missing_extra(error) or error from None
