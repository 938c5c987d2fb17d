"""The section ``sweep`` of a sweep file: design, seed, specimens, splits, and what is stored."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from tactsim.dataset.store.arrays import MOST_SAMPLES
from tactsim.experiments.recording import RecordingSettings
from tactsim.model import FrozenModel
from tactsim.refusals import as_written
from tactsim.units import NonNegative, Positive, Time

NO_SPLIT = "none"
LICENCE = "CC-BY-4.0"
OF_THE_CARD = ("title", "limits", "license")
"""Settings of the card alone."""
DesignName = Literal["sobol", "latin_hypercube", "random", "grid"]
"""How the unit cube of what varies is covered."""


class Condition(FrozenModel):
    """What the label of a sample must satisfy; of an inclusion's label, all inclusions of the sample or any of them."""

    above: float | None = None
    """Greater than, in SI."""
    below: float | None = None
    """Less than, in SI."""
    equal: float | str | None = None
    """Equal to a number, or to a name such as tube."""
    of: Literal["all", "any"] = "all"
    """Inclusions that must satisfy it."""

    @field_validator("above", "below", mode="before")
    @classmethod
    def _in_si(cls, bound: Any) -> Any:
        if isinstance(bound, str):
            expected = "expected a number in SI without its unit, such as 0.0045 for 4.5 mm"
            raise ValueError(f"{as_written(bound)} is not allowed; {expected}")
        return bound

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.above is None and self.below is None and self.equal is None:
            raise ValueError("a condition needs above, below or equal")
        return self

    @property
    def empty(self) -> bool:
        """Whether no number satisfies it."""
        return self.above is not None and self.below is not None and self.above >= self.below


Share = Annotated[float, Field(ge=0, le=1)]


class Splits(FrozenModel):
    """To which part of the data set a specimen belongs; all samples of a specimen belong to the same."""

    train: Share = 0.8
    """Share of the specimens for training."""
    validation: Share = 0.1
    """Share for choosing between models; the rest is ``test``."""
    out_of_distribution: dict[str, dict[str, Condition]] = {}
    """Name -> conditions by label; a specimen with a sample that satisfies all of a name belongs to the first such name alone."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.train + self.validation > 1:
            default = "" if "validation" in self.model_fields_set else " (if not given)"
            raise ValueError(
                f"train {self.train:g} and validation {self.validation:g}{default} add up to more than 1; the rest is test"
            )
        for name in self.out_of_distribution:
            if name in ("train", "validation", "test", NO_SPLIT) or not name.isidentifier():
                raise ValueError(f"out_of_distribution.{name}: a split needs a name of letters, digits and _ that is not taken")
            if not self.out_of_distribution[name]:
                raise ValueError(f"out_of_distribution.{name}: no condition, so that every specimen would belong to it; name one")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parts, in the order of their numbers."""
        return ("train", "validation", "test", *self.out_of_distribution)


class SweepSettings(RecordingSettings):
    """How samples are drawn and what of them is stored."""

    design: DesignName = "sobol"
    """How the varied places are covered."""
    samples: Annotated[int, Field(ge=1, le=MOST_SAMPLES)] | None = None
    """Number of samples; of a grid it follows from the places."""
    seed: NonNegative[int] = 1
    """Sample k depends on the seed and on k only."""
    samples_per_specimen: Annotated[int, Field(ge=1, le=10_000)] = 1
    """Samples that share a specimen; of a grid it follows from the places."""
    within_specimen: tuple[str, ...] = ()
    """Key paths that are drawn anew for each sample of a specimen, such as experiment.loading.pieces.0.to."""
    redraws: Annotated[int, Field(ge=0, le=100_000)] = 100
    """How often a specimen is drawn again because its case was refused, before its samples are marked failed."""
    time_limit: Positive[Time] | None = None
    """Longest time that solving a sample may take, before it is marked failed; null allows any. It depends on the machine."""
    splits: Splits = Splits()
    """Parts of the data set."""
    title: Annotated[str, Field(max_length=200)] = ""
    """What the data set is, for its card."""
    limits: Annotated[str, Field(max_length=2000)] = ""
    """Known limits, for its card."""
    license: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9.+-]{0,79}$")] = LICENCE
    """Licence of the data, for its card: an identifier of SPDX, such as CC0-1.0."""
