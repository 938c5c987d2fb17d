"""What an indentation by the switch probe is given: tissues, rates, the probe, its electronics, and which model presses."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from tactsim.contact.coulomb import Coulomb
from tactsim.contact.trapezoid import Trapezoid
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.switch_probe.probe_curve import CHAPTER_5
from tactsim.experiments.switch_probe.probe_curve import COUNT as COUNT
from tactsim.experiments.switch_probe.probe_indentation import ProbeIndentation
from tactsim.materials import AnyMaterial
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.contact.penetration_bounds import default_penetration
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mechanics.paths.loading import close
from tactsim.mechanics.paths.step_policy import TimeSettings
from tactsim.model import FrozenModel
from tactsim.sensors.electronics.calibration import THESIS_LINE, AnyCalibration
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.switch_array import SwitchArray
from tactsim.units import Length, NonNegative, Positive, Speed, format_quantity

LEAST_SAMPLES, MOST_SAMPLES = 2 * COUNT, 1_000_000
"""Samples of one way: two for each switch at least; at most so many that a touch takes about ten seconds."""
HISTORY_UNITS = {
    "tissue": "1",
    "rate": "m/s",
    "time": "s",
    "depth": "m",
    "force": "N",
    "contact_height": "m",
    "read_force": "N",
    **{f"switch_force_{number}": "N" for number in range(1, COUNT + 1)},
    **{f"read_switch_force_{number}": "N" for number in range(1, COUNT + 1)},
}


class ProbeTissue(FrozenModel):
    """A tissue with its name in figures and quantities."""

    name: Annotated[str, Field(min_length=1, max_length=40)]
    """Name."""
    material: AnyMaterial
    """Its material."""


class ProbeBlock(FrozenModel):
    """A block of tissue on a rigid base, as deep as the probe."""

    width: Positive[Length] = 40e-3
    """Width, the probe in its middle; its sides are free."""
    height: Positive[Length] = 20e-3
    """Height."""


class SwitchProbeSetup(FrozenModel):
    """The probe of chapter 5, pressed into tissues at constant rates and drawn back."""

    tissues: Annotated[tuple[ProbeTissue, ...], Field(min_length=1, max_length=20)]
    """Tissues, one after the other."""
    rates: Annotated[tuple[Positive[Speed], ...], Field(min_length=1, max_length=50)] = (1e-3,)
    """Rates of indentation; each tissue meets each of them at rest."""
    depth: Positive[Length] = 5e-3
    """Depth at which the probe turns back."""
    model: Literal["fast", "fem"] = "fast"
    """Finite elements for every tissue and rate, or the elastic curve of one such run, made to relax by superposition."""
    sides: Literal["computed", "followed"] = "computed"
    """How far the tissue touches the sides: as finite elements find, or up to its undeformed surface, as the thesis takes it."""
    probe: Trapezoid = Trapezoid()
    """Section of the probe."""
    width: Positive[Length] = 10e-3
    """Width of the probe out of the plane."""
    block: ProbeBlock = ProbeBlock()
    """Size of the specimen; the thesis's cubes have none printed."""
    contact: Coulomb = Coulomb()
    """Friction."""
    mesh: MeshSettings = MeshSettings()
    """Size of the elements; at sharp corners the finest is a twelfth of the face by default, as smaller ones collapse there."""
    time: TimeSettings = TimeSettings(tolerance=0.02, per_decade=0)
    """Steps of time of the finite elements."""
    array: SwitchArray = SwitchArray()
    """Switches and the algorithm that reads them."""
    chain: SignalChain = SignalChain()
    """Electronics of the force sensor and of each switch, which are alike."""
    calibration: AnyCalibration = THESIS_LINE
    """Line of the force sensor and of each switch."""
    noise_factor: Annotated[float, Field(ge=1, le=100)] | None = 8.0
    """Thresholds of the array as multiples of what noise and converter mean in force; null takes those of the array."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        names = [tissue.name for tissue in self.tissues]
        for name in [name for name in names if names.count(name) > 1][:1]:
            raise ValueError(f"two tissues are named {name}; allowed: each name once")
        for rate in [rate for rate in self.rates if self.rates.count(rate) > 1][:1]:
            raise ValueError(f"two rates are {format_quantity(rate, 'm/s')}; allowed: each rate once")
        if self.array.count != COUNT:
            raise ValueError(f"array.count is {self.array.count}; the probe of chapter 5 has {COUNT} switches")
        if self.depth >= self.block.height:
            given, most = format_quantity(self.depth, "m"), format_quantity(self.block.height, "m")
            raise ValueError(f"depth {given} must be smaller than the height of the block, {most}")
        self._check_sampling()
        if self.model == "fast":
            self._check_fast()
        return self

    def _check_sampling(self) -> None:
        for rate in self.rates:
            samples = self.duration(rate) * self.chain.sampling_rate
            if not LEAST_SAMPLES <= samples <= MOST_SAMPLES:
                given, change = format_quantity(rate, "m/s"), "faster" if samples < LEAST_SAMPLES else "more slowly"
                raise ValueError(
                    f"the way in at a rate of {given} takes {samples:.3g} samples; allowed: {LEAST_SAMPLES} to {MOST_SAMPLES}; "
                    f"sample {change} or take another rate"
                )

    def _check_fast(self) -> None:
        default = {"probe": Trapezoid(), "block": ProbeBlock(), "contact": Coulomb()}
        lengths = ("pitch", "strip")
        same = all(_alike(getattr(self, name).model_dump(), one.model_dump()) for name, one in default.items())
        if not same or not all(_alike(getattr(self.array, name), getattr(SwitchArray(), name)) for name in lengths):
            raise ValueError(
                "the fast model holds the curve of the default probe, block, contact, pitch and strip; leave them out, or set "
                "model: fem"
            )
        deepest = float(CHAPTER_5.depth[-1])
        if self.depth > deepest:
            depth, most = format_quantity(self.depth, "m"), format_quantity(deepest, "m")
            raise ValueError(f"depth {depth} is beyond the curve of the fast model; allowed: up to {most}, or set model: fem")
        for tissue in self.tissues:
            if not isinstance(tissue.material, NeoHookean) or tissue.material.bulk_modulus is not None:
                raise ValueError(
                    f"tissue {tissue.name} is a {tissue.material.kind}; the curve of the fast model is that of incompressible "
                    "neo_hookean tissue, scaled and made to relax; take such a material or set model: fem"
                )

    def duration(self, rate: float) -> float:
        """Time in s of one way at a rate in m/s."""
        return self.depth / rate

    @property
    def penetration(self) -> float:
        """Largest penetration in m of the finite elements."""
        return default_penetration(1e-3 * self.probe.radius, self.depth)

    def indentation(self, tissue: ProbeTissue, rate: float) -> ProbeIndentation:
        """The finite element simulation of the way in at a rate in m/s, in plane strain."""
        return ProbeIndentation(
            specimen=Specimen(material=tissue.material, thickness=self.block.height, radius=self.block.width / 2),
            body=self.probe,
            contact=self.contact,
            loading=close(to=self.depth, duration=self.duration(rate)),
            penetration_tolerance=self.penetration,
            mesh=self.mesh,
            time=self.time,
        )


def _alike(one: Any, other: Any) -> bool:
    """Whether two dumped values are the same but for the digits that a case file does not write."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_alike(one[key], other[key]) for key in one)
    return math.isclose(one, other, rel_tol=1e-12) if isinstance(one, float) and isinstance(other, float) else bool(one == other)
