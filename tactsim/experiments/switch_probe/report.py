"""What an indentation by the switch probe reports: the touches, what was read from them, and how tissues rank."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tactsim.array import Array, evenly_spaced
from tactsim.experiments.switch_probe.run import ProbeTouch, force_noise, thresholds
from tactsim.experiments.switch_probe.scene import RecordedTouch, SwitchProbeScene
from tactsim.experiments.switch_probe.setup import COUNT, HISTORY_UNITS, SwitchProbeSetup
from tactsim.interfaces.run import Findings
from tactsim.mechanics.outcome.plausibility import oddities
from tactsim.mechanics.outcome.success import judged
from tactsim.results.quantity import Quantity
from tactsim.results.result import Status, StepRecord
from tactsim.sensors.switch_reading import Touch
from tactsim.units import format_quantity

POINTS = 100
"""Samples of each touch that the history keeps, evenly spaced, beside the one at the turn; the scene holds every closing."""


SUNK = 0.05
"""Part of the depth by which the contact on the sides may stay behind it without a warning."""


class SwitchProbeReport:
    """Collects touches and turns them into a result."""

    def __init__(self, setup: SwitchProbeSetup):
        self._setup = setup
        self._touches: list[ProbeTouch] = []
        self.steps: list[StepRecord] = []

    def add(self, touch: ProbeTouch) -> tuple[StepRecord, ...]:
        """Record a touch; the steps of its history."""
        self._touches.append(touch)
        number = 1 + [tissue.name for tissue in self._setup.tissues].index(touch.tissue)
        kept = np.union1d(evenly_spaced(len(touch.time), POINTS), int(np.argmax(touch.depth)))
        iterations, residual = touch.newton
        new = tuple(
            StepRecord(len(self.steps) + k, iterations, residual, _values(touch, number, int(sample)))
            for k, sample in enumerate(kept, 1)
        )
        self.steps.extend(new)
        return new

    def findings(self) -> Findings:
        """What every touch that was made says; no success if the last state of one is none."""
        status, reason = Status.CONVERGED, f"{len(self._touches)} touches"
        for touch in self._touches:
            status, reason = judged(status, reason, touch.states[-1:], self._setup.penetration)
        return Findings(
            reason,
            self.steps,
            status=status,
            quantities=self._quantities(),
            assumptions=self._assumptions(),
            warnings=self._warnings(),
            scene=self._scene(),
        )

    def _quantities(self) -> dict[str, Quantity]:
        """Those of each touch, numbered in the order of the touches: every rate of the first tissue, then of the next."""
        quantities: dict[str, Quantity] = {}
        for number, touch in enumerate(self._touches, 1):
            where = _where(touch)
            forces = touch.force_at(self._depths())
            quantities[f"forces_{number}"] = Quantity(forces, "N", f"force on the probe at each pitch [depth], {where}")
            quantities[f"largest_force_{number}"] = Quantity(
                float(touch.true.force.max()), "N", f"largest force on the probe, {where}"
            )
            height = float(touch.true.contact_height.max())
            quantities[f"contact_height_{number}"] = Quantity(
                height, "m", f"largest height that the tissue touches on the sides, {where}"
            )
            quantities |= self._read(number, where, main_touch(touch))
            if touch.quality is not None:
                quality = touch.quality.quantities(touch.states)
                quantities |= {
                    f"{name}_{number}": replace(q, description=f"{q.description}, {where}") for name, q in quality.items()
                }
        return quantities

    def _read(self, number: int, where: str, touch: Touch | None) -> dict[str, Quantity]:
        if touch is None:
            return {}
        array = self._setup.array
        quantities = {
            f"switching_times_{number}": Quantity(
                touch.times(), "s", f"times since the touch at which switches closed [closing], {where}"
            ),
            f"switching_intervals_{number}": Quantity(touch.intervals(), "s", f"intervals between them [interval], {where}"),
            f"switching_forces_{number}": Quantity(
                np.array([closing.force for closing in touch.closings]),
                "N",
                f"force read when each switch closed [closing], {where}",
            ),
            f"closed_switches_{number}": Quantity(len(touch.closings), "1", f"switches that closed, {where}"),
        }
        rate = touch.mean_rate(array)
        if rate is not None:
            words = f"mean rate by eq. 5.2.2, {array.formula.replace('_', ' ')}, {where}"
            quantities[f"mean_rate_{number}"] = Quantity(rate, "m/s", words)
        return quantities

    def _depths(self) -> Array:
        """Depths in m at every pitch up to the largest."""
        pitch = self._setup.array.pitch
        return pitch * np.arange(1, int(self._setup.depth / pitch * (1 + 1e-9)) + 1)

    def _assumptions(self) -> tuple[str, ...]:
        setup = self._setup
        width, height = (format_quantity(value, "m") for value in (setup.block.width, setup.block.height))
        assumptions = [
            f"probe with a face of {format_quantity(setup.probe.face, 'm')} and {format_quantity(setup.width, 'm')} deep, fillet "
            f"{format_quantity(setup.probe.fillet, 'm')}; block {width} wide and {height} high, "
            f"friction {setup.contact.friction:g}, plane strain (the thesis prints none of these)",
            "tissues with declared Prony series: the thesis does not name them",
            f"strips of {format_quantity(setup.array.strip, 'm')}, centred on the heights of the switches (not printed)",
        ]
        if setup.model == "fast":
            assumptions.append(
                "fast model: elastic curve of one finite element run, scaled by the shear modulus, quasi-linear superposition"
            )
        if setup.sides == "followed":
            assumptions.append(
                "the tissue follows the sides up to its undeformed surface, as the thesis takes it; finite elements find less"
            )
        return tuple(assumptions)

    def _warnings(self) -> list[str]:
        warnings, setup = [], self._setup
        for touch in self._touches:
            main, where = main_touch(touch), _where(touch)
            closed = 0 if main is None else len(main.closings)
            if closed < COUNT:
                warnings.append(f"{where}: {closed} of {COUNT} switches closed, so there is no mean rate")
            if touch.true.contact_height.max() < (1 - SUNK) * setup.depth:
                height = format_quantity(float(touch.true.contact_height.max()), "m")
                warnings.append(
                    f"{where}: the tissue sinks in beside the probe and touches its sides up to {height} only (sides: followed "
                    "takes it up to the undeformed surface, as the thesis does)"
                )
            if touch.quality is not None:
                warnings += [f"{where}: {warning}" for warning in touch.quality.warnings(touch.states)]
            if touch.saturated:
                warnings.append(f"{where}: {touch.saturated} samples were outside of the converter's range")
        materials = {f"tissue {tissue.name}": tissue.material for tissue in setup.tissues}
        tissue = {"block.width": setup.block.width, "block.height": setup.block.height}
        return warnings + oddities(materials, tissue=tissue, bodies={"probe.face": setup.probe.face, "width": setup.width})

    def _scene(self) -> SwitchProbeScene:
        setup = self._setup
        array = thresholds(setup)
        return SwitchProbeScene(
            model=setup.model,
            sides=setup.sides,
            tissues=tuple(tissue.name for tissue in setup.tissues),
            rates=setup.rates,
            depth=setup.depth,
            heights=array.heights.tolist(),
            switch_sides=array.sides,
            noise=force_noise(setup),
            touch_threshold=array.touch_threshold,
            switch_threshold=array.switch_threshold,
            formula=array.formula,
            touches=tuple(_recorded(touch, setup) for touch in self._touches),
        )


def _where(touch: ProbeTouch) -> str:
    return f"{touch.tissue} at {1e3 * touch.rate:.4g} mm/s"


def main_touch(touch: ProbeTouch) -> Touch | None:
    """The touch with the most closings of those that were read, None if there is none."""
    return max(touch.touches, key=lambda one: len(one.closings), default=None)


def _values(touch: ProbeTouch, number: int, sample: int) -> dict[str, float]:
    true = touch.true
    values = [number, touch.rate, touch.time[sample], touch.depth[sample], true.force[sample], true.contact_height[sample]]
    values += [touch.force[sample], *true.switches[sample], *touch.switches[sample]]
    return dict(zip(HISTORY_UNITS, map(float, values), strict=True))


def _recorded(touch: ProbeTouch, setup: SwitchProbeSetup) -> RecordedTouch:
    main, known = main_touch(touch), {"tissue": touch.tissue, "rate": touch.rate, "count": len(touch.touches)}
    if main is None:
        return RecordedTouch.model_validate(known)
    closings = [{"switch": c.switch, "time": c.time, "force": c.force} for c in main.closings]
    times = {"start": main.start, "end": main.end, "mean_rate": main.mean_rate(setup.array)}
    return RecordedTouch.model_validate({**known, **times, "closings": closings})
