"""Computes samples: what a worker does, wherever it runs."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.cost import cost_of
from tactsim.dataset.sampling.drawing import Drawn, drawn_specimen, noise_generator, used_seed
from tactsim.dataset.sampling.layout import Layout, layout_of, split_of
from tactsim.dataset.sampling.sweep import Sweep, sweep_of_text
from tactsim.dataset.store.arrays import CHECKSUM_BYTES, DONE, FAILED
from tactsim.dataset.store.blocks import checksum, encoded, stacked
from tactsim.errors import CaseError, InvalidQuantity, TactsimError
from tactsim.experiments.recording import numbers as numbers_of
from tactsim.outside.defect_place import place_of
from tactsim.outside.library_warnings import collected_warnings
from tactsim.outside.text import one_line
from tactsim.results.result import Status

LONGEST_REASON, LONGEST_WARNINGS = 500, 2000
"""Characters at which the stored reason of a sample, and its stored warnings, are cut."""


def computed(text: str, samples: Sequence[int], lost: str = "", *, folder: str | None = None) -> bytes:
    """The samples of these numbers as bytes of a block.

    Parameters
    ----------
    text : of the sweep
    lost : the reason for which the samples are given up; nothing is run then
    folder : of the sweep's file, in which the files that it names are looked for first

    Raises
    ------
    CaseError
        If the text is not that of a sweep, or what it stores is wrong for every sample.
    """
    sweep = sweep_of_text(text, folder)
    layout = layout_of(sweep)
    done = []
    for specimen, numbers in itertools.groupby(samples, key=lambda number: number // sweep.per_specimen):
        drawn = drawn_specimen(sweep, specimen)
        split = _split(sweep, layout, drawn)
        done += [_sample(sweep, layout, drawn[number - drawn[0].sample], split, lost) for number in numbers]
    return encoded(stacked(done, layout.variables))


def _split(sweep: Sweep, layout: Layout, drawn: Sequence[Drawn]) -> int:
    """Number of the part of a specimen whose samples are these; 0 if no draw of it was possible."""
    possible = [one.case.experiment for one in drawn if one.case is not None]
    if not possible:
        return 0
    known = {variable.name: variable for variable in layout.variables}
    return split_of(sweep, drawn[0].specimen, map(layout.recorder.labels, possible), known)


def _sample(sweep: Sweep, layout: Layout, drawn: Drawn, split: int, lost: str) -> dict[str, Array]:
    begin = time.perf_counter()
    values: dict[str, Any] = {
        "sample": drawn.sample,
        "specimen": drawn.specimen,
        "split": split,
        "seed": used_seed(sweep, drawn),
        "redraws": drawn.redraws,
        "code": 0,
        "case_id": drawn.case.case_id if drawn.case else "",
    }
    values |= {place.variable: drawn.values.get(place.path, np.nan) for place in sweep.places}
    status, reason = FAILED, lost or drawn.refusal
    if drawn.case is not None:
        values |= layout.recorder.labels(drawn.case.experiment)
        if not lost:
            with collected_warnings() as collected:
                status, reason, read = _run(sweep, layout, drawn)
            reason = "; ".join([reason, *collected.lines()])
            values |= read
    values |= {"status": status, "reason": " ".join(reason.split())[:LONGEST_REASON]}
    values |= {"wall_time": time.perf_counter() - begin, "checksum": np.zeros(CHECKSUM_BYTES, np.uint8)}
    sample = _complete(values, layout)
    return sample | {"checksum": checksum(sample, layout.variables)}


def _run(sweep: Sweep, layout: Layout, drawn: Drawn) -> tuple[int, str, dict[str, Any]]:
    """Status, reason, and readings, cost and warnings of a case; whatever goes wrong in it is the reason of this sample alone."""
    assert drawn.case is not None
    try:
        result = drawn.case.experiment.run(None, time_limit=sweep.settings.time_limit)
        if result.status is not Status.CONVERGED:
            return FAILED, f"{result.status}: {result.reason}", cost_of(result)
        readings = layout.recorder.readings(drawn.case.experiment, result, noise_generator(sweep, drawn.sample))
        values = numbers_of(layout.recorder, result) | readings
        _check(values, layout)
    except CaseError:
        raise  # what the sweep stores is wrong for every sample
    except (TactsimError, MemoryError) as error:
        return FAILED, f"{type(error).__name__}: {error}", {}
    except Exception as error:  # noqa: BLE001  a defect in a kind of the user's own ends no other sample
        return FAILED, f"{type(error).__name__}: {error}; from {place_of(error)}", {}
    warnings = "\n".join(map(one_line, result.warnings))[:LONGEST_WARNINGS]
    return DONE, result.reason, {**cost_of(result), **values, "warnings": warnings}


def _check(values: dict[str, Array], layout: Layout) -> None:
    for name, value in values.items():
        variable = layout.named(name)
        if np.shape(value) != variable.sizes:
            raise InvalidQuantity(f"{name} has the shape {np.shape(value)}; the store has {variable.sizes}: sizes must not vary")
        if not (variable.optional or np.isfinite(value).all()):
            raise InvalidQuantity(f"{name} is not finite")


def _complete(values: dict[str, Any], layout: Layout) -> dict[str, Array]:
    """Every variable with its type, those without a value filled."""
    sample: dict[str, Any] = {"sample": values["sample"]}
    for variable in layout.variables:
        value = values.get(variable.name)
        if value is None:
            sample[variable.name] = variable.empty(1)[0]
        elif variable.dtype == "str":
            sample[variable.name] = str(value)
        else:
            sample[variable.name] = np.asarray(value, dtype=variable.dtype)
    return sample
