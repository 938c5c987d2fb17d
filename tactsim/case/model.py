"""What a case file may hold: one experiment out of those registered, a title, and what to write."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from tactsim.errors import CaseError, shown
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Progress
from tactsim.interfaces.variation import Variation, check_key_paths, check_places
from tactsim.model import FrozenModel
from tactsim.outside.library_warnings import collected_warnings
from tactsim.presenter import presenter
from tactsim.registry import Registered, kind_class
from tactsim.results.provenance import provenance
from tactsim.results.result import Result

SCHEMA = "tactsim/case/1"


class Output(FrozenModel):
    """What a run writes beside its quantities."""

    fields: Literal["all", "last", "none"] = "all"
    """Accepted steps whose fields are written for ParaView."""


class Case(FrozenModel):
    """A validated case: every value in SI, every default filled in.

    >>> import tactsim as ts
    >>> case = ts.load_case("annulus_dynamic_load", {"experiment.points": 20})
    >>> case.experiment.kind
    'closed_form'
    >>> f"{case.run()['largest_displacement'].to('um'):.1f}"
    '938.3 um'
    """

    schema_version: Literal["tactsim/case/1"] = Field(alias="schema")
    """Version of the case format."""
    title: str = Field(default="", max_length=200)
    """One line that says what the case is."""
    experiment: Annotated[Experiment, Registered(Experiment)]
    """What to compute."""
    output: Output = Output()
    """What to write."""

    def __reduce__(self) -> tuple[Any, ...]:
        experiment = None if type(self) is Case else type(self.experiment)
        return _unpickled, (experiment,), self.__getstate__()

    def _repr_html_(self) -> str:
        text: str = presenter().case_html(self)
        return text

    @property
    def case_id(self) -> str:
        """Sixteen hexadecimal digits that are the same for every spelling of the same case.

        The hash of the canonical JSON of ``resolved()``, numbers to twelve significant digits.
        """
        text = json.dumps(_canonical(self.resolved()), sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def run(self, progress: Progress | Literal["bar"] | None = "bar", *, time_limit: float | str | None = None) -> Result:
        """Run the experiment; the result knows the title, the case and what it rests on.

        Parameters
        ----------
        progress : called with the record of each accepted step; by default a bar on a terminal and in a notebook, None is silent
        time_limit : s, or text such as "5 min"

        Raises
        ------
        InputError, Unfinished
            As `Experiment.run`.
        """
        with collected_warnings() as caught:
            result = self.experiment.run(progress, time_limit=time_limit)
        return replace(result, title=self.title, provenance=self.provenance(), warnings=(*result.warnings, *caught.lines()))

    def vary(self, places: Mapping[str, Any]) -> Variation:
        """The case with distributions at some places: ``{"experiment.thickness": tactsim.uniform("2 mm", "6 mm")}``.

        A place is a key path as in the case file; `tactsim.sweep` computes the samples, which keep the title of the case.

        >>> import tactsim as ts
        >>> case = ts.load_case("annulus_dynamic_load")
        >>> case.vary({"experiment.outer_radius": ts.uniform("2 mm", "4 mm")})
        <Variation of closed_form: outer_radius={'uniform': ['2 mm', '4 mm']}>

        Raises
        ------
        CaseError
            If it has no such place or one of another dimension, a place is not in the experiment, or the places are no mapping
            from key paths.
        """
        check_key_paths(places)
        within = {}
        for place, distribution in places.items():
            section, _, key = place.partition(".")
            if section != "experiment" or not key:
                near = f" (did you mean 'experiment.{place}'?)" if section in type(self.experiment).model_fields else ""
                expected = "expected a key path of the case file, such as 'experiment.material'"
                raise CaseError(f"vary: {shown(place)} is not within the experiment{near}; {expected}")
            within[key] = distribution
        check_places(self.experiment, within)
        return Variation(self.experiment, within, self)

    def at_rest(self) -> Result:
        """What would be computed: the tissue with its mesh and the bodies that press on it, as a result that has a sketch.

        Raises
        ------
        InputError
            If the kind of the experiment has no body with a mesh.
        """
        return replace(self.experiment.at_rest(), title=self.title, provenance=self.provenance())

    def provenance(self, *, case_file: str = "", overrides: Sequence[str] = ()) -> dict[str, Any]:
        """What a result of this case rests on; see ``results.provenance``."""
        seeds = self.experiment.seeds()
        return provenance(self.resolved(), self.case_id, case_file=case_file, overrides=overrides, seeds=seeds)

    def resolved(self) -> dict[str, Any]:
        """The case as plain JSON values in SI with every default filled in."""
        return self.model_dump(mode="json", by_alias=True)


def experiment_class(kind: str) -> type[Experiment]:
    """The experiment of this kind; the modules of the others are loaded only if none bears its name.

    Raises
    ------
    UnknownName
        With the nearest kind.
    """
    known: type[Experiment] = kind_class(Experiment, kind)
    return known


@cache
def case_class(experiment: Any) -> type[Case]:
    """The case whose experiment has this type, which may be ``Any`` to check everything else."""
    return create_model("Case", __base__=Case, __doc__=vars(Case)["__doc__"], experiment=(experiment, ...))


def _unpickled(experiment: type[Experiment] | None) -> Case:
    """The case before its state is set; pickle does not find by its name the class that ``case_class`` makes."""
    made = Case if experiment is None else case_class(experiment)
    return made.__new__(made)


def any_experiment() -> Any:
    """The type of all registered experiments, told apart by ``kind``."""
    return Annotated[Experiment, Registered(Experiment)]


def _canonical(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _canonical(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_canonical(item) for item in value]
    return float(f"{value:.12g}") + 0.0 if isinstance(value, float) else value
