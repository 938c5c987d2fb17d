"""A package without the library that it binds is the installation's fault, not a defect of tactsim."""

from __future__ import annotations

import glob
import sys
from types import SimpleNamespace
from typing import NoReturn

import pytest

from tactsim.errors import InputError
from tactsim.fem.solvers import pardiso, pardiso_binding

REMEDY = r"mkl_rt.*pip install mkl, or set the environment variable PYPARDISO_MKL_RT"


def test_the_linear_solver_without_its_library_names_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(mtype: int) -> NoReturn:
        raise ImportError("Shared library mkl_rt not found.")

    monkeypatch.setitem(sys.modules, "pypardiso", SimpleNamespace(PyPardisoSolver=refused))
    monkeypatch.setattr(pardiso_binding, "_pardiso_binding", pardiso_binding._pardiso_binding.__wrapped__)
    with pytest.raises(InputError, match=REMEDY):
        pardiso.Pardiso()


def test_a_package_that_finds_no_library_while_it_is_imported_is_named_so_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pypardiso", None)  # an import of it raises ImportError
    monkeypatch.setattr(pardiso_binding, "_pardiso_binding", pardiso_binding._pardiso_binding.__wrapped__)
    with pytest.raises(InputError, match=REMEDY):
        pardiso.Pardiso()


def test_the_library_of_the_installed_package_is_named_without_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pypardiso")
    monkeypatch.delenv(pardiso_binding.LIBRARY_VARIABLE, raising=False)
    monkeypatch.setattr(glob, "glob", lambda *_, **__: pytest.fail("searched the disk"))
    monkeypatch.setattr(pardiso_binding, "_pardiso_binding", pardiso_binding._pardiso_binding.__wrapped__)
    pardiso.Pardiso()
