"""The mesher, which has no seed, gives the same mesh in every process where its random numbers can be fixed; a quick case stands
in `test_block_mesh.py`, beside the mesh that it repeats."""

from __future__ import annotations

import platform
import subprocess
import sys
from pathlib import Path

import pytest

from tactsim.outside import fixed_random_device
from tactsim.outside.fixed_random_device import fix_random_device

where_numbers_are_fixed = pytest.mark.skipif(
    not (sys.platform == "linux" and platform.machine() == "x86_64"),
    reason="random numbers of libraries are fixed on Linux with x86-64 processors alone",
)
PROGRAM = """
import hashlib
from pathlib import Path

import numpy as np
import pytetwild
from pytetwild import PyfTetWildWrapper
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.tetrahedra import input_surface
from tactsim.outside.fixed_random_device import fix_random_device

if {fix}:
    assert fix_random_device(Path(PyfTetWildWrapper.__file__))
surface = input_surface(np.ones(3), [], BlockMeshSettings())
nodes, cells = pytetwild.tetrahedralize(*surface, edge_length_abs=0.2, quiet=True)[:2]
print(hashlib.sha256(nodes.tobytes() + cells.tobytes()).hexdigest())
"""


@pytest.mark.slow
@where_numbers_are_fixed
@pytest.mark.parametrize(("fix", "meshes"), [(True, 1), (False, 4)])
def test_meshes_of_four_processes_are_alike_only_with_fixed_numbers(fix: bool, meshes: int, tmp_path: Path) -> None:
    programs = [[sys.executable, "-c", PROGRAM.format(fix=fix)] for _ in range(4)]
    answers = [subprocess.run(program, capture_output=True, check=True, cwd=tmp_path) for program in programs]  # it leaves a file
    assert len({answer.stdout for answer in answers}) == meshes


def test_a_library_that_is_not_loaded_or_draws_nothing_is_left_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "library.so").write_bytes(b"\x7fELF\x02\x01")
    assert not fix_random_device(tmp_path / "library.so")
    assert not fix_random_device(Path(sys.modules["_struct"].__file__ or sys.executable))


@pytest.mark.parametrize("other", [("darwin", "x86_64"), ("linux", "aarch64")])
def test_elsewhere_nothing_is_fixed(other: tuple[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fixed_random_device.sys, "platform", other[0])
    monkeypatch.setattr(fixed_random_device.platform, "machine", lambda: other[1])
    assert not fix_random_device(Path("none"))
