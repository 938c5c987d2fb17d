"""A kept study counts only for the libraries and the meshes that it was computed with."""

from __future__ import annotations

import pytest

from tactsim.validation import solver_identity as module


@pytest.fixture
def identity(monkeypatch, tmp_path):
    """What the identity is with other versions of packages and another list of meshes."""

    def of(versions=(), manifest="{}"):
        (tmp_path / "manifest.json").write_text(manifest, encoding="utf-8")
        monkeypatch.setattr(module, "shipped_folders", lambda: (tmp_path,))
        monkeypatch.setattr(module, "installed_version", lambda package: dict(versions).get(package, "1.0"))
        return module.solver_identity.__wrapped__()

    return of


@pytest.mark.parametrize("package", module.SOLVER_LIBRARIES)
def test_another_version_is_another_identity(identity, package):
    assert identity() == identity() != identity({package: "2.0"})


def test_another_mesh_is_another_identity(identity):
    assert identity() != identity(manifest='{"meshes": []}')


def test_a_missing_package_is_absent():
    assert module.installed_version("no-such-package-anywhere") == "absent"
