"""The thinnest specimen that an annular sensor accepts."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field

from tactsim.errors import CaseError
from tactsim.units import Length
from tactsim.validation.evaluator import Evaluator, Inputs


class LeastThickness(Evaluator):
    """Thickness in m below which a case is refused, by bisection: every specimen above it is accepted."""

    unit: ClassVar[str] = "m"
    kind: Literal["least_thickness"] = "least_thickness"
    case: str
    """Case file, relative to the table."""
    between: tuple[Annotated[Length, Field(gt=0)], Annotated[Length, Field(gt=0)]]
    """A thickness that is refused and one that is accepted."""
    bisections: Annotated[int, Field(ge=1, le=60)] = 24
    """How often the interval is halved."""

    @classmethod
    def example(cls) -> Self:
        """Around the recess of 0.8 mm."""
        return cls(case="../annulus_icf.yaml", between=(0.4e-3, 2e-3))

    def found(self, inputs: Inputs) -> float:
        """In m."""
        refused, accepted = self.between
        for end, wanted in ((refused, False), (accepted, True)):
            if self._accepts(inputs, end) != wanted:
                raise CaseError(f"{self.case}: a thickness of {end:g} m is {'refused' if wanted else 'accepted'}")
        for _ in range(self.bisections):
            middle = (refused + accepted) / 2
            refused, accepted = (refused, middle) if self._accepts(inputs, middle) else (middle, accepted)
        return accepted

    def _accepts(self, inputs: Inputs, thickness: float) -> bool:
        """Whether the case is valid with this thickness, and a displacement of half of it."""
        from tactsim.case import load_case

        overrides = {"specimen.thickness": thickness, "displacement": thickness / 2}
        try:
            load_case(inputs.folder / self.case, [f"experiment.{key}={value!r} m" for key, value in overrides.items()])
        except CaseError:
            return False
        return True
