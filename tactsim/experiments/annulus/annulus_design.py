"""Dimensions of the annular sensor: where the tissue in its hole really touches the small sensor, and with which force."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.analytic.atrial import atrial_shear_compliance
from tactsim.analytic.force_factor import Formula
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.viscoelastic_annulus import SMALL_DISPLACEMENT, ViscoelasticAnnulus
from tactsim.experiments.annulus.scene import AnnulusDesignScene, DesignPoint, Ratio
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.model import FrozenModel, check_increasing
from tactsim.results.quantity import Quantity
from tactsim.results.result import StepRecord
from tactsim.units import Force, Length, Positive, Time, format_quantity


class AtrialTissue(FrozenModel):
    """The tissue of Table 4.1 in one of its readings."""

    times: Literal["retardation_times", "viscosities"] = "viscosities"
    """The column of times: in s, as printed, or viscosities, as eq. 4.6.4 uses it."""
    compliance: Literal["tensile", "half_shear"] = "tensile"
    """The compliance: 1/E, as the compression test measures, or 1/(2G), as eq. 4.6.4 uses it."""

    @property
    def shear_compliance(self) -> GeneralizedKelvin:
        """1/G in 1/Pa."""
        return atrial_shear_compliance(self.times, self.compliance)


class AnnulusDesign(Experiment):
    r"""A rigid flat annulus under a constant force on viscoelastic tissue, over radius ratio, recess, force and time.

    .. math:: \epsilon = \frac{P J(t)}{8 a \kappa}, \quad \text{rise} = \rho\, \epsilon \ge L \text{ where the tissue touches}

    with force factor kappa and touch factor rho of the exact contact: the largest rise in the hole, which is on the axis but for
    layers thin beside it. Thesis section 4.7 takes eps itself for the rise. Where the annulus would be pressed to the base of a
    layer there is no value.
    """

    kind: Literal["annulus_design"] = "annulus_design"
    outer_radius: Positive[Length] = 3e-3
    """Radius of the face."""
    ratios: Annotated[tuple[Ratio, ...], Field(min_length=2)]
    """Inner over outer radius, increasing."""
    recesses: Annotated[tuple[Positive[Length], ...], Field(min_length=2)]
    """Depths L of the small sensor below the face, increasing."""
    forces: Annotated[tuple[Positive[Force], ...], Field(min_length=1)]
    """Constant forces, increasing, up to the largest one."""
    times: Annotated[tuple[Positive[Time], ...], Field(min_length=1)]
    """Times since the force began, increasing."""
    recommended_force: Positive[Force] = 2.0
    """Force on heart tissue that should not be exceeded, thesis section 4.7."""
    largest_force: Positive[Force] = 3.0
    """Force on heart tissue that must not be exceeded, thesis section 4.7."""
    tissue: AtrialTissue = AtrialTissue()
    """What is pressed."""
    formula: Formula = "exact"
    """Formula of the force factor; on a layer only the exact one."""
    thickness: Positive[Length] | None = None
    """Thickness of the tissue; null for a half-space."""
    base: Literal["bonded", "slipping"] = "bonded"
    """How a layer rests on its base."""
    design_point: DesignPoint = DesignPoint()
    """The sensor that is judged beside the map."""

    history_units: ClassVar[dict[str, str]] = {
        "radius_ratio": "1",
        "recess": "m",
        "force_to_touch": "N",
        "time_to_touch_recommended": "s",
        "time_to_touch_largest": "s",
        "displacement_at_touch": "m",
        "displacement_over_radius_at_touch": "1",
    }

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        check_increasing(ratios=self.ratios, recesses=self.recesses, forces=self.forces, times=self.times)
        given = {
            "forces": self.forces[-1],
            "recommended_force": self.recommended_force,
            "design_point.force": self.design_point.force,
        }
        for name, force in given.items():
            if force > self.largest_force:
                beyond, most = format_quantity(force, "N"), format_quantity(self.largest_force, "N")
                raise ValueError(f"{name}: {beyond} is beyond the largest one of {most}; lower it or raise largest_force")
        if self.thickness is not None and self.formula != "exact":
            raise ValueError(f"the formula {self.formula!r} is for a half-space; on a layer take 'exact'")
        return self

    @classmethod
    def example(cls) -> Self:
        """Two sensors on the tissue of Table 4.1."""
        return cls(ratios=(0.1, 0.5), recesses=(0.1e-3, 0.7e-3), forces=(1.0, 2.0), times=(0.5, 5.0))

    def annulus(self, ratio: float) -> ViscoelasticAnnulus:
        """The contact of an annulus of this radius ratio.

        Raises
        ------
        InvalidQuantity
            If the ratio is out of its range.
        """
        slenderness = self.outer_radius / self.thickness if self.thickness else 0.0
        return ViscoelasticAnnulus(
            self.outer_radius,
            ratio,
            self.tissue.shear_compliance,
            self.formula,
            radius_over_thickness=slenderness,
            base=self.base,
        )

    def begin(self) -> Course:
        """The map: one step for every radius ratio and recess, in which the force to touch is that within the longest time."""
        steps, quantities = list[StepRecord](), dict[str, Quantity]()
        kept = "the accepted rows are kept, the map is incomplete"
        return Course(self._mapped(steps, quantities), lambda: self._findings(steps, quantities), kept)

    def _mapped(self, steps: list[StepRecord], quantities: dict[str, Quantity]) -> Iterator[StepRecord]:
        """Adds every row to ``steps``, and what the complete map says to ``quantities``."""
        annuli = [self.annulus(ratio) for ratio in self.ratios]
        for number, values in enumerate(self._rows(annuli), start=1):
            steps.append(StepRecord(number, 0, 0.0, values))
            yield steps[-1]
        quantities |= self._point() | self._map(annuli)

    def _findings(self, steps: list[StepRecord], quantities: dict[str, Quantity]) -> Findings:
        return Findings(
            f"map complete; {_judged(quantities)}" if quantities else "",
            steps,
            quantities=quantities,
            assumptions=self._assumptions(),
            warnings=_warnings(quantities),
            scene=self._scene(),
        )

    def _scene(self) -> AnnulusDesignScene:
        shared = {name: getattr(self, name) for name in AnnulusDesignScene.model_fields if name in AnnulusDesign.model_fields}
        return AnnulusDesignScene(**shared, small_displacement=SMALL_DISPLACEMENT)

    def _rows(self, annuli: list[ViscoelasticAnnulus]) -> Iterator[dict[str, float]]:
        """History values per ratio and recess; a time is absent where the tissue never touches."""
        limits = np.array([self.recommended_force, self.largest_force])
        for annulus in annuli:
            for recess in self.recesses:
                displacement = float(annulus.touch_displacement(recess))
                times = annulus.time_to_touch(recess, limits)
                values = {
                    "radius_ratio": annulus.radius_ratio,
                    "recess": recess,
                    "force_to_touch": float(annulus.force_to_touch(recess, self.times[-1])),
                    "time_to_touch_recommended": float(times[0]),
                    "time_to_touch_largest": float(times[1]),
                    "displacement_at_touch": displacement,
                    "displacement_over_radius_at_touch": displacement / self.outer_radius,
                }
                yield {name: value for name, value in values.items() if np.isfinite(value)}

    def _map(self, annuli: list[ViscoelasticAnnulus]) -> dict[str, Quantity]:
        """The arrays over ratio, recess, force and time."""
        forces, times, recesses = np.array(self.forces), np.array(self.times), np.array(self.recesses)
        displacement = np.array([a.above_base(a.creep_displacement(forces[:, None], times)) for a in annuli])
        rise = np.array([a.touch_factor * d for a, d in zip(annuli, displacement, strict=True)])
        force = np.array([a.force_to_touch(recesses[:, None], times) for a in annuli])
        moment = np.array([a.time_to_touch(recesses[:, None], forces) for a in annuli])
        relative = displacement / self.outer_radius
        limits = np.array([[a.touch_factor * a.above_base(a.creep_displacement(f, times)) for a in annuli] for f in self._limits])
        depth = np.array([a.touch_displacement(recesses) for a in annuli])  # whatever the time
        touches = (rise[:, None] >= recesses[:, None, None]) & np.isfinite(depth)[:, :, None, None]
        return {
            "rise": _quantity(rise, "m", "largest rise of the tissue in the hole [ratio, force, time]"),
            "displacement": _quantity(displacement, "m", "displacement of the annulus [ratio, force, time]"),
            "displacement_over_radius": _quantity(relative, "1", "displacement over outer radius [ratio, force, time]"),
            "outside_small_displacement": _quantity(
                relative > SMALL_DISPLACEMENT, "1", f"whether that is above {SMALL_DISPLACEMENT:g}"
            ),
            "force_to_touch": _quantity(force, "N", "constant force to touch [ratio, recess, time]"),
            "time_to_touch": _quantity(moment, "s", "time to touch, null if never [ratio, recess, force]"),
            "touches": _quantity(touches, "1", "whether the tissue touches [ratio, recess, force, time]"),
            "deepest_recess_recommended": _quantity(limits[0], "m", "recess just touched at the recommended force [ratio, time]"),
            "deepest_recess_largest": _quantity(limits[1], "m", "recess just touched at the largest force [ratio, time]"),
            "touch_displacement_over_radius": _quantity(
                depth / self.outer_radius, "1", "displacement over outer radius at touch [ratio, recess]"
            ),
        }

    @property
    def _limits(self) -> tuple[float, float]:
        return self.recommended_force, self.largest_force

    def _point(self) -> dict[str, Quantity]:
        """The design point as printed, displacement against recess by 4.6.4, and exactly."""
        point, exact = self.design_point, self.annulus(self.design_point.ratio)
        thesis = atrial_shear_compliance("viscosities", "half_shear")
        printed = ViscoelasticAnnulus(self.outer_radius, point.ratio, thesis, "thesis_4_2_21")
        as_printed = printed.creep_displacement(point.force, point.time)
        displacement = exact.above_base(exact.creep_displacement(point.force, point.time))
        rise = exact.touch_factor * displacement
        touches = rise >= point.recess and np.isfinite(exact.touch_displacement(point.recess))
        return {
            "point_displacement_printed": _quantity(as_printed, "m", "design point: displacement as printed, eq. 4.6.4"),
            "point_touches_printed": _quantity(
                as_printed >= point.recess, "1", "design point: displacement >= recess, as in 4.7"
            ),
            "point_displacement": _quantity(displacement, "m", "design point: displacement"),
            "point_rise": _quantity(rise, "m", "design point: largest rise of the tissue in the hole"),
            "point_touches": _quantity(touches, "1", "design point: whether the tissue touches"),
            "point_force_to_touch": _quantity(
                exact.force_to_touch(point.recess, point.time), "N", "design point: force to touch"
            ),
            "point_time_to_touch": _quantity(
                exact.time_to_touch(point.recess, point.force), "s", "design point: time to touch, none if never"
            ),
        }

    def _assumptions(self) -> list[str]:
        body = "half-space" if self.thickness is None else f"{self.base} layer of {format_quantity(self.thickness, 'm')}"
        return [
            f"linear, incompressible tissue as a {body}, rigid frictionless flat annulus with sharp edges, flat surface",
            f"Table 4.1 with its times as {self.tissue.times} and its compliance as {self.tissue.compliance}: "
            "the thesis uses two readings of each",
            f"outer radius {format_quantity(self.outer_radius, 'm')} (chapter 4 prints none; 3 mm in chapter 3)",
            "the tissue was tested from 1 Hz to 36 Hz, times of 4 ms to 0.16 s: longer ones are extrapolated",
            f"small displacements end at {SMALL_DISPLACEMENT:g} of the outer radius, by convention",
        ]


def _quantity(values: Any, unit: str, description: str) -> Quantity:
    """Plain values, None where they are infinite."""
    array = np.asarray(values)
    plain = array.astype(object)
    plain[~np.isfinite(array)] = None
    return Quantity(plain.tolist(), unit, description)


def _judged(quantities: dict[str, Quantity]) -> str:
    """The design point in words."""
    rise = quantities["point_rise"].value
    words = "touches" if quantities["point_touches"].value else "does not touch"
    if rise is None:
        return f"at the design point the annulus would be pressed to the base of the layer; the tissue {words} before"
    return f"at the design point the tissue rises by {format_quantity(rise, 'm')} and {words}"


def _warnings(quantities: dict[str, Quantity]) -> Iterator[str]:
    if not quantities:
        return
    outside = np.mean(quantities["outside_small_displacement"].value)
    if outside:
        yield f"{100 * outside:.0f} % of the map has a displacement beyond {SMALL_DISPLACEMENT:g} of the outer radius"
    touching = quantities["touch_displacement_over_radius"].numbers
    beyond = np.mean(touching > SMALL_DISPLACEMENT)
    if beyond:
        yield f"{100 * beyond:.0f} % of the sensors are touched only beyond that, where linear theory is no more than a hint"
    base = "would be pressed to the base of the layer, where nothing is reported"
    pressed = np.mean(np.isnan(quantities["displacement"].numbers))
    if pressed:
        yield f"in {100 * pressed:.0f} % of the map the annulus {base}"
    if never := np.mean(np.isnan(touching)):
        yield f"{100 * never:.0f} % of the sensors {base}, before they are touched"
