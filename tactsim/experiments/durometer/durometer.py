"""A durometer on soft material: the depth at which the tissue bears the spring, and the reading there."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal, Self

from pydantic import model_validator

from tactsim.analytic.durometer import DurometerScale, hertz_depth
from tactsim.contact.any_law import AnyLaw
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.rod import Rod
from tactsim.experiments.indentation.displaced import StepSettings
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.indentation.history import history_units
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.fem.paths.loading import Event
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.materials.moduli import youngs_modulus
from tactsim.mechanics.contact.penetration_bounds import check_penetration, default_penetration
from tactsim.mechanics.models.specimen import Specimen
from tactsim.units import Force, Length, NonNegative, Positive, format_quantity

if TYPE_CHECKING:
    from tactsim.experiments.indentation.course import Adapted, DisplacementPath
    from tactsim.mechanics.paths.history_path import TimedState

LEAST_THICKNESS = 6e-3
"""Thickness in m of a specimen that ASTM D2240 asks for; recalled, a declared assumption."""
READING_TOLERANCE = 1e-5
"""Tolerance of the depth at the reading, as a part of the travel: a thousandth of a unit."""


class Durometer(Experiment):
    r"""A spring-loaded indentor pressed to the depth at which tissue and spring balance.

    .. math:: F_{\mathrm{tissue}}(d) = F_0 + k H, \qquad d = L (1 - H / 100)

    Source: ASTM D2240, type OO, by its declared dimensions; thesis, 3.1.3 and Table 3.3.
    """

    kind: Literal["durometer"] = "durometer"
    specimen: Specimen
    """What is measured; at least 6 mm thick."""
    contact: AnyLaw = Coulomb()
    """Friction between tissue and indentor."""
    indentor: Rod = Rod()
    """The indentor; 2.38 mm in diameter for type OO."""
    scale: DurometerScale = DurometerScale()
    """Travel and spring; type OO."""
    spring_tolerance: NonNegative[Force] = 0.00908
    """Uncertainty of the spring's force, which makes the interval of the reading; by default one unit of type OO."""
    stop: Literal["reading", "travel"] = "reading"
    """Whether the run ends at the reading, or goes on over the whole travel."""
    penetration_tolerance: Positive[Length] | None = None
    """Largest penetration at any surface quadrature point; by default 1e-3 of the indentor's radius, 0.05 units of type OO, and
    on hard material 2e-3 of the depth by Hertz. At most a tenth of that radius, of the travel and of the thinnest layer."""
    mesh: MeshSettings = MeshSettings(growth=0.8, adaptive=False)
    """Size of the elements."""
    steps: StepSettings = StepSettings()
    """Length of the load steps; by default the first a fiftieth, the largest a tenth of the indentor's radius."""

    history_units: ClassVar[dict[str, str]] = {
        name: unit
        for name, unit in history_units(clock=False, space=False).items()
        if name not in ("tissue_rise", "tissue_rise_axis", "sensor_force")
    } | {"spring_force": "N", "hertz_force": "N"}

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.specimen.thickness < LEAST_THICKNESS:
            given, least = (format_quantity(value, "m") for value in (self.specimen.thickness, LEAST_THICKNESS))
            raise ValueError(f"a durometer needs a specimen of at least {least} (ASTM D2240); this one is {given} thick")
        if self.scale.travel >= self.specimen.thickness:
            given, most = (format_quantity(value, "m") for value in (self.scale.travel, self.specimen.thickness))
            raise ValueError(f"scale.travel {given} must be smaller than the specimen's thickness {most}")
        if any(material.relaxation is not None for material in self.specimen.materials):
            raise ValueError(
                "a durometer is read without regard to time; give the constants at the time of reading, no relaxation"
            )
        lengths = {"travel": self.scale.travel, "indentor's radius": self.indentor.radius}
        check_penetration(self.penetration_tolerance, lengths)
        _ = self.indentation
        return self

    @property
    def indentation(self) -> Indentation:
        """The indentation over the whole travel."""
        radius, given = self.indentor.radius, self.steps
        first, largest = given.first or radius / 50, given.largest or radius / 10
        return Indentation(
            specimen=self.specimen,
            body=self.indentor,
            contact=self.contact,
            penetration_tolerance=self.penetration_tolerance or default_penetration(1e-3 * radius, self._expected_depth),
            stop="displacement",
            displacement=self.scale.travel,
            mesh=self.mesh,
            steps=StepSettings(first=first, largest=largest, smallest=given.smallest),
        )

    @property
    def _expected_depth(self) -> float:
        """Depth in m by Hertz under the whole force of the spring: near the reading where the surface is hard."""
        surface = self.specimen.materials[0]
        modulus = youngs_modulus(surface.shear_modulus, surface.bulk_modulus)
        return min(self.scale.travel, hertz_depth(float(self.scale.spring_force(0.0)), self.indentor.radius, modulus))

    @classmethod
    def example(cls) -> Self:
        """A specimen of the hard elastomer of chapter 3."""
        return cls(specimen=Specimen(material="b1a_stable"))

    def begin(self) -> Course:
        """Press until tissue and spring balance; see ``DurometerRecord`` for what is reported."""
        from tactsim.experiments.durometer.report import DurometerRecord
        from tactsim.experiments.indentation.course import DisplacementPath

        setup = self.indentation
        model = setup.model()
        path = DisplacementPath(setup, setup.drive(), model)
        record = DurometerRecord(setup, model, path, scale=self.scale, spring_tolerance=self.spring_tolerance)
        steps = (record.accept(state, event=balanced) for state, balanced in self._balanced(path, record.adapted))
        return Course(steps, record.findings, setup_is_timed=True)

    def _balanced(self, path: DisplacementPath, adapted: Adapted) -> Iterator[tuple[TimedState, bool]]:
        """Accepted states, each with whether tissue and spring balance in it."""
        from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium

        def surplus(state: ContactEquilibrium) -> float:
            return float(path.model.force(state.contacts[0].state.traction)[-1]) - float(self.scale.spring_force(state.load))

        event = Event[ContactEquilibrium](surplus, tolerance=READING_TOLERANCE * self.scale.travel)
        for state, balanced in path.follow(path.start, event, adapted):
            yield state, balanced
        if balanced and self.stop == "travel":
            yield from path.follow(state.contact, None, adapted)
