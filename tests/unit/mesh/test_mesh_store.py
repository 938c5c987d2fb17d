"""Meshes are made once: the second call reads, a damaged entry is made again, two writers agree, shipped ones come first."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from lumps import ARTERY, LUMP, SIZE
from solids import assert_close

from tactsim.errors import InvalidQuantity, StorageError
from tactsim.mesh import mesh_store
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.manifest import MANIFEST, ManifestEntry, add_entry
from tactsim.mesh.mesh_store import cache_folder, content_hash, stored_block_mesh, write_block_mesh
from tactsim.mesh.structured_block import morphed_block
from tactsim.mesh.tetrahedra import mesh_key

SETTINGS = BlockMeshSettings(inclusion_size=4e-3)


made_block = cache(morphed_block)
"""The same mesh for the same arguments."""


class PretendedMesher:
    """Gives another mesh at every call, as the true one does."""

    def __init__(self):
        self.calls = 0

    def __call__(self, size, inclusions, settings):
        self.calls += 1
        block = made_block(size, inclusions[0], settings)
        facets = np.unique(np.concatenate([*block.facets.values()]))
        inner = np.setdiff1d(np.arange(block.mesh.corner_count), facets)
        nodes = block.mesh.nodes.copy()
        far = inner[np.abs(nodes[inner] - np.array(LUMP.center)).max(axis=1) > 6e-3]
        nodes[far[0]] += 1e-9 * self.calls
        return type(block)(**{**vars(block), "mesh": block.mesh.moved(nodes), "key": mesh_key(size, inclusions, settings)})


@pytest.fixture
def mesher(monkeypatch):
    """A mesher that counts."""
    pretended = PretendedMesher()
    monkeypatch.setattr(mesh_store, "block_mesh", pretended)
    return pretended


def stored(tmp_path, inclusion=LUMP, settings=SETTINGS):
    return stored_block_mesh(SIZE, [inclusion], settings, shipped=tmp_path / "meshes", cache=tmp_path / "cache")


def test_the_second_call_reads_the_same_mesh(mesher, tmp_path):
    first, second = stored(tmp_path), stored(tmp_path)
    assert (first.origin, second.origin, mesher.calls) == ("made", "cache", 1)
    assert first.content == second.content == content_hash(second.block.mesh)
    assert (first.block.mesh.nodes == second.block.mesh.nodes).all()
    assert (first.block.mesh.elements == second.block.mesh.elements).all()
    assert first.block.region_names == second.block.region_names
    for name, facets in first.block.facets.items():
        assert (facets == second.block.facets[name]).all()
    assert_close(second.block.quality.minimum, first.block.quality.minimum, 1e-6)  # the pretended mesher moves a node by 1e-9 m
    assert first.block.key == second.block.key


def test_a_kept_mesh_says_with_what_part_of_the_size_it_was_made(mesher, tmp_path):
    block = replace(stored(tmp_path).block, part=0.64)
    (place,) = (tmp_path / "cache").glob("*.npz")
    write_block_mesh(block, place)
    assert stored(tmp_path).block.part == 0.64
    with np.load(place) as file:
        arrays = {name: file[name] for name in file.files if name != "part"}
    np.savez(place, **arrays)  # as before it was written
    assert stored(tmp_path).block.part == 1.0


def test_another_geometry_or_setting_is_another_mesh(mesher, tmp_path):
    stored(tmp_path)
    stored(tmp_path, Sphere(center=(20e-3, 20e-3, 10.1e-3), radius=5e-3))
    stored(tmp_path, settings=SETTINGS.model_copy(update={"growth": 0.6}))
    assert mesher.calls == 3
    stored(tmp_path, settings=SETTINGS.model_copy(update={"time_limit": 5.0}))  # does not change the mesh
    assert mesher.calls == 3


@pytest.mark.parametrize("damage", ["cut", "empty", "text", "changed", "negative", "untimed"])
def test_a_damaged_entry_is_made_again(damage, mesher, tmp_path):
    first = stored(tmp_path)
    (place,) = (tmp_path / "cache").glob("*.npz")
    content = place.read_bytes()
    if damage in ("changed", "negative", "untimed"):
        with np.load(place) as file:
            arrays = {name: file[name] for name in file.files if (damage, name) != ("untimed", "seconds")}
        arrays["nodes"][3, 1] += 1e-12 if damage == "changed" else 0
        arrays["elements"][0, 0] = -7 if damage == "negative" else arrays["elements"][0, 0]
        np.savez(place, **arrays)
    else:
        place.write_bytes({"cut": content[: len(content) // 2], "empty": b"", "text": b"no mesh"}[damage])
    second, third = stored(tmp_path), stored(tmp_path)
    assert (second.origin, third.origin, mesher.calls) == ("made", "cache", 2)
    assert second.content == third.content != first.content


def test_writers_at_the_same_time_end_with_one_mesh(mesher, tmp_path):
    with ThreadPoolExecutor(4) as pool:
        meshes = list(pool.map(lambda _: stored(tmp_path), range(4)))
    assert len({one.content for one in meshes}) == 1
    assert stored(tmp_path).content == meshes[0].content
    assert [path.suffix for path in (tmp_path / "cache").iterdir()] == [".npz"]


def test_a_cache_that_cannot_be_written_costs_only_time(mesher, tmp_path):
    (tmp_path / "cache").write_text("a file is in the way")
    assert [stored(tmp_path).origin for _ in range(2)] == ["made", "made"]


def ship(folder, block, **changes):
    folder.mkdir(exist_ok=True)
    write_block_mesh(block, folder / "lump.npz")
    entry = {"name": "lump", "file": "lump.npz", "key": block.key, "content": content_hash(block.mesh)}
    add_entry(folder, ManifestEntry(**{**entry, "source": "made for a test: 'quoted'", "licence": "MIT", **changes}))


def test_a_shipped_mesh_comes_first_and_a_wrong_one_is_refused(mesher, tmp_path):
    folder, made = tmp_path / "meshes", stored(tmp_path)
    ship(folder, made.block, key="0" * 16)
    ship(folder, made.block)
    shipped = stored(tmp_path)
    assert (shipped.origin, shipped.content, mesher.calls) == ("shipped", made.content, 1)
    (folder / "lump.npz").write_bytes(b"damaged")
    with pytest.raises(StorageError, match=r"lump\.npz"):
        stored(tmp_path)
    (folder / MANIFEST).write_text("- name: [", encoding="utf-8")
    with pytest.raises(StorageError, match="manifest"):
        stored(tmp_path)


def test_a_shipped_mesh_that_is_not_the_recorded_one_is_refused(mesher, tmp_path):
    ship(tmp_path / "meshes", stored(tmp_path).block, content="0" * 32)
    with pytest.raises(StorageError, match="not the mesh"):
        stored(tmp_path)


def test_geometry_is_checked_before_anything_is_looked_up(mesher, tmp_path):
    with pytest.raises(InvalidQuantity, match=r"overlap|inside"):
        stored_block_mesh(SIZE, [LUMP, ARTERY], SETTINGS, cache=tmp_path)
    assert mesher.calls == 0


def test_the_cache_is_the_users(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "tactsim" / "meshes"


@pytest.mark.slow
def test_the_true_mesher_is_called_once(tmp_path):
    inclusions, folders = [ARTERY], {"shipped": tmp_path / "none", "cache": tmp_path}
    coarse = BlockMeshSettings(size=8e-3, inclusion_size=3e-3)
    first, second = (stored_block_mesh(SIZE, inclusions, coarse, **folders) for _ in range(2))
    assert (first.origin, second.origin) == ("made", "cache")
    assert first.content == second.content
    assert (first.block.facets["lumen:1"] == second.block.facets["lumen:1"]).all()
