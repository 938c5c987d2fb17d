"""A package without the library that it binds is the installation's fault, not a defect of tactsim."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import NoReturn

import pytest

from tactsim.errors import InputError
from tactsim.fem import pardiso


def test_the_linear_solver_without_its_library_names_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(mtype: int) -> NoReturn:
        raise ImportError("Shared library mkl_rt not found.")

    monkeypatch.setitem(sys.modules, "pypardiso", SimpleNamespace(PyPardisoSolver=refused))
    monkeypatch.setattr(pardiso, "_pardiso_binding", pardiso._pardiso_binding.__wrapped__)
    with pytest.raises(InputError, match=r"mkl_rt.*pip install mkl, or set the environment variable PYPARDISO_MKL_RT"):
        pardiso.Pardiso()
