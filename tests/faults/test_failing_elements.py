"""A mesh that is no whole body is refused with its cause, and a solution that fails names the element."""

from __future__ import annotations

from dataclasses import replace

import meshio
import numpy as np
import pytest

from tactsim.errors import ConvergenceError, InputError
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.equilibrium.diagnosis import collapsed_in_words
from tactsim.fem.equilibrium.newton import Problem
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.block_file import FileSource
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.structured_block import structured_block

SIZE = (40e-3, 40e-3, 20e-3)
LINE = [(0.0, 20e-3, 10e-3), (40e-3, 20e-3, 10e-3)]


def written(path, keep, inclusions=(), cells=(4, 8, 4)):
    """A file source with the tetrahedra whose centroids in mm ``keep`` accepts."""
    mesh = structured_block(SIZE, cells, inclusions).mesh
    corners = mesh.elements[:, :4]
    kept = keep(1e3 * mesh.nodes[corners].mean(axis=1))
    used, simplices = np.unique(corners[kept], return_inverse=True)
    cells = [("tetra", simplices.reshape(-1, 4))]
    meshio.Mesh(1e3 * mesh.nodes[used], cells, cell_data={"region": [mesh.regions[kept] + 5]}).write(path)
    regions = {"5": 0} | ({"6": 1} if inclusions else {})
    return FileSource(kind="file", path=str(path), unit="mm", regions=regions)


def everything(centres):
    return np.ones(len(centres), bool)


def test_a_mesh_in_pieces_is_refused_with_their_number(tmp_path):
    source = written(tmp_path / "cut.vtu", lambda c: (c[:, 0] < 10) | (c[:, 0] > 20))
    with pytest.raises(
        InputError, match=r"in 2 pieces that share no sides; the smallest has .* around \(5, .* allowed: one piece"
    ):
        source.sourced(SIZE, ())


@pytest.mark.parametrize(
    ("low", "high", "place"), [((10, 15, 5), (20, 25, 15), r"\(15, 20, 10\)"), ((10, 15, 15), (20, 25, 20), r"\(15, 20, 1")]
)
def test_a_hole_or_a_notch_is_refused_with_its_place(tmp_path, low, high, place):
    source = written(tmp_path / "hole.vtu", lambda c: ~((c > low) & (c < high)).all(axis=1))
    with pytest.raises(
        InputError, match=rf"boundary facets, around {place}.* has a hole or a notch there; allowed are the faces"
    ):
        source.sourced(SIZE, ())


def test_a_second_hole_beside_a_lumen_is_refused(tmp_path):
    tube = Tube.model_validate({"kind": "tube", "centre_line": LINE, "inner_radius": 4e-3, "wall": 3e-3})
    assert written(tmp_path / "tube.vtu", everything, [tube], (1, 8, 4)).sourced(SIZE, [tube]).block.facets["lumen:1"].size
    source = written(tmp_path / "two.vtu", lambda c: ~((c > (0, 0, 5)) & (c < (40, 5, 10))).all(axis=1), [tube], (8, 8, 4))
    with pytest.raises(InputError, match="the faces of the block and the lumen of a tube"):
        source.sourced(SIZE, [tube])


def test_a_whole_mesh_is_taken(tmp_path):
    assert len(written(tmp_path / "whole.vtu", everything).sourced(SIZE, ()).block.mesh.elements)


def test_a_pressure_that_asks_for_no_volume_hides_no_element_that_has_collapsed():
    mesh = structured_block(SIZE, (4, 1, 1)).mesh
    body = Body(TaylorHood(mesh.nodes, mesh.elements, "solid"), [NeoHookean(c10=1000.0, bulk_modulus=1e4)], mesh.regions)
    flat, state = np.zeros(body.space.size), body.kinematics(np.zeros(body.space.size))
    J = state.J.copy()
    J[7] = 0.1
    assert collapsed_in_words(body, replace(state, J=J), flat).startswith("element 7 at")
    asking = flat.copy()
    body.space.split(asking)[1][body.space.pressures[-1, 0]] = -1e6  # far from element 7
    assert body.pressure(asking).min() < -1e4
    assert collapsed_in_words(body, replace(state, J=J), asking).startswith("element 7 at")
    assert collapsed_in_words(body, state, asking) is None


class Breaking(NeoHookean):
    """Without stress where it is deformed."""

    kind: str = "breaking"  # type: ignore[assignment]

    def energy_gradient(self, I1, I2):
        first, second = super().energy_gradient(I1, I2)
        return np.where(I1 > 3 + 1e-6, np.nan, first), second


def stretched(material, stretch):
    mesh = structured_block(SIZE, (2, 2, 2)).mesh
    body = Body(TaylorHood(mesh.nodes, mesh.elements, "solid"), [material], mesh.regions)
    held = np.flatnonzero((mesh.nodes[:, 2] == 0) | (mesh.nodes[:, 2] == SIZE[2]))
    guess = np.zeros(body.space.size)
    body.space.split(guess)[0][mesh.nodes[:, 2] == SIZE[2], 2] = (stretch - 1) * SIZE[2]
    return Problem(body, np.concatenate([3 * held + axis for axis in range(3)])), guess


def test_a_force_that_is_no_number_names_the_element():
    problem, guess = stretched(Breaking(c10=1000.0), 1.1)
    with pytest.raises(ConvergenceError, match=r"the stress of element \d+ at \(.*, .*, .*\) mm in region 0 is no finite number"):
        problem.solve(guess)


def test_an_element_inside_out_is_named():
    problem, guess = stretched(NeoHookean(c10=1000.0), -0.5)
    words = r"inside out in the state that Newton starts from: element \d+ at \(.*\) mm in region 0, volume ratio -"
    with pytest.raises(ConvergenceError, match=words):
        problem.solve(guess)
