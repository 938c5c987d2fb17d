"""One tissue at one rate: what presses on the probe, what its electronics record, and what the algorithm reads from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.experiments.switch_probe.probe_curve import CHAPTER_5
from tactsim.experiments.switch_probe.probe_force import ProbeForces, probe_forces
from tactsim.experiments.switch_probe.probe_indentation import ProbeState, probe_states
from tactsim.experiments.switch_probe.setup import ProbeTissue, SwitchProbeSetup
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.mechanics.outcome.contact_quality import ContactQuality
from tactsim.results.result import StepRecord
from tactsim.sensors.switch_array import SwitchArray
from tactsim.sensors.switch_reading import Touch, read_switches

REST = 0.2
"""Time in s before the touch, in which the electronics see no force."""
ROUND_OFF = 1e-6
"""Round-off of a sampling time, in sampling steps."""


@dataclass(frozen=True, eq=False)
class ProbeTouch:
    """A touch as it was and as it was read.

    ``time`` (n,) in s from the first contact on, negative before it; ``depth`` (n,) in m; ``true`` forces in N; ``force`` (n,)
    and ``switches`` (n, count) in N as recorded; ``touches`` that the algorithm detected; ``states`` that finite elements
    accepted, with their ``quality``.
    """

    tissue: str
    rate: float
    time: Array
    depth: Array
    true: ProbeForces
    force: Array
    switches: Array
    saturated: int
    touches: tuple[Touch, ...]
    states: tuple[StepRecord, ...] = ()
    quality: ContactQuality | None = None

    @property
    def newton(self) -> tuple[int, float]:
        """Iterations of Newton, and its largest residual."""
        return sum(s.newton_iterations for s in self.states), max((s.residual for s in self.states), default=0.0)

    @property
    def loading(self) -> Array:
        """Whether each sample (n,) is one of the way in."""
        return (self.time >= 0) & (np.arange(len(self.time)) <= int(np.argmax(self.depth)))

    def force_at(self, depths: Array) -> Array:
        """True force in N on the way in at depths in m, of their shape."""
        return np.interp(depths, self.depth[self.loading], self.true.force[self.loading])


def thresholds(setup: SwitchProbeSetup) -> SwitchArray:
    """The array with the thresholds that the noise of the chain asks for, if they are stated as multiples of it."""
    if setup.noise_factor is None:
        return setup.array
    noise = force_noise(setup)
    return setup.array.above_noise(noise, noise, times=setup.noise_factor)


def force_noise(setup: SwitchProbeSetup) -> float:
    """Root mean square error in N of a reading without force: white noise, pick-up and half a step of the converter.

    The low pass is left out, so it is an upper bound.
    """
    chain = setup.chain
    volts = np.sqrt(chain.noise.white**2 + chain.noise.line**2 / 2 + chain.converter.step**2 / 4)
    resting = np.array(max(setup.calibration.intercept, 0.0))
    conductance = float(chain.conductance_step(resting)) * volts / chain.converter.step
    return float(conductance / setup.calibration.slope)


def touched(setup: SwitchProbeSetup, tissue: ProbeTissue, rate: float, generator: np.random.Generator) -> ProbeTouch:
    """Press at a rate in m/s, record and read.

    Raises
    ------
    ConvergenceError
        If the finite elements cannot follow the way in.
    """
    motion = _motion(setup, rate)
    time, depth = motion.time, motion.depth
    quality = ContactQuality() if setup.model == "fem" else None
    pressed, states = _pressed(setup, tissue, rate, motion, quality)
    force, switches, saturated = recorded(setup, pressed, generator)
    touches = read_switches(thresholds(setup), time, force, switches).touches
    return ProbeTouch(tissue.name, rate, time, depth, pressed, force, switches, saturated, touches, states, quality)


@dataclass(frozen=True, eq=False)
class _Motion:
    """Sampling times (n,) in s, zero at first contact, and depths (n,) in m."""

    time: Array
    depth: Array


def _motion(setup: SwitchProbeSetup, rate: float) -> _Motion:
    """The way in at a rate in m/s; the way back belongs to the fast model only.

    The probe turns with the first sample at its depth, so that one is there.
    """
    duration, step = setup.duration(rate), 1 / setup.chain.sampling_rate
    time = setup.chain.times(REST + step + (duration if setup.model == "fem" else 2 * duration)) - REST
    turn = float(time[np.searchsorted(time, duration - ROUND_OFF * step)])
    depth = np.interp(
        time, [-REST, 0.0, duration, max(turn, duration), turn + duration], [0.0, 0.0, setup.depth, setup.depth, 0.0]
    )
    depth[time == turn] = setup.depth
    return _Motion(time, depth)


def _pressed(
    setup: SwitchProbeSetup, tissue: ProbeTissue, rate: float, motion: _Motion, quality: ContactQuality | None
) -> tuple[ProbeForces, tuple[StepRecord, ...]]:
    time, depth = motion.time, motion.depth
    states: list[ProbeState] = []
    if quality is not None:
        states = list(probe_states(setup.indentation(tissue, rate), setup.array, width=setup.width, quality=quality))
        forces = _interpolated(states, time)
    else:
        forces = probe_forces(time, depth, curve=CHAPTER_5, modulus=shear_relaxation(tissue.material), width=setup.width)
    return (forces if setup.sides == "computed" else followed(setup, forces, depth)), tuple(s.record for s in states)


def _interpolated(states: list[ProbeState], time: Array) -> ProbeForces:
    """Accepted states at other times, monotone between them, zero before the first contact."""
    columns = np.array([(state.force, state.contact_height, *state.switch_forces) for state in states])
    nodes = np.array([0.0, *(state.time for state in states)])
    interpolated = scipy.interpolate.PchipInterpolator(nodes, np.vstack([0 * columns[:1], columns]))(
        np.clip(time, 0.0, nodes[-1])
    )
    interpolated = np.maximum(interpolated, 0.0)
    return ProbeForces(interpolated[:, 0], interpolated[:, 2:], interpolated[:, 1])


def followed(setup: SwitchProbeSetup, pressed: ProbeForces, depth: Array) -> ProbeForces:
    """The same force at depths (n,) in m, with tissue on the sides up to its undeformed surface, as the thesis takes it.

    Every switch carries the mean pressure over the probe's width at that surface, on the part of its strip that is covered.
    """
    array, probe = setup.array, setup.probe
    mean = pressed.force / (2 * setup.width * probe.half_width(depth))
    covered = np.clip(depth[:, None] - (array.heights - array.strip / 2), 0.0, array.strip)
    return ProbeForces(pressed.force, mean[:, None] * covered * setup.width, np.where(pressed.force > 0, depth, 0.0))


def recorded(setup: SwitchProbeSetup, pressed: ProbeForces, generator: np.random.Generator) -> tuple[Array, Array, int]:
    """Force (n,) and switches (n, count) in N as the electronics read them, and the number of saturated samples."""
    chain, line = setup.chain, setup.calibration
    conductance = line.conductance(np.column_stack([pressed.force, pressed.switches]))
    recording = chain.acquire(conductance, generator)
    forces = line.force(chain.conductance(recording.filtered))
    return forces[:, 0], forces[:, 1:], int(recording.saturated.sum())
