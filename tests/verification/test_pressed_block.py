"""A block squeezed by a rigid plane: the exact homogeneous state without friction, the cone and balance with it; 2D and 3D.

Mutants: Cauchy for nominal pressure, swapped coefficients, no friction, the wrong sign of the base's force.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mutants import assert_kills
from solids import box, facets_where, held, on_plane

from tactsim.contact.coulomb import Coulomb
from tactsim.contact.penalty import Regularisation
from tactsim.contact.plane import Plane
from tactsim.contact.stick import Stick
from tactsim.contact.traction import ContactPair
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.newton import Problem
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.mechanics.contact.contact_steps import accepted
from tactsim.mechanics.contact.posed_contact import PosedContact

MATERIAL = MooneyRivlin2(c10=1.0, c01=0.25)
MEASURES = ("axisymmetric", "solid")


class Press:
    """A unit cylinder or cube on rollers (or glued) under a plane that comes down."""

    def __init__(self, measure, law, *, glued=False, cells=3, tolerance=1e-7):
        dim = 3 if measure == "solid" else 2
        mesh = box([1.0] * dim, [cells] * dim)
        self.space = TaylorHood(mesh.nodes, mesh.elements, measure)
        self.body = Body(self.space, [MATERIAL], mesh.regions)
        points = self.space.surface_points(facets_where(mesh, on_plane(dim - 1, 1.0)))
        self.surface = SurfaceAssembly(points, self.body.pattern, dim)
        sides = [held(mesh, axis, on_plane(axis, 0.0)) for axis in range(dim)]
        glue = [held(mesh, axis, on_plane(dim - 1, 0.0)) for axis in range(dim)] if glued else []
        self.base, self.problem = sides[-1], Problem(self.body, np.concatenate([*sides, *glue]))
        self.scale = Regularisation(tolerance=tolerance, softest=MATERIAL.shear_modulus, switch_length=0.1)
        place = np.zeros(dim)
        place[-1] = 1.0
        pair = self.scale.applied(ContactPair(Plane(), law))
        self.contact = PosedContact.apart(self.surface, points.interpolate(mesh.nodes), pair, place)
        self.unknowns = np.zeros(self.space.size)

    def to(self, height, steps=4):
        start = self.contact.place[-1]
        for level in np.linspace(start, height, steps + 1)[1:]:
            place = self.contact.place.copy()
            place[-1] = level
            moved = replace(self.contact, place=place, pair=self.scale.applied(self.contact.pair))
            solved = self.problem.solve(self.unknowns, interfaces=[moved])
            self.unknowns = solved.unknowns
            displacement = self.displacement
            self.state = moved.at(displacement)
            self.contact, self.scale = accepted(moved, displacement), self.scale.seen(self.state.pressure.max())
        return self

    @property
    def displacement(self):
        return self.surface.points.interpolate(self.space.split(self.unknowns)[0])

    def base_force(self):
        return self.body.residual(self.unknowns)[self.base].sum()


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("stretch", [0.7, *(pytest.param(stretch, marks=pytest.mark.slow) for stretch in (0.8, 0.9))])
def test_frictionless_block_reads_the_exact_pressure(measure, stretch, verification_record):
    press = Press(measure, Coulomb(friction=0.0), cells=2).to(stretch)
    nominal = 2 * (stretch**-2 - stretch) * (1 + 0.25 / stretch)

    def check(expected):
        np.testing.assert_allclose(
            press.state.pressure, expected, rtol=3e-6, err_msg="penetration 1e-7 of the height shifts the stretch"
        )

    check(nominal)
    known = {"reference": "uniaxial compression in closed form", "kind": "exact", "mesh": f"{measure}, 2 cells per side"}
    verification_record("contact pressure under a plane", press.state.pressure, nominal, tolerance=3e-6, **known)
    swapped = 2 * (stretch**-2 - stretch) * (0.25 + 1 / stretch)
    assert_kills(check, cauchy=(nominal * stretch,), swapped=(swapped,))
    assert -press.state.gap.min() <= 1e-7


@pytest.mark.parametrize(
    ("law", "measure"),
    [
        pytest.param(Coulomb(friction=0.3), "axisymmetric", id="coulomb-axisymmetric"),
        pytest.param(Stick(), "solid", id="stick-solid"),
        pytest.param(Coulomb(friction=0.3), "solid", id="coulomb-solid", marks=pytest.mark.slow),
        pytest.param(Stick(), "axisymmetric", id="stick-axisymmetric", marks=pytest.mark.slow),
    ],
)
def test_friction_stays_in_its_cone_and_forces_balance(measure, law, verification_record):
    press = Press(measure, law, glued=True, tolerance=1e-4).to(0.85)
    smooth = Press(measure, Coulomb(friction=0.0), glued=True, tolerance=1e-4).to(0.85)

    def check_cone(law):
        size = np.linalg.norm(press.state.tangential, axis=0)
        assert (size <= law.traction_limit(press.state.pressure) * (1 + 1e-8)).all()

    def check_balance(base_force):
        assert base_force == pytest.approx(-press.surface.total(press.state.traction)[-1], rel=1e-8)

    check_cone(law)
    check_balance(press.base_force())
    contact = -press.surface.total(press.state.traction)[-1]
    known = {"reference": "balance of contact and base", "kind": "invariance", "mesh": f"{measure}, 3 cells per side"}
    verification_record("forces under friction", press.base_force(), contact, tolerance=1e-8, **known)
    assert_kills(check_cone, frictionless=(Coulomb(friction=0.0),))
    assert_kills(check_balance, sign=(-press.base_force(),), frictionless=(smooth.base_force(),))
    assert press.surface.total(press.state.pressure[None])[0] > smooth.surface.total(smooth.state.pressure[None])[0]


@pytest.mark.parametrize("measure", MEASURES)
def test_unloading_returns_the_block(measure, verification_record):
    """Mutant: a plane that stays a ten-thousandth below the height of the block."""

    def check(height):
        press = Press(measure, Coulomb(friction=0.0), cells=2).to(0.9).to(height)
        assert press.state.pressure.max() == 0.0
        assert np.abs(press.displacement).max() < 1e-9
        return press.displacement

    left = check(1.0 + 1e-6)
    known = {"reference": "the block at rest", "kind": "exact", "mesh": f"{measure}, 2 cells per side", "tolerance": 1e-9}
    verification_record("displacement left after unloading, over the height", left, 0.0, scale=1.0, **known)
    assert_kills(check, low=(1.0 - 1e-4,))
