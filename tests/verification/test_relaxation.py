"""Finite-strain relaxation against exact histories: homogeneous, in contact with friction, under a force; error in time.

Mutants: another time constant, swapped coefficients, a missing branch, a step in place of a ramp, a Poisson's ratio of 0.49, and
the inverse of the relaxation modulus for the creep compliance.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mutants import assert_kills
from scipy.integrate import quad
from solids import box, facets_where, held, on_plane

from tactsim.analytic.histories import ramp, step
from tactsim.analytic.interconversion import kelvin_of
from tactsim.analytic.response import response
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.penalty import Regularisation
from tactsim.contact.plane import Plane
from tactsim.contact.stick import Stick
from tactsim.contact.traction import ContactPair
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.history_variables import HistoryVariables, elastic_stress, series_of, step_error
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.equilibrium.prescribed_force import PrescribedForce
from tactsim.fem.paths.time_steps import TimeControl, TimeMarcher
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.mechanics.contact.contact_steps import accepted
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.relaxation import Relaxation

pytestmark = pytest.mark.usefixtures("one_thread")
MEASURES = ("axisymmetric", "solid")
ONE_TIME = Relaxation(fractions=(0.4,), times=(5.0,))
THREE_TIMES = Relaxation(fractions=(0.3, 0.2, 0.1), times=(0.01, 1.0, 20.0))
RUBBER = MooneyRivlin2(c10=1.0, c01=0.25, relaxation=ONE_TIME)
NOMINAL = {
    # stretch: nominal stress at once, after 5 s, and in the end, for c10 = 1, c01 = 0.25, g1 = 0.4, tau = 5 s
    0.8: (-2.001562, -1.495471, -1.200937),
    1.2: (1.221759, 0.912840, 0.733056),
}

PATIENT = NewtonOptions(max_iterations=80, patience=25)
"""One solution with friction at a tight penetration tolerance; grasps augment a softer contact instead."""


class Block:
    """A unit cylinder or cube; its top moved as prescribed, or pressed by a plane."""

    def __init__(self, measure, material, *, law=None, cells=1, glued=False, tolerance=1e-7):
        self.dim = dim = 3 if measure == "solid" else 2
        mesh = box([1.0] * dim, [cells] * dim)
        self.space = TaylorHood(mesh.nodes, mesh.elements, measure)
        self.body = Body(self.space, [material], mesh.regions)
        points = self.space.surface_points(facets_where(mesh, on_plane(dim - 1, 1.0)))
        self.surface = SurfaceAssembly(points, self.body.pattern, dim)
        sides = [held(mesh, axis, on_plane(axis, 0.0)) for axis in range(dim)]
        base = [held(mesh, axis, on_plane(dim - 1, 0.0)) for axis in range(dim)] if glued else []
        self.top = held(mesh, dim - 1, on_plane(dim - 1, 1.0))
        fixed = np.concatenate([*sides, *base, *([self.top] if law is None else [])])
        self.problem = Problem(self.body, fixed, options=PATIENT)
        self.variables = HistoryVariables.at_rest(self.body, series_of(self.body))
        self.unknowns, self.place = np.zeros(self.space.size), np.eye(dim)[-1]
        self.scale = Regularisation(tolerance=tolerance, softest=material.shear_modulus, switch_length=0.1)
        if law is not None:
            pair = self.scale.applied(ContactPair(Plane(), law))
            self.contact = PosedContact.apart(self.surface, points.interpolate(mesh.nodes), pair, self.place)

    def moved(self, stretch, time_step):
        """Nominal stress in Pa after the top has moved within a step."""
        guess, relaxation = self.unknowns.copy(), self.variables.relaxation_step(time_step)
        guess[self.top] = stretch - 1
        solved = self.problem.solve(guess, relaxation=relaxation)
        self._accept(solved, time_step)
        force = self.body.with_relaxation(relaxation).residual(self.unknowns)[self.top].sum()
        return force / self.surface.points.weights.sum()

    def pressed(self, time_step, *, height=None, force=None):
        """Force in N on the plane at a height, or its height under a force, after a step."""
        load_control = None if force is None else PrescribedForce((-np.eye(self.dim)[-1],), force)
        if height is not None:
            self.place = height * np.eye(self.dim)[-1]
        contact = replace(self.contact, place=self.place, pair=self.scale.applied(self.contact.pair))
        rigid_displacement = 0.0 if force is None else 1e-8
        relaxation = self.variables.relaxation_step(time_step)
        solved = self.problem.solve(
            self.unknowns,
            interfaces=[contact],
            load_control=load_control,
            rigid_displacement=rigid_displacement,
            relaxation=relaxation,
        )
        self.place = self.place - solved.rigid_displacement * np.eye(self.dim)[-1]
        self._accept(solved, time_step)
        displacement = self.surface.points.interpolate(self.space.split(self.unknowns)[0])
        moved = replace(contact, place=self.place)
        self.contact, self.scale = accepted(moved, displacement), self.scale.seen(moved.at(displacement).pressure.max())
        return -self.surface.total(moved.at(displacement).traction)[-1] if force is None else self.place[-1]

    def _accept(self, solved, time_step):
        self.unknowns = solved.unknowns
        self.variables = self.variables.advanced(elastic_stress(self.body, solved.kinematics), time_step)


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("stretch", sorted(NOMINAL))
def test_a_held_stretch_relaxes_as_printed(measure, stretch, verification_record):
    def check(material):
        block = Block(measure, material)
        for part in (0.5, 1.0):
            at_once = block.moved(1 + part * (stretch - 1), 0.0)
        computed = (at_once, block.moved(stretch, 5.0), block.moved(stretch, 1e3))
        assert computed == pytest.approx(NOMINAL[stretch], abs=6e-7), "six decimals are printed"
        return computed

    known = {"reference": "uniaxial closed form times its relaxation", "kind": "exact", "mesh": f"{measure}, one cell"}
    verification_record("held stretch, nominal stress", check(RUBBER), NOMINAL[stretch], tolerance=6e-7, **known)
    assert_kills(
        check,
        time=(RUBBER.model_copy(update={"relaxation": Relaxation(fractions=(0.4,), times=(5.01,))}),),
        swapped=(RUBBER.model_copy(update={"c10": RUBBER.c01, "c01": RUBBER.c10}),),
    )


def elastic_parts(stretch):
    """Isochoric second Piola-Kirchhoff stress along and across a uniaxial incompressible stretch, c10 = 1, c01 = 0.25."""
    along, across = stretch, stretch**-0.5
    first, second = (along**2 + 2 * across**2, 2 * along**2 * across**2 + across**4)
    parts = []
    for value in (along, across):
        W1 = 2 * (1 - first / 3 / value**2)
        W2 = 0.25 * (2 * (first - value**2) - 4 / 3 * second / value**2)
        parts.append(W1 + W2)
    return np.array(parts)


def exact_nominal(stretch_of, time, tau=5.0):
    """Nominal stress of RUBBER in uniaxial stress under a stretch history, by quadrature of its memory."""

    def rate(s, part):
        h = 1e-5
        ahead, behind = elastic_parts(stretch_of(s + h)), elastic_parts(stretch_of(s - h))
        return (0.6 + 0.4 * np.exp(-(time - s) / tau)) * (ahead[part] - behind[part]) / (2 * h)

    along, across = (quad(rate, 0, time, args=(part,), epsabs=1e-11, epsrel=1e-11)[0] for part in (0, 1))
    stretch = stretch_of(time)
    return stretch * along - across / stretch**2


def shortened(s):
    """A stretch from 1 at t = 0 to 0.7 at 4 s, smooth."""
    return 1 - 0.3 * np.sin(np.pi / 8 * s) ** 2


def march(tolerance):
    """Nominal stress at 4 s, and the number of steps."""
    block = Block("axisymmetric", RUBBER)
    states = {0.0: (block.unknowns, block.variables, 0.0)}

    class State:
        iterations = 3

        def __init__(self, time):
            self.time, self.unknowns = time, states[time][0]

    def advance(now, time, guess):
        block.unknowns, block.variables, _ = states[now.time]
        stress = block.moved(shortened(time), time - now.time)
        states[time] = (block.unknowns, block.variables, stress)
        return State(time)

    def error(now, state):
        return step_error(block.body, states[state.time][1])

    marcher = TimeMarcher(advance, error, TimeControl(tolerance, first=1e-3, smallest=1e-9))
    times = [state.time for state, _ in marcher.march(State(0.0), [4.0], largest=4.0)]
    return states[4.0][2], len(times)


def test_the_error_in_time_follows_its_tolerance(verification_record):
    tolerances = 1e-3 / 2.0 ** np.arange(5)
    stresses, steps = np.array([march(tolerance) for tolerance in tolerances]).T

    def check(exact):
        errors = np.abs(stresses / exact - 1)
        assert (errors < tolerances).all()
        slope = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
        assert slope == pytest.approx(1.0, abs=0.1), "halving the tolerance halves the error"

    exact = exact_nominal(shortened, 4.0)
    check(exact)
    known = {"reference": "quadrature of the hereditary integral", "kind": "convergence", "mesh": "axisymmetric, five tolerances"}
    order = float(np.polyfit(np.log(tolerances), np.log(np.abs(stresses / exact - 1)), 1)[0])
    verification_record("error in time over its tolerance", order=order, theory=1.0, tolerance=0.1, **known)
    assert_kills(check, time=(exact_nominal(shortened, 4.0, tau=5.01),))
    assert steps.max() < 60


@pytest.mark.parametrize("measure", MEASURES)
def test_small_strain_follows_linear_viscoelasticity(measure, verification_record):
    material = LinearElastic(youngs_modulus=3000.0, poisson_ratio=0.5, relaxation=THREE_TIMES)
    times, rate = np.cumsum([0.01, 0.1, 0.5, 0.39, 1.0, 20.0, 500.0]), 1e-3
    shear = response(shear_relaxation(material), ramp(rate, 1.0), times)

    block, computed = Block(measure, material), []
    for t, dt in zip(times, np.diff(times, prepend=0.0), strict=True):
        computed.append(block.moved(1 + rate * min(t, 1.0), dt))
        if t == 1.0:
            block.variables = block.variables.at_slope_change()

    def check(expected):
        np.testing.assert_allclose(computed, expected, rtol=1e-9, err_msg="uniaxial, incompressible: E = 3 G")

    check(3 * shear)
    known = {"reference": "linear viscoelasticity, E = 3 G", "kind": "exact", "mesh": f"{measure}, one cell", "tolerance": 1e-9}
    verification_record("ramp with three relaxation times", np.array(computed) / (3 * shear), np.ones_like(shear), **known)
    at_once = 3 * response(shear_relaxation(material), step(rate), times)
    assert_kills(check, poisson_ratio=(2 * (1 + 0.49) * shear,), step=(at_once,))


@pytest.mark.parametrize("measure", ["axisymmetric", pytest.param("solid", marks=pytest.mark.slow)])
def test_a_force_makes_linear_tissue_creep(measure, verification_record):
    material = LinearElastic(youngs_modulus=3000.0, poisson_ratio=0.5, relaxation=THREE_TIMES)
    block = Block(measure, material, law=Coulomb(friction=0.0), tolerance=1e-7)
    force, times = 1.0 * block.surface.points.weights.sum(), np.geomspace(1e-4, 100.0, 200)
    heights = [block.pressed(0.0, force=force), *(block.pressed(dt, force=force) for dt in np.diff(times, prepend=0.0))]
    strain = 1 - np.array(heights)
    shear, times = shear_relaxation(material), np.append(0.0, times)

    def check(compliance):
        np.testing.assert_allclose(strain, compliance / 3, rtol=2e-3, err_msg="steps of 7 %, whose chords miss the curve by 1e-3")
        assert strain[0] == pytest.approx(compliance[0] / 3, rel=1e-2), "penetration of 1e-7 in a displacement of 3e-4"

    compliance = response(kelvin_of(shear), step(1.0), times)
    check(compliance)
    known = {"reference": "creep compliance over 3", "kind": "exact", "mesh": f"{measure}, one cell", "tolerance": 2e-3}
    verification_record("creep under a contact force", strain * 3 / compliance, np.ones_like(compliance), **known)
    assert_kills(check, inverse_modulus=(1 / shear.relaxation(times),))


@pytest.mark.parametrize(
    ("law", "measure"),
    [
        pytest.param(Coulomb(friction=0.3), "axisymmetric", id="coulomb-axisymmetric"),
        pytest.param(Stick(), "solid", id="stick-solid"),
        pytest.param(Stick(), "axisymmetric", id="stick-axisymmetric"),
        pytest.param(Coulomb(friction=0.3), "solid", id="coulomb-solid", marks=pytest.mark.slow),
    ],
)
def test_a_held_squeeze_with_friction_relaxes_with_the_material(measure, law, verification_record):
    material = MooneyRivlin2(c10=1.0, c01=0.25, relaxation=THREE_TIMES)
    block = Block(measure, material, law=law, cells=3, glued=True, tolerance=1e-4)
    for height in np.linspace(1, 0.85, 5)[1:]:
        at_once = block.pressed(0.0, height=height)
    equilibrium, amplitudes, tau = THREE_TIMES.amplitudes
    times = np.array([0.01, 1.0, 20.0, 1e4])
    computed = [block.pressed(dt, height=0.85) / at_once for dt in np.diff(times, prepend=0.0)]
    branches = amplitudes * np.exp(-times[:, None] / tau)

    def check(fading):
        np.testing.assert_allclose(
            computed, fading, rtol=5e-4, err_msg="penetration of 1e-4 that the falling pressure gives back"
        )

    fading = equilibrium + branches.sum(axis=1)
    check(fading)
    known = {"reference": "relaxation of the material", "kind": "exact", "mesh": f"{measure}, 3 cells per side"}
    verification_record("squeeze held with friction, force", computed, fading, tolerance=5e-4, scale=1.0, **known)
    assert_kills(check, without_the_slowest=(equilibrium + amplitudes[-1] + branches[:, :-1].sum(axis=1),))


def test_a_force_brings_a_distant_body_into_touch(verification_record):
    near, far, loaded = (Block("axisymmetric", RUBBER, law=Coulomb(friction=0.0), tolerance=1e-6) for _ in range(3))
    far.place = 1.5 * far.place
    reached = far.pressed(0.0, force=0.1)

    def check(height):
        assert reached == pytest.approx(height, rel=1e-8)
        assert reached < 0.999

    height = near.pressed(0.0, force=0.1)
    check(height)
    known = {"reference": "a body that touches", "kind": "invariance", "mesh": "axisymmetric, one cell", "tolerance": 1e-8}
    verification_record("force on a body at a distance, place", reached, height, **known)
    assert_kills(check, force_per_radian=(loaded.pressed(0.0, force=0.1 / (2 * np.pi)),), untouched=(1.5,))


def test_a_force_below_the_round_off_of_the_contact_is_refused():
    block = Block("axisymmetric", RUBBER, law=Coulomb(friction=0.0), tolerance=1e-12)
    with pytest.raises(ConvergenceError, match="round-off of the contact"):
        block.pressed(0.0, force=1e-9)
