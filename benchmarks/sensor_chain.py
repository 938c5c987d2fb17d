"""Speed of the signal chain of two 3 x 3 matrices, from conductance to force, and of the switch probe; prints JSON."""

from __future__ import annotations

import json
import sys
import time

import numpy as np

from tactsim.experiments.switch_probe.setup import ProbeTissue
from tactsim.experiments.switch_probe.switch_probe import SwitchProbe
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.relaxation import Relaxation
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain

CHANNELS = (2, 3, 3)
SECONDS, CHUNK = 2.0, 10
REPEATS = 15


def measure() -> dict[str, float]:
    """Simulated over elapsed time of 18 channels at 1 kHz: whole record and chunks of 10 ms, without and with noise."""
    quiet, noisy = SignalChain(), SignalChain(noise=Noise(white=1e-3, line=2e-3))
    force = 5 + 5 * np.sin(2 * np.pi * quiet.times(SECONDS)[:-1])
    conductance = np.ascontiguousarray(
        np.broadcast_to(THESIS_LINE.conductance(force)[:, None, None, None], (force.size, *CHANNELS))
    )
    figures = {"channels": float(np.prod(CHANNELS))}
    for words, chain in (("", quiet), ("noisy_", noisy)):
        for name, run in (("record", _record), ("stream", _stream)):
            run(chain, conductance[: 10 * CHUNK])
            figures[f"{words}{name}_real_time_factor"] = SECONDS / min(_seconds(run, chain, conductance) for _ in range(REPEATS))
    return figures | {"probe_samples_per_second": _probe_samples_per_second()}


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """The row of the performance table: what, what is asked, what was measured."""
    what = "18 sensors at 1 kHz, conductance to force, in chunks of 10 ms / at once"
    factors = " / ".join(f"{taken[f'{how}_real_time_factor']:.0f}" for how in ("stream", "record"))
    return [(what, "100 times real time", f"{factors} times")]


def _probe_samples_per_second() -> float:
    """Samples of the switch probe per second: 10 s at 1 kHz on one tissue; 2000 are asked for."""
    material = NeoHookean(c10=5e3, relaxation=Relaxation(fractions=(0.9,), times=(6.0,)))
    probe = SwitchProbe(tissues=(ProbeTissue(name="tissue", material=material),), sides="followed")
    return 10_000 / min(probe.run().timing["total"] for _ in range(3))


def _record(chain: SignalChain, conductance: np.ndarray) -> None:
    THESIS_LINE.force(chain.conductance(chain.acquire(conductance, np.random.default_rng(1)).filtered))


def _stream(chain: SignalChain, conductance: np.ndarray) -> None:
    stream = chain.stream(np.random.default_rng(1))
    for begin in range(0, len(conductance), CHUNK):
        recording, stream = stream.take(conductance[begin : begin + CHUNK])
        THESIS_LINE.force(chain.conductance(recording.filtered))


def _seconds(run, chain: SignalChain, conductance: np.ndarray) -> float:  # type: ignore[no-untyped-def]
    begin = time.perf_counter()
    run(chain, conductance)
    return time.perf_counter() - begin


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measure(), indent=2) + "\n")
