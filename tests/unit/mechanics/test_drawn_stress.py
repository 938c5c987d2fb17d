"""The stress and the pressure that are drawn are those in balance, and the same of tissue that all but does not relax."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from mutants import assert_kills
from solids import body_of, box

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.history_variables import HistoryVariables, elastic_stress, series_of
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2
from tactsim.mechanics.fields.cell_fields import pressures
from tactsim.mechanics.fields.point_values import cauchy_stress
from tactsim.relaxation import Relaxation

MEASURES = {"plane_strain": 2, "solid": 3}
RUBBER = MooneyRivlin2(c10=80.0, c01=20.0, bulk_modulus=1e3)
HARDLY = RUBBER.model_copy(update={"relaxation": Relaxation(fractions=(1e-13,), times=(1.0,))})


def deformed(measure: str, material: MooneyRivlin2, volume_stiffness: float) -> tuple[Body, Array]:
    """A jittered box and unknowns that leave it a change of volume which no pressure asks for."""
    dim = MEASURES[measure]
    body = body_of(box([1.0] * dim, [2] * dim, jitter=0.2, seed=3), measure, material, volume_stiffness=volume_stiffness)
    generator, unknowns = np.random.default_rng(1), np.zeros(body.space.size)
    u, p = body.space.split(unknowns)
    u[:] = 0.1 * body.space.nodes @ generator.normal(size=(dim, dim)) + generator.uniform(-0.01, 0.01, u.shape)
    p[:] = 100.0 * generator.normal(size=p.shape)
    return body, unknowns


@pytest.mark.parametrize("measure", MEASURES)
def test_the_drawn_stress_does_the_work_of_the_nodal_forces(measure: str) -> None:
    """Of motions that are linear in the deformed places, which the elements hold exactly. Mutant: without the resistance."""
    body, unknowns = deformed(measure, RUBBER, 3.0)
    state, dim = body.kinematics(unknowns), body.space.dim
    places = body.space.nodes + body.space.split(unknowns)[0]
    forces = body.residual(unknowns)[: body.space.displacement_size].reshape(-1, dim)

    def check(stress: Array) -> None:
        whole = np.einsum("ijeq,eq->ij", stress, body.points.weights * state.J)[:dim, :dim]
        np.testing.assert_allclose(whole, forces.T @ places, rtol=0, atol=1e-12 * np.abs(whole).max())

    check(cauchy_stress(body, unknowns, state))
    assert_kills(check, without=(cauchy_stress(body, unknowns, state, elastic_stress(body, state)),))


@pytest.mark.parametrize("measure", MEASURES)
def test_tissue_that_all_but_does_not_relax_draws_what_elastic_tissue_does(measure: str) -> None:
    def drawn(material: MooneyRivlin2, volume_stiffness: float = 3.0) -> tuple[Array, Array]:
        body, unknowns = deformed(measure, material, volume_stiffness)
        state = body.kinematics(unknowns)
        series, isochoric = series_of(body), None
        if series is not None:
            isochoric = HistoryVariables.at_rest(body, series).advanced(elastic_stress(body, state, unknowns), 0.0).stress
        now = SimpleNamespace(unknowns=unknowns, kinematics=state)
        return cauchy_stress(body, unknowns, state, isochoric), pressures(body, now, isochoric)[0]

    def check(stress: Array, pressure: Array) -> None:
        for value, relaxing in zip((stress, pressure), drawn(HARDLY), strict=True):
            np.testing.assert_allclose(value, relaxing, rtol=0, atol=1e-11 * np.abs(relaxing).max())

    check(*drawn(RUBBER))
    assert_kills(check, without_resistance=drawn(RUBBER, 0.0))
