"""The annulus on linear viscoelastic tissue by its closed form: any history in milliseconds, small displacements only."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.analytic.force_factor import Formula
from tactsim.analytic.viscoelastic_annulus import SMALL_DISPLACEMENT, ViscoelasticAnnulus
from tactsim.array import Array
from tactsim.interfaces import Experiment, Material
from tactsim.interfaces.run import Course, Findings
from tactsim.materials import AnyMaterial
from tactsim.materials.library import named_material
from tactsim.materials.viscoelasticity import shear_compliance
from tactsim.mechanics.outcome.plausibility import oddities
from tactsim.mechanics.outcome.success import within_layer
from tactsim.mechanics.paths.loading import AnyLoading, ForceLoading, Sine
from tactsim.results.quantity import Quantity
from tactsim.results.result import rows
from tactsim.units import Length, NonNegative, Positive, format_quantity

DECADES, PER_DECADE = 6, 10
"""Times sampled after the beginning of each piece: over this many decades up to its length, and so many in each."""
ROUND_OFF = 1e-9
"""Change of a history between two pieces, over its largest value, that is no jump."""
IN_A_PERIOD = 20
"""Times of a period that show its largest and its smallest value within 1.2 % of the amplitude."""
MOST_TIMES = 1_000_000
"""Sampled times of all pieces: each takes 1 kB, and all are rows of the history."""


def check_closed_form(inner_radius: float, outer_radius: float, material: Material) -> None:
    """Check that there is a closed form of an annulus of these radii in m on this material.

    Raises
    ------
    ValueError
        If the face is too narrow or the material is compressible.
    """
    if inner_radius > 0.99 * outer_radius:
        inner, outer = format_quantity(inner_radius, "m"), format_quantity(outer_radius, "m")
        raise ValueError(f"inner_radius {inner} must be at most 0.99 of the outer_radius {outer}")
    if material.bulk_modulus is not None:
        raise ValueError("the closed form is that of incompressible tissue; set bulk_modulus: null")


class ClosedForm(Experiment):
    r"""A rigid frictionless annulus under a prescribed history, with the small-strain shear response of a material.

    .. math:: \epsilon(t) = \frac{1}{8 a \kappa} \int_{0^-}^t J(t - s)\, dP(s)

    The contact is bilateral: where the force becomes negative a real contact opens, and the result says so.

    >>> import tactsim as ts
    >>> ramp = {"kind": "ramp", "to": "50 mN", "duration": "1 s"}
    >>> press = ts.ClosedForm(material="icf_stable", loading={"control": "force", "pieces": [ramp]})
    >>> f"{press.run()['displacement'].to('mm'):.3f}"
    '0.598 mm'

    Source: thesis, 4.6.1 to 4.6.4 and section 4.7.
    """

    kind: Literal["closed_form"] = "closed_form"
    material: AnyMaterial
    """Tissue; its small-strain shear relaxation counts; incompressible."""
    inner_radius: NonNegative[Length] = 1.5e-3
    """Inner radius; 0 is a solid punch."""
    outer_radius: Positive[Length] = 3e-3
    """Outer radius."""
    thickness: Positive[Length] | None = None
    """Thickness of the layer of tissue; null is a half-space."""
    base: Literal["bonded", "slipping"] = "bonded"
    """Base of the layer."""
    formula: Formula = "exact"
    """Force factor of the annulus on a half-space."""
    loading: AnyLoading
    """The prescribed history; it may pull."""
    points: Annotated[int, Field(ge=2, le=100_000)] = 200
    """Evenly spaced times in each piece, beside ten per decade after its beginning."""

    history_units: ClassVar[dict[str, str]] = {"time": "s", "displacement": "m", "force": "N", "tissue_rise_axis": "m"}

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        count = len(self.loading.segments()) * (self.points + DECADES * PER_DECADE)
        if count > MOST_TIMES:
            raise ValueError(
                f"points: {count:.2g} times in all pieces; allowed: up to {MOST_TIMES:.2g}; take fewer points or pieces"
            )
        check_closed_form(self.inner_radius, self.outer_radius, self.material)
        if self.thickness is not None and self.formula != "exact":
            raise ValueError(f"the formula {self.formula} is for a half-space; on a layer only exact is known")
        if self.thickness is not None and self.loading.control == "displacement":
            deepest, thickness = max(map(abs, self.loading.least_and_most())), format_quantity(self.thickness, "m")
            if deepest >= self.thickness:
                given = format_quantity(deepest, "m")
                raise ValueError(f"loading: displacement {given} must be smaller than the thickness of the layer, {thickness}")
        return self

    @classmethod
    def example(cls) -> Self:
        """The load of section 4.7: 0.2 N, and a sine of 0.2 N at 1 Hz after 2 s."""
        pieces = [
            {"kind": "jump", "to": 0.2, "duration": 2.0},
            {"kind": "sine", "amplitude": 0.2, "frequency": 1.0, "duration": 4.0},
        ]
        loading = ForceLoading.model_validate({"control": "force", "pieces": pieces})
        return cls(material=named_material("atrial_printed").material, loading=loading)

    def begin(self) -> Course:
        """Evaluate at the sampled times."""
        annulus, times = self._annulus(), self._times()
        displacement, force = self._course(annulus, times)
        status, reason = within_layer("end of the history", float(np.abs(displacement).max()), self.thickness)
        columns = (times, displacement, force, annulus.rise(displacement))
        steps = rows(self.history_units, columns)
        return Course.computed(
            Findings(
                reason,
                steps,
                status=status,
                quantities=self._quantities(annulus, steps[-1].values, columns),
                assumptions=("linear viscoelasticity, incompressible, frictionless, bilateral contact of a flat annulus",),
                warnings=self._warnings(times, force, displacement),
            )
        )

    def course(self, times: Array) -> tuple[Array, Array]:
        """Displacement of the annulus (n,) in m, and the force (n,) in N on it, at times (n,) in s."""
        return self._course(self._annulus(), times)

    def _course(self, annulus: ViscoelasticAnnulus, times: Array) -> tuple[Array, Array]:
        history = self.loading.history()
        if self.loading.control == "force":
            return annulus.displacement(history, times), history.value(times)
        return history.value(times), annulus.force(history, times)

    def _annulus(self) -> ViscoelasticAnnulus:
        return ViscoelasticAnnulus(
            self.outer_radius,
            self.inner_radius / self.outer_radius,
            shear_compliance(self.material),
            formula=self.formula,
            radius_over_thickness=0.0 if self.thickness is None else self.outer_radius / self.thickness,
            base=self.base,
        )

    def _times(self) -> Array:
        """Sampled times in s, each piece's beginning and end included, and the last instant before a jump."""
        sampled, segments = [], self.loading.segments()
        for segment in segments:
            duration = segment.end - segment.start
            early = duration * np.geomspace(10.0**-DECADES, 1.0, DECADES * PER_DECADE + 1)
            sampled.append(segment.start + np.union1d(early, np.linspace(0.0, duration, self.points)))
        round_off = ROUND_OFF * max(map(abs, self.loading.least_and_most()))
        both = [(one.end, abs(after.at(after.start) - one.at(one.end))) for one, after in pairwise(segments)]
        jumps = [time for time, change in both if change > round_off]
        return np.unique(np.concatenate([*sampled, np.nextafter(jumps, 0.0)]))

    def _coarse_sines(self) -> list[str]:
        """A warning if the history shows too little of a sine."""
        waves = [piece for piece in self.loading.pieces if isinstance(piece, Sine)]
        fastest = max(waves, key=lambda wave: wave.frequency * wave.duration, default=None)
        if fastest is None or self.points - 1 >= IN_A_PERIOD * fastest.frequency * fastest.duration * (1 - ROUND_OFF):
            return []
        frequency, needed = format_quantity(fastest.frequency, "Hz"), IN_A_PERIOD * fastest.frequency * fastest.duration + 1
        return [
            f"points: {self.points} times are fewer than {IN_A_PERIOD} in each period of the sine of {frequency}: its curves and "
            f"its largest and smallest values are too coarse; take {np.ceil(needed * (1 - ROUND_OFF)):.0f}, or a shorter sine"
        ]

    def _quantities(
        self, annulus: ViscoelasticAnnulus, last: dict[str, float], columns: tuple[Array, ...]
    ) -> dict[str, Quantity]:
        described = {
            "displacement": "displacement of the annulus at the end",
            "force": "force on the annulus at the end",
            "tissue_rise_axis": "height of the tissue on the axis above the face of the annulus at the end",
        }
        quantities = {name: Quantity(last[name], self.history_units[name], words) for name, words in described.items()}
        _, displacement, force, _ = columns
        quantities["largest_displacement"] = Quantity(float(displacement.max()), "m", "largest displacement")
        quantities["largest_force"] = Quantity(float(force.max()), "N", "largest force")
        quantities["smallest_force"] = Quantity(float(force.min()), "N", "smallest force; negative is a pull")
        quantities["force_factor"] = Quantity(annulus.force_factor, "1", "kappa = P / (8 G a eps)")
        quantities["rise_factor"] = Quantity(annulus.rise_factor, "1", "height of the tissue on the axis over the displacement")
        return quantities

    def _warnings(self, times: Array, force: Array, displacement: Array) -> list[str]:
        warnings = []
        pulled = force < -1e-9 * np.abs(force).max()
        if pulled.any():
            first = format_quantity(float(times[pulled][0]), "s")
            warnings.append(f"the force is negative, first at {first}: a real contact opens there, and the closed form ends")
        deepest = float(np.abs(displacement).max()) / self.outer_radius
        if deepest > SMALL_DISPLACEMENT:
            limit = f"linear theory is meant for up to {SMALL_DISPLACEMENT:g}"
            warnings.append(f"the displacement reaches {deepest:.3g} of the outer radius; {limit}")
        warnings += self._coarse_sines()
        tissue = {} if self.thickness is None else {"thickness": self.thickness}
        radii = {"inner_radius": self.inner_radius} if self.inner_radius else {}
        return warnings + oddities({"material": self.material}, tissue=tissue, bodies=radii | {"outer_radius": self.outer_radius})
