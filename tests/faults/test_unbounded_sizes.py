"""Sizes that would fill the memory or never end: refused with the estimate before anything is built."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from skfem import MeshTri

from tactsim.case import load_case
from tactsim.errors import InputError
from tactsim.experiments.grasp.model import grasp_mesh
from tactsim.fem.assembly.space import FACET_POINTS
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.mechanics.contact import surface_forces
from tactsim.mechanics.contact.surface_forces import taxel_forces
from tactsim.mesh.affordable import MOST_UNKNOWNS, estimated_unknowns, unknowns_of_cells
from tactsim.mesh.axisymmetric import section_mesh
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.sizing import at_jaw_edges
from tactsim.mesh.structured_block import structured_block
from tactsim.shipped import CASES


@pytest.mark.parametrize(
    ("name", "mesh", "message"),
    [
        ("grasp_plain", "{kind: structured, cells: [500, 500, 500]}", r"mesh\.cells \[500, 500, 500\]: about 3\.1e\+09 unknowns"),
        ("grasp_plain", "{kind: tetrahedra, size: 1 um}", r"mesh\.size.*: about .*e\+15 unknowns; allowed: up to 3e\+06"),
        ("grasp_plain", "{kind: tetrahedra, edge_size: 1 nm}", r"mesh\.size.* unknowns; allowed: up to 3e\+06"),
        ("grasp_artery_icf", "{kind: tetrahedra, inclusion_size: 1 um}", r"mesh\.size.* unknowns; allowed: up to 3e\+06"),
        ("grasp_plain", "{kind: graded, size: 1 um}", r"mesh\.size.* cells along a side or more; allowed: up to 1000"),
        ("grasp_plain", "{kind: graded, size: 0.1 mm}", r"mesh\.size.* unknowns; allowed: up to 3e\+06"),
        (
            "grasp_lump_icf",
            "{kind: graded, edge_size: 1 nm, growth: 1e-9}",
            r"mesh\.size, mesh\.edge_size .* allowed: up to 1000",
        ),
        ("grasp_lump_icf", "{kind: graded, inclusion_size: 1e-300 m}", r"mesh\.inclusion_size 1e-300 m: .* allowed: up to 1000"),
        ("grasp_lump_icf", "{kind: layers, inclusion_size: 1 um}", r"mesh\.inclusion_size 1e-06 m: .* allowed: up to 1000"),
        ("grasp_lump_icf", "{kind: layers, inclusion_size: 0.1 mm}", r"mesh\.inclusion_size, .* unknowns; allowed: up to 3e\+06"),
        ("grasp_lump_icf", "{kind: layers, size: 1 um}", r"mesh\.size 1e-06 m .* allowed: up to 1000"),
    ],
)
def test_meshes_too_large_are_refused_before_they_are_built(name: str, mesh: str, message: str):
    experiment = load_case(CASES / f"{name}.yaml", [f"experiment.mesh={mesh}"]).experiment
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match=message):
            grasp_mesh(experiment)
        assert tracemalloc.get_traced_memory()[1] < 8 * MOST_UNKNOWNS, "less than the nodes of the smallest mesh that is refused"
    finally:
        tracemalloc.stop()


def test_sectors_of_a_fine_section_are_counted_before_they_are_swept():
    case = load_case(CASES / "annulus_icf_3d.yaml", ["experiment.mesh={finest: 10 um, growth: 0.3, sectors: 90}"])
    with pytest.raises(InputError, match=r"mesh\.sectors: about .* unknowns; allowed: up to 3e\+06"):
        case.experiment.model()


@pytest.mark.parametrize("mesh", ["{finest: 1 nm}", "{finest: 10 nm, growth: 0.05}", "{refinement: 1e5}"])
def test_sections_too_fine_are_refused_before_they_are_built(mesh: str, monkeypatch: pytest.MonkeyPatch):
    case = load_case(CASES / "annulus_icf.yaml", [f"experiment.mesh={mesh}"])
    refined, counts = MeshTri.refined, []

    def counted(self: MeshTri, *arguments: object) -> MeshTri:
        made = refined(self, *arguments)
        counts.append(made.nelements)
        return made

    monkeypatch.setattr(MeshTri, "refined", counted)
    with pytest.raises(
        InputError, match=r"^mesh\.finest, .* and mesh\.refinement: more than 500000 elements; allowed: up to that"
    ):
        case.experiment.model()
    assert max(counts, default=0) < 20_000


def test_a_section_far_wider_than_thick_is_refused():
    with pytest.raises(InputError, match=r"a radius of 1 m over a thickness of 1e-07 m needs .* elements; allowed"):
        section_mesh(1.0, [0.0, -1e-7], lambda points: np.full(len(points), 1e-3))


def test_the_estimates_are_right():
    """That of cells exactly, that of tetrahedra within a half of the shipped block's 40 000 (``BlockMeshSettings``)."""
    block = structured_block((1.0, 1.0, 0.5), (4, 3, 2))
    assert unknowns_of_cells((4, 3, 2)) == block.unknowns
    settings = BlockMeshSettings()
    estimate = estimated_unknowns(np.array([40e-3, 40e-3, 20e-3]), (), settings, at_jaw_edges(settings))
    assert estimate == pytest.approx(40_000, rel=0.5)
    assert estimate < MOST_UNKNOWNS / 10


def facets(count: int, side: float) -> np.ndarray:
    """Slightly curved quadratic facets (F, 6, 2) of a square."""
    line, generator = np.linspace(-side / 2, side / 2, count + 1), np.random.default_rng(1)
    places = []
    for i in range(count):
        for j in range(count):
            a, b, c, d = (np.array([line[i + m], line[j + n]]) for m, n in ((0, 0), (1, 0), (1, 1), (0, 1)))
            places += [[*t, (t[0] + t[1]) / 2, (t[1] + t[2]) / 2, (t[0] + t[2]) / 2] for t in ((a, b, c), (a, c, d))]
    made = np.array(places)
    made[:, 3:] += generator.normal(size=made[:, 3:].shape) * 0.02 * side / count
    return made


def test_many_taxels_take_few_rounds_of_cuts_and_add_up(monkeypatch: pytest.MonkeyPatch):
    """One border after the other, 100 x 100 taxels took 41 s on 392 facets; those without gaps add up to the few taxels that
    cover the same squares."""
    places, layout = facets(14, 40e-3), TaxelLayout(rows=99, columns=99, pitch=0.3e-3, size=0.3e-3)
    forces = np.random.default_rng(2).normal(size=(3, len(places), 6)) + 3
    rounds, halved = [], surface_forces._halved
    with monkeypatch.context() as patch:
        patch.setattr(surface_forces, "_halved", lambda *arguments: rounds.append(1) or halved(*arguments))
        many = taxel_forces(layout, places, forces, FACET_POINTS)
    at_once = surface_forces.FACETS_AND_TAXELS_AT_ONCE * len(places) // (len(places) + 99**2)
    cuts = 2 * -(-len(places) // at_once)  # along two axes, of some facets at a time
    pieces, borders = surface_forces.straight_pieces(places)[0][:, :, :2], np.unique(layout.borders("x"))  # as along y
    ends = (pieces.min(axis=1), "right"), (pieces.max(axis=1), "left")
    first, beyond = (np.searchsorted(borders, end, side=side) for end, side in ends)
    crossed = (beyond - first).max()
    # A cut at the middle border leaves half of those that a piece crossed; the last round finds that nothing crosses any.
    assert cuts < len(rounds) <= cuts * (int(np.log2(crossed)) + 2)
    few = taxel_forces(TaxelLayout(rows=3, columns=3, pitch=9.9e-3, size=9.9e-3), places, forces, FACET_POINTS)
    added = many.taxels.reshape(3, 3, 33, 3, 33).sum(axis=(2, 4))
    np.testing.assert_allclose(added, few.taxels, rtol=0, atol=1e-12 * np.abs(few.taxels).max())  # round-off
    np.testing.assert_allclose(many.total, forces.sum(axis=(1, 2)), rtol=1e-12)
