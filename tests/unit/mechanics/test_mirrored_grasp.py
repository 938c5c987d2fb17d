"""A grasp that planes mirror: solved for a part, it is the grasp that is solved whole.

Mutants: the whole of a prescribed force on a part, contact points of another part, history of other elements, the whole not
looked at.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tactsim.contact.coulomb import Coulomb
from tactsim.contact.jaw import Jaw
from tactsim.contact.penalty import Augmentation
from tactsim.fem.assembly.body import RelaxationStep
from tactsim.fem.equilibrium.mirrored_problem import MirroredProblem, free_problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.block_model import START_PATIENCE, GraspModel
from tactsim.mechanics.models.first_guess import FIRST_PART
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.block import graded_block

pytestmark = pytest.mark.usefixtures("one_thread")
SIZE, CLOSING, TOLERANCE = (20e-3, 16e-3, 10e-3), 0.3e-3, 1e-7
TIGHT = 1e-8
"""Penetration in m with which either solution is far nearer to the exact one than what is asked of their difference."""
COARSE = BlockMeshSettings(size=8e-3, edge_size=3e-3, growth=1)
MATERIAL = NeoHookean(c10=1000.0, bulk_modulus=2e6)


def model(shift=0.0, width=40e-3, tilt=0.0):
    """A plain block between jaws, the upper one moved along x by ``shift`` and turned about y by ``tilt``."""
    block = graded_block(SIZE, (), COARSE)
    turned = {"upper": tilt, "lower": 0.0}
    jaws = [Jaw(width=width, depth=40e-3, fillet=1e-3, side=side, tilt_y=turned[side]) for side in JAWS]
    offsets = np.array([[SIZE[0] / 2 + shift, SIZE[1] / 2], [SIZE[0] / 2, SIZE[1] / 2]])
    return GraspModel(block.mesh, [MATERIAL], block.facets, jaws=jaws, offsets=offsets)


def solved_whole(one):
    """The same model with nothing mirrored."""
    one.problem = free_problem(one.body, NewtonOptions(start_patience=START_PATIENCE))
    return one


def grasped(one, closing=CLOSING, penetration=TOLERANCE, **action):
    start = one.start(Coulomb(friction=0.4), Augmentation(penetration, softest=4e3, switch_length=5e-3, softness=1e-5))
    half = one.equilibrium(start, closing / 2, one.compressed(FIRST_PART * closing / 2))
    return one.equilibrium(half, closing, half.unknowns, **action)


def assert_same(one, part, whole):
    """Up to what the penetration and the slip that are allowed leave open, by which the first half of the way differs, too."""
    assert part.load == pytest.approx(whole.load, abs=TOLERANCE)
    for mine, asked in zip(one.space.split(part.unknowns), one.space.split(whole.unknowns), strict=True):
        assert np.linalg.norm(mine - asked) < 3e-3 * np.linalg.norm(asked)
    for mine, asked in zip(part.contacts, whole.contacts, strict=True):
        total = asked.state.traction @ asked.surface.points.weights
        assert_allclose(mine.state.traction @ mine.surface.points.weights, total, rtol=0, atol=5e-4 * np.abs(total).max())


@pytest.mark.parametrize("force", [pytest.param(None, marks=pytest.mark.slow), 0.5])
def test_the_part_is_grasped_as_the_whole(force):
    mirrored = model()
    assert isinstance(mirrored.problem, MirroredProblem)
    solver = mirrored.problem.solver
    part, whole = (grasped(one, penetration=TIGHT, force=force) for one in (mirrored, solved_whole(model())))
    assert_same(mirrored, part, whole)
    assert mirrored.problem.solver is solver, "the whole was not solved"


def test_tissue_that_relaxes_is_mirrored_too():
    mirrored = model()
    shape = mirrored.body.points.weights.shape
    centre = mirrored.mesh.nodes[mirrored.mesh.elements].mean(axis=1)
    apart = np.abs(centre / SIZE - 0.5)
    stress = np.zeros((6, *shape))
    stress[0] = 200.0 * apart[:, :1]
    step = RelaxationStep(0.5 + apart[:, 2], stress)
    solver = mirrored.problem.solver
    assert_same(mirrored, grasped(mirrored, relaxation=step), grasped(solved_whole(model()), relaxation=step))
    assert mirrored.problem.solver is solver, "the whole was not solved"


@pytest.mark.parametrize(("tilt", "shift", "copies"), [(0.0, 0.0, 8), (0.0, 4e-3, 2), (0.02, 0.0, 2)])
def test_planes_mirror_the_jaws_too(tilt, shift, copies):
    assert model(shift=shift, width=16e-3, tilt=tilt).problem.copies == copies


@pytest.mark.slow
def test_a_jaw_aside_is_grasped_as_the_whole():
    """In a third of the step: so close to its edge Newton finds into longer ones with some orders of MKL's sums only, and with
    some errors of linear steps."""
    aside, whole = (model(shift=4e-3, width=16e-3) for _ in range(2))
    assert_same(aside, grasped(aside, CLOSING / 3), grasped(solved_whole(whole), CLOSING / 3))
    assert aside.problem.copies == 2, "the plane across y still mirrors it"
