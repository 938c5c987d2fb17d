"""Speed of the closed forms and of the solver's steps in time; prints JSON."""

from __future__ import annotations

import json
import sys
import time

import numba
import numpy as np

from tactsim.analytic.atrial import atrial_shear_compliance
from tactsim.analytic.force_factor import force_factor
from tactsim.analytic.histories import sampled
from tactsim.analytic.response import response
from tactsim.analytic.stepping import kelvin_step, rest_state, step_constants

PAIRS = 1_000_000
STEPS = 1_000_000
SAMPLES = 100_000
"""Of a recorded signal, whose response is to take less than a second."""
REPEATS = 3


def measure() -> dict[str, float]:
    """Force-displacement pairs per second, samples of a response, and the time of one step from Python and compiled."""
    generator = np.random.default_rng(1)
    depth, ratio = generator.uniform(0, 1e-3, PAIRS), generator.uniform(0, 0.99, PAIRS)
    force_factor(ratio[:10])
    pairs = min(_seconds(lambda: 8 * 1e3 * 3e-3 * force_factor(ratio) * depth) for _ in range(REPEATS))
    model = atrial_shear_compliance()
    constants, state = step_constants(model), rest_state(model)
    kelvin_step(constants, state, 1e-3, 1.0)
    called = min(_seconds(lambda: _called(constants, state)) for _ in range(REPEATS))
    compiled = numba.njit(_looped)
    compiled(kelvin_step, constants, state, 1)
    looped = min(_seconds(lambda: compiled(kelvin_step, constants, state, STEPS)) for _ in range(REPEATS))
    times = np.cumsum(generator.uniform(0.5e-3, 1.5e-3, SAMPLES))
    history = sampled(times, generator.normal(size=SAMPLES))
    response(model, history, times[:2])
    recorded = min(_seconds(lambda: response(model, history, times)) for _ in range(REPEATS))
    return {
        "response_samples_per_second": SAMPLES / recorded,
        "pairs_per_second": PAIRS / pairs,
        "step_from_python_microseconds": 1e6 * called / (STEPS // 10),
        "step_compiled_microseconds": 1e6 * looped / STEPS,
    }


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured."""
    pairs = f"{round(taken['pairs_per_second'], -5):,.0f} per second".replace(",", " ")
    compiled, called = (taken[f"step_{how}_microseconds"] for how in ("compiled", "from_python"))
    return [
        ("force-displacement pairs of the exact annulus, one core", "1 000 000 per second", pairs),
        ("one step of the atrial model, compiled / from Python", "5 µs", f"{compiled:.2f} / {called:.2f} µs"),
    ]


def _called(constants: np.ndarray, state: np.ndarray) -> None:
    for _ in range(STEPS // 10):
        kelvin_step(constants, state, 1e-3, 1.0)


def _looped(step, constants, state, count):  # type: ignore[no-untyped-def]
    total = 0.0
    for _ in range(count):
        total += step(constants, state, 1e-3, 1.0)
    return total


def _seconds(call) -> float:  # type: ignore[no-untyped-def]
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measure(), indent=2) + "\n")
