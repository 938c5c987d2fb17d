"""A whole data set in one call: the store, its samples, its card and figures; `sweep` from Python, the same from a sweep file."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactsim.case.loading import SWEEP_SCHEMA, SWEEP_SECTION
from tactsim.case.overrides import set_value
from tactsim.case.writing import case_document
from tactsim.case.yaml_reading import Document, YamlProblems
from tactsim.dataset.running.executors import Executor, LocalWorkers
from tactsim.dataset.running.resuming import opened_run
from tactsim.dataset.running.run import SweepRun, Tally
from tactsim.dataset.sampling.sweep import Sweep, sweep_of_document
from tactsim.dataset.store.files import FIGURES
from tactsim.dataset.use.card import adopt_earlier_files, write_card
from tactsim.errors import CaseError, InputError, shown
from tactsim.interfaces.variation import Variation
from tactsim.model import plain
from tactsim.outside.files import named_path
from tactsim.outside.text import one_line
from tactsim.progress import count_bar
from tactsim.registry import kinds_outside
from tactsim.schema_of_model import unit_at
from tactsim.storage.own_files import ForeignFile, OwnFiles

if TYPE_CHECKING:
    import xarray

COUNTED = ("weights", "integer", "range")
"""Keys of a distribution whose numbers are not, or not all, values of the place."""


def sweep(
    variation: Variation,
    *,
    out: str | Path,
    samples: int | None = None,
    workers: int | None = None,
    resume: bool = False,
    accept_changed_code: bool = False,
    title: str = "",
    **settings: Any,
) -> xarray.Dataset:
    """Compute a data set from an experiment in which some places vary, and open it.

    An interruption keeps the samples that are done.

    >>> import tactsim as ts
    >>> varied = ts.ClosedForm.example().vary({"outer_radius": ts.uniform("2 mm", "4 mm"), "points": 5})
    >>> parts = {"train": 0.5, "validation": 0.5}
    >>> data = ts.sweep(varied, samples=8, out="annuli.zarr", workers=1, splits=parts)
    >>> data.sizes["sample"], data["varied_outer_radius"].attrs["units"]
    (8, 'm')

    Parameters
    ----------
    variation : of `Experiment.vary` or `Case.vary`
    out : folder of the data set
    samples : number of samples; of a grid it follows from the places
    workers : processes, by default one for each core if it pays
    resume : whether to go on in a data set that an earlier call left
    accept_changed_code : whether to go on although tactsim has changed since; what follows is marked with its code
    title : one line for the card; that of the case if there is none
    **settings : of the section ``sweep`` of a sweep file, such as ``seed``, ``design``, ``splits``

    Raises
    ------
    CaseError
        If a place, a distribution or a setting is wrong.
    InputError
        If nothing varies, the experiment, or what it is made of, is of a class that a worker process cannot load, there are no
        workers, or ``out`` is neither a path nor a text.
    StorageError
        If the place is taken or cannot be written.
    KeyboardInterrupt
        If it is interrupted; the message says what is kept and how to go on.
    """
    from tactsim.dataset.use.card import absent_lines
    from tactsim.dataset.use.loading import load

    asked = _sweep_of(variation, title, settings | ({} if samples is None else {"samples": samples}))
    out = named_path(out, "sweep: out")
    with (
        closing(LocalWorkers.of(asked, workers)) as executor,
        opened_run(asked, out, resume=resume, accept_changes=accept_changed_code) as run,
        _resumable(out),
        count_bar("samples", run.store.samples) as shown,
    ):
        troubles = card(run)
        interrupted = compute(run, executor, lambda tally: shown(tally.before + tally.done + tally.failed))
        troubles += finish(run)
        if not (left := len(run.store.pending())):
            troubles += [line.removeprefix("warning: ") for line in absent_lines(run.store, asked)]
    for trouble in dict.fromkeys(troubles):
        warnings.warn(trouble, stacklevel=2)
    if interrupted:
        kept = f"{run.store.samples - left} of {run.store.samples} samples are kept in {one_line(out)}"
        raise KeyboardInterrupt(f"{kept}; go on with resume=True")
    return load(out)


@contextmanager
def _resumable(out: str | Path) -> Iterator[None]:
    """A block whose interruption, such as a second one while the first is being handled, says how to go on."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"the samples that were done are kept in {one_line(out)}; go on with resume=True") from None


def _sweep_of(variation: Variation, title: str, settings: dict[str, Any]) -> Sweep:
    if not isinstance(variation, Variation):
        raise InputError(f"sweep: {shown(variation)} does not vary; expected experiment.vary({{'key.path': uniform(low, high)}})")
    whole = case_document(variation.case or variation.experiment, complete=True)
    document = Document(whole | {"title": title or whole["title"], "schema": SWEEP_SCHEMA})
    try:
        for place, distribution in variation.places.items():
            keys = place.split(".")
            set_value(document, ["experiment", *keys], _with_units(plain(distribution), variation.experiment, keys))
    except YamlProblems as error:
        raise CaseError(f"vary: {error}") from None
    document.value[SWEEP_SECTION] = settings
    foreign = kinds_outside("tactsim")
    for kind in _kinds_in(document.value):
        if kind in foreign:
            raise InputError(
                f"{foreign[kind]} is defined in this session, and the worker processes of a sweep cannot load it; run its cases "
                "one by one, or put the class into a module of the package"
            )
    return sweep_of_document(document)


def _kinds_in(value: Any) -> Iterator[str]:
    """Every kind that a plain document names."""
    if isinstance(value, dict):
        if isinstance(value.get("kind"), str):
            yield value["kind"]
        value = list(value.values())
    if isinstance(value, list | tuple):
        for item in value:
            yield from _kinds_in(item)


def _with_units(distribution: Any, experiment: Any, keys: list[str]) -> Any:
    """A value or a distribution of a place, its plain numbers in SI as everywhere in Python, with the unit that the place has."""
    path = tuple(int(key) if key.isdecimal() else key for key in keys)
    if not (unit := unit_at(type(experiment), experiment.model_dump(mode="json"), path)):
        return distribution
    if not isinstance(distribution, dict):
        return _in_si(distribution, unit)
    return {name: entries if name in COUNTED else _in_si(entries, unit) for name, entries in distribution.items()}


def _in_si(value: Any, unit: str) -> Any:
    if isinstance(value, list):
        return [_in_si(one, unit) for one in value]
    return f"{value!r} {unit}" if type(value) in (int, float) else value


def compute(run: SweepRun, executor: Executor, progress: Callable[[Tally], None]) -> bool:
    """Compute what is pending until the end or the first interruption; whether there was one."""
    try:
        run.compute(executor, progress)
    except KeyboardInterrupt:
        return True
    finally:
        executor.close()
    return False


def finish(run: SweepRun) -> list[str]:
    """Draw the figures of the card and write it; a warning for what could not be done, which never costs the data."""
    troubles = []
    try:
        from tactsim.dataset.figures.card import card_figures

        for name, draw in card_figures(run.store.path).items():
            OwnFiles(run.store.path).replace(f"{FIGURES}/{name}", draw())
    except Exception as error:  # noqa: BLE001  whatever drawing does wrong, the data must stand
        troubles.append(f"not every figure could be drawn: {type(error).__name__}: {one_line(error)}")
    return [*troubles, *card(run)]


def card(run: SweepRun) -> list[str]:
    """Write the card, unless another file stands in its place; a warning then."""
    from tactsim.dataset.figures.card import FIGURE_FILES

    try:
        adopt_earlier_files(run.store.path, FIGURE_FILES)
        write_card(run.store, run.sweep, run.layout)
    except ForeignFile as error:
        return [f"the card is not written: {error}"]
    return []
