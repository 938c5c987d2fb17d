"""Seven elastomers by inverse simulation: modulus from the sensor's threshold, then the reading of a durometer on it."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tactsim.analytic.durometer import ASSUMED, DurometerScale
from tactsim.contact.annulus import Annulus
from tactsim.contact.any_law import AnyLaw
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.rod import Rod
from tactsim.errors import Unfinished
from tactsim.experiments.durometer.durometer import Durometer
from tactsim.experiments.durometer.elastomer_report import RankingReport, ShapeFinding
from tactsim.experiments.durometer.elastomers import STABLE_SHAPES, TABLE_3_3, Elastomer, Reading, Shape
from tactsim.experiments.durometer.force_depth_curve import ForceDepthCurve
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, run_within_another
from tactsim.materials.moduli import youngs_modulus
from tactsim.mechanics.models.specimen import Specimen
from tactsim.model import FrozenModel
from tactsim.results.result import Status, StepRecord
from tactsim.units import Length, Positive, Time, format_quantity


class SpecimenSize(FrozenModel):
    """Size of a cylindrical specimen on a fixed base, of any of the materials."""

    thickness: Positive[Length] = 10e-3
    """Thickness."""
    radius: Positive[Length] = 15e-3
    """Radius."""

    def of(self, shape: Shape) -> Specimen:
        """The specimen of a material."""
        return Specimen(material=shape.material, thickness=self.thickness, radius=self.radius)


class SensorTest(FrozenModel):
    """The annular sensor pressed to its threshold."""

    specimen: SpecimenSize = SpecimenSize()
    """What is pressed."""
    body: Annulus = Annulus(fillet=0.4e-3)
    """The filler plate; a neo-Hookean energy gives way at a sharper edge before the threshold."""
    recess: Positive[Length] = 0.8e-3
    """Depth of the inner sensor."""
    contact: AnyLaw = Coulomb()
    """Friction."""
    displacement: Positive[Length] = 8e-3
    """Most that is tried."""
    mesh: MeshSettings = MeshSettings(finest=0.2e-3, growth=0.6)
    """Size of the elements."""

    def of(self, shape: Shape) -> Indentation:
        """The simulation on a material."""
        return Indentation(
            specimen=self.specimen.of(shape),
            body=self.body,
            recess=self.recess,
            contact=self.contact,
            displacement=self.displacement,
            mesh=self.mesh,
        )


class DurometerTest(FrozenModel):
    """The durometer pressed over its whole travel."""

    specimen: SpecimenSize = SpecimenSize()
    """What is measured."""
    indentor: Rod = Rod()
    """The indentor."""
    scale: DurometerScale = DurometerScale()
    """Travel and spring."""
    contact: AnyLaw = Coulomb()
    """Friction."""
    mesh: MeshSettings = MeshSettings(growth=0.8, adaptive=False)
    """Size of the elements."""

    def of(self, shape: Shape) -> Durometer:
        """The simulation on a material, past the reading to the whole travel."""
        return Durometer(
            specimen=self.specimen.of(shape),
            indentor=self.indentor,
            scale=self.scale,
            contact=self.contact,
            stop="travel",
            mesh=self.mesh,
        )


class AtriumTest(FrozenModel):
    """Porcine atrium: what the durometer read, and the tissue of Table 4.1."""

    reading: Reading = 25.0
    """Shore reading, thesis 3.2."""
    times: Annotated[tuple[Positive[Time], ...], Field(min_length=1)] = (1e-3, 10e-3, 0.1, 1.0, 10.0)
    """Times after the load at which the creep modulus 1/D(t) is taken."""
    shape: str | None = None
    """Shape of energy of the tissue; by default the last one."""


class ElastomerRanking(Experiment):
    r"""Modulus of each elastomer from its threshold pressure, and the durometer's reading on a material of that modulus.

    .. math:: p = E\, \hat p, \qquad F(d) = E\, f(d)

    An exactly incompressible energy that is a modulus times a fixed shape has the same deformation for every modulus at the same
    displacements. One run per shape therefore gives the threshold, one more the force-depth curve, of every elastomer.

    Source: thesis, 3.1.3, 3.2 and Table 3.3.
    """

    kind: Literal["elastomer_ranking"] = "elastomer_ranking"
    elastomers: Annotated[tuple[Elastomer, ...], Field(min_length=3)] = TABLE_3_3
    """What was measured."""
    shapes: Annotated[tuple[Shape, ...], Field(min_length=1)] = STABLE_SHAPES
    """Energies that the elastomers are given."""
    sensor: SensorTest = SensorTest()
    """The annular sensor."""
    durometer: DurometerTest = DurometerTest()
    """The durometer."""
    atrium: AtriumTest = AtriumTest()
    """Porcine atrium."""

    history_units: ClassVar[dict[str, str]] = Indentation.history_units | Durometer.history_units | RankingReport.UNITS

    @model_validator(mode="after")
    def _possible(self) -> Self:
        for what, given in (("elastomers", self.elastomers), ("shapes", self.shapes)):
            names = [one.name for one in given]
            if len(set(names)) < len(names):
                raise ValueError(f"two {what} have the same name: {', '.join(names)}")
        known = [elastomer.name for elastomer in self.elastomers]
        for shape in self.shapes:
            if shape.material.bulk_modulus is not None or shape.material.relaxation is not None:
                raise ValueError(f"the shape {shape.name} must be incompressible and without relaxation, or it does not scale")
            if shape.constants_of is not None and shape.constants_of not in known:
                raise ValueError(f"constants_of {shape.constants_of!r} is none of the elastomers {', '.join(known)}")
            _ = self.sensor.of(shape), self.durometer.of(shape)
        shapes = [shape.name for shape in self.shapes]
        if self.atrium.shape is not None and self.atrium.shape not in shapes:
            raise ValueError(f"atrium.shape {self.atrium.shape!r} is none of the shapes {', '.join(shapes)}")
        return self

    @classmethod
    def example(cls) -> Self:
        """Table 3.3 with a neo-Hookean energy alone."""
        return cls(shapes=STABLE_SHAPES[2:])

    def begin(self) -> Course:
        """Two simulations per shape, then one step per shape and elastomer."""
        report = RankingReport(self.elastomers, self.durometer.scale, self.durometer.indentor.radius)
        kept = "the shapes that were finished are kept, the run is incomplete"
        return Course(self._ranked(report), lambda: report.findings(self._assumptions()), kept)

    def _ranked(self, report: RankingReport) -> Iterator[StepRecord]:
        for shape in self.shapes:
            yield from report.add((yield from self._finding(shape)))
        shapes = [shape.name for shape in self.shapes]
        report.add_atrium(self.atrium.reading, self.atrium.times, shapes.index(self.atrium.shape or shapes[-1]))

    def _finding(self, shape: Shape) -> Generator[StepRecord, None, ShapeFinding]:
        """Yields the steps of both simulations of a shape, and returns its threshold and its force-depth curve.

        Raises
        ------
        Unfinished
            If the threshold was not reached, or the durometer made no curve.
        """
        pressed = yield from run_within_another(self.sensor.of(shape))
        indented = yield from run_within_another(self.durometer.of(shape))
        if pressed.status is not Status.CONVERGED or len(indented.steps) < 2:
            raise Unfinished(f"{shape.name}: sensor {pressed.reason}; durometer {indented.reason}")
        modulus = youngs_modulus(shape.material.shear_modulus, None)
        threshold = {name: float(pressed.quantities[f"threshold_{name}"].value) for name in ("pressure", "displacement")}
        cut_short = "" if indented.status is Status.CONVERGED else indented.reason
        return ShapeFinding(
            shape=shape,
            youngs_modulus=modulus,
            threshold_pressure=threshold["pressure"],
            threshold_displacement=threshold["displacement"],
            curve=ForceDepthCurve.of(indented, modulus),
            cut_short=cut_short,
        )

    def _assumptions(self) -> list[str]:
        sizes = (("sensor", self.sensor.specimen), ("durometer", self.durometer.specimen))
        assumptions = [
            f"specimen under the {name}: radius {format_quantity(size.radius, 'm')}, thickness "
            f"{format_quantity(size.thickness, 'm')}, on a fixed base (from the case; the thesis prints none)"
            for name, size in sizes
        ]
        assumptions.append(ASSUMED)
        assumptions.append(
            "all elastomers share the shape of energy, so that the threshold and the predicted reading rank them alike"
        )
        assumptions.append("exactly incompressible, elastic and homogeneous (H1-N is said to be denser at its surface)")
        assumptions.append(
            "Table 4.1 as creep compliance 1/E with retardation times in s, the modulus at a time taken as its reciprocal"
        )
        return assumptions
