"""Compiled steps: equal to the response to the same samples, and without allocation."""

from __future__ import annotations

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from tactsim.analytic.atrial import table_4_1
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.histories import sampled
from tactsim.analytic.interconversion import maxwell_of
from tactsim.analytic.response import response
from tactsim.analytic.stepping import kelvin_step, maxwell_step, rest_state, step_constants
from tactsim.errors import InvalidQuantity

MODEL = table_4_1("viscosities")
FLUID = GeneralizedKelvin(1.0, [2.0, 3.0, 1.0], [1e-4, 0.3, 1e5], fluidity=0.2)
STEPS = [(MODEL, kelvin_step), (maxwell_of(MODEL), maxwell_step), (FLUID, kelvin_step), (maxwell_of(FLUID), maxwell_step)]


def signal(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Times in s with steps over six decades, and a random walk."""
    generator = np.random.default_rng(3)
    steps = 10 ** generator.uniform(-5, 1, count)
    return np.append(0.0, np.cumsum(steps)), generator.normal(size=count + 1).cumsum()


@pytest.mark.parametrize(("model", "advance"), STEPS)
def test_steps_equal_the_response_to_the_same_samples(model, advance):
    times, values = signal(3000)
    constants, state = step_constants(model), rest_state(model)
    computed = [advance(constants, state, 0.0, values[0])]
    computed += [advance(constants, state, step, value) for step, value in zip(np.diff(times), values[1:], strict=True)]
    expected = response(model, sampled(times, values), times)
    np.testing.assert_allclose(computed, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
    with pytest.raises(AssertionError):  # twin
        np.testing.assert_allclose(computed, response(model, sampled(times * (1 + 1e-9), values), times * (1 + 1e-9)), rtol=1e-12)


@pytest.mark.parametrize(("model", "advance"), STEPS)
def test_a_step_may_be_split_and_a_jump_takes_no_time(model, advance):
    constants, once, split = step_constants(model), rest_state(model), rest_state(model)
    for state in (once, split):
        advance(constants, state, 0.0, 0.3)
    whole = advance(constants, once, 2.0, 1.3)
    for k in range(1000):
        part = advance(constants, split, 0.002, 0.3 + 0.001 * (k + 1))
    assert part == pytest.approx(whole, rel=1e-12)
    np.testing.assert_allclose(split, once, rtol=1e-11, atol=1e-14)
    stiffness = model.glassy_compliance if isinstance(model, GeneralizedKelvin) else model.instantaneous_modulus
    assert advance(constants, once, 0.0, 2.3) - whole == pytest.approx(stiffness, rel=1e-10)


@pytest.mark.parametrize(("model", "advance"), STEPS[:2])
@pytest.mark.parametrize("step", [-1e-9, float("nan"), float("inf")])
def test_an_impossible_step_is_refused_and_leaves_the_state(model, advance, step):
    constants, state = step_constants(model), rest_state(model)
    advance(constants, state, 1.0, 2.0)
    before = state.copy()
    with pytest.raises(InvalidQuantity, match="time_step is out of range"):
        advance(constants, state, step, 1.0)
    np.testing.assert_array_equal(state, before)


@pytest.mark.parametrize(("model", "advance"), STEPS[:2])
def test_a_million_steps_allocate_nothing(model, advance):
    """Passing the two arrays to compiled code counts as two allocations whatever the number of steps."""

    @numba.njit
    def run(constants, state, count):
        total = 0.0
        for k in range(count):
            total += advance(constants, state, 1e-3 * (1 + k % 7), 0.1 * (k % 13))
        return total

    constants, state = step_constants(model), rest_state(model)
    run(constants, state, 1)
    _nrt_python.memsys_enable_stats()
    try:
        allocated = []
        for count in (1, 1_000_000):
            before = rtsys.get_allocation_stats().mi_alloc
            run(constants, state, count)
            allocated.append(rtsys.get_allocation_stats().mi_alloc - before)
    finally:
        _nrt_python.memsys_disable_stats()
    assert allocated[0] == allocated[1] <= 2
