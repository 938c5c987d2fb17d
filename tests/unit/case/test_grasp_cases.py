"""The shipped grasps: each loads anywhere, has its mesh in ``meshes/``, and converges."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest

from tactsim.case import load_case
from tactsim.errors import CaseError
from tactsim.experiments.grasp.model import grasp_mesh
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.models.block_source import TetrahedraSource
from tactsim.mesh.inclusions.surface import read_surface
from tactsim.mesh.inclusions.triangulated import check_closed
from tactsim.mesh.manifest import entries

ROOT = Path(__file__).parents[3]
CASES = sorted((ROOT / "cases").glob("grasp_*.yaml"))
by_name = pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
MOST_UNKNOWNS = 80_000
"""A solve of more takes over a quarter of an hour on two cores."""


def test_the_figures_of_section_6_have_their_cases():
    assert {path.stem.removeprefix("grasp_") for path in CASES} >= {
        *("lump_icf", "artery_b1a", "artery_icf", "artery_pulse", "artery_pressure", "artery_partial"),
        *("two_lumps", "two_arteries", "stl", "narrow_jaws", "hold", "force"),
    }


ALIKE = ("artery_b1a", "artery_pulse", "artery_pressure", "artery_partial", "two_arteries")
"""Cases whose cells are made as those of grasp_artery_icf."""


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=pytest.mark.slow if path.stem.removeprefix("grasp_") in ALIKE else ()) for path in CASES],
    ids=lambda path: path.stem,
)
def test_the_mesh_is_shipped_or_repeats(path, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)  # from any folder
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    experiment = load_case(path).experiment
    sourced = grasp_mesh(experiment)
    if not isinstance(experiment.source, TetrahedraSource):
        assert grasp_mesh(experiment).content == sourced.content
        return
    assert sourced.origin == "shipped"
    (entry,) = (entry for entry in entries(ROOT / "meshes") if entry.key == sourced.block.key)
    assert entry.content == sourced.content
    assert entry.source
    assert entry.licence == "MIT"
    assert sourced.block.unknowns < MOST_UNKNOWNS


def test_every_shipped_mesh_is_in_the_manifest():
    listed = [entry.file for entry in entries(ROOT / "meshes")]
    assert sorted(listed) == sorted(path.name for path in (ROOT / "meshes").glob("*.npz"))


def test_the_irregular_lump_is_closed_and_listed(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    vertices, triangles = read_surface("meshes/lump.stl")
    check_closed(triangles, len(vertices), "lump.stl")
    assert 500 <= len(triangles) <= 1500
    assert np.ptp(np.linalg.norm(vertices, axis=1)) > 0.5  # mm: it is no ball
    digest = hashlib.sha256((ROOT / "meshes" / "lump.stl").read_bytes()).hexdigest()
    assert digest in (ROOT / "meshes" / "README.md").read_text(encoding="utf-8")


@pytest.mark.slow
@by_name
def test_the_case_converges(path):
    case = load_case(path)
    result = case.experiment.run()
    assert result.status == "converged", result.reason
    found = {name: quantity.value for name, quantity in result.quantities.items()}
    assert found["max_penetration"] <= case.experiment.tolerance
    assert found["unstable_volume_fraction"] == 0
    net = np.add(found["jaw_force_upper"], found["jaw_force_lower"])
    largest = max(abs(found[f"jaw_force_{side}"][2]) for side in JAWS)
    assert abs(net[2]) <= 2e-3 * largest  # the weak hold, and the lean of an open end under pressure, take the rest
    if "lumen_pressure" not in found:  # the pressure on one closed end of an artery pushes the block sideways
        assert np.abs(net).max() <= 1e-4 * largest


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        (
            "center: [20 mm, 20 mm, 10 mm]",
            "center: [38 mm, 20 mm, 10 mm]",
            ":7: experiment.inclusions.0.shape: sphere 1",
        ),
        ("to: 1 mm", "to: 11 mm", ":9: experiment.loading: each jaw closes by 11 mm; allowed"),
        ("pitch: 10 mm", "pitch: 30 mm", ":8: experiment.matrix: 69 mm wide"),
        ("tissue: icf_stable", "tissue: icf_staple", ":5: experiment.block.tissue: unknown material"),
        ("control: displacement, ", "", ":9: experiment.loading.control: missing; choices: displacement, force"),
    ],
)
def test_what_a_whole_grasp_refuses_is_told_with_the_line_of_the_key(tmp_path, old, new, place):
    text = (
        "schema: tactsim/case/1\ntitle: x\nexperiment:\n  kind: grasp\n"
        "  block: {size: [40 mm, 40 mm, 20 mm], tissue: icf_stable}\n  inclusions:\n"
        "    - {shape: {kind: sphere, center: [20 mm, 20 mm, 10 mm], radius: 4 mm}, material: lump}\n"
        "  matrix: {rows: 3, columns: 3, pitch: 10 mm, size: 9 mm}\n"
        "  loading: {control: displacement, pieces: [{kind: ramp, to: 1 mm, duration: 1 s}]}\n"
    )
    file = tmp_path / "case.yaml"
    file.write_text(text)
    load_case(file)
    file.write_text(text.replace(old, new))
    with pytest.raises(CaseError) as refused:
        load_case(file)
    assert str(refused.value).startswith(f"{file}{place}")


NEW_GRASP = """\
schema: tactsim/case/1
title: A grasp
experiment:
  kind: grasp
  block: {tissue: icf_stable, size: [30 mm, 24 mm, 12 mm]}
  loading: {pieces: [{kind: ramp, to: 1 mm, duration: 1 s}], control: displacement}
  lower: {width: 25 mm, fillet: 1 mm, offset: [0 mm, 0 mm]}
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (", control: displacement", "", "6: experiment.loading.control: missing; choices: displacement, force"),
        (
            "control: displacement",
            "control: forces",
            r"6: .*control: unknown control 'forces' \(did you mean 'force'\?\); choices: ",
        ),
        ("width: 25 mm", "width: 10 um", "7: experiment.lower.fillet: 1 mm is too large; allowed: .*, 5 µm"),
        ("[0 mm, 0 mm]", "[40 mm, 0 mm]", "7: experiment.lower.offset: at 40 mm the jaw passes beside the block; allowed: less"),
    ],
)
def test_a_refused_grasp_names_the_key_and_what_is_allowed(tmp_path, old, new, message):
    path = tmp_path / "grasp.yaml"
    path.write_text(NEW_GRASP.replace(old, new), encoding="utf-8")
    with pytest.raises(CaseError, match=f"grasp.yaml:{message}"):
        load_case(path)
