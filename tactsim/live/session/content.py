"""What a page is opened on: a result, a data set, a live feed, and the reference that goes with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tactsim.errors import InputError
from tactsim.live.session.choices import Choice, learned_choice, offered_choices, stored_choice
from tactsim.live.sources.feed import Feed
from tactsim.live.sources.recorded import result_recordings
from tactsim.live.sources.reference import Reference
from tactsim.live.sources.samples import Samples
from tactsim.live.sources.scene import Recording
from tactsim.results.reading import result_folder

LIVE = "live"
"""Name of the feed among the sources of forces."""


@dataclass(frozen=True, eq=False)
class Content:
    """Several pages may show the same content; only the feed changes, by itself."""

    recordings: dict[str, Recording]
    samples: Samples | None = None
    feed: Feed | None = None
    reference: Reference | None = None
    noise: float | None = None
    """Standard deviation in N of a reading, instead of what the data say."""
    choices: tuple[Choice, ...] = field(default_factory=offered_choices)
    """Estimators that can be chosen, the first one at the beginning."""

    @property
    def by_name(self) -> dict[str, Choice]:
        """The estimators by their names."""
        return {choice.name: choice for choice in self.choices}


def opened_content(
    place: Path | None,
    *,
    feed: Feed | None = None,
    reference: Sequence[str] = (),
    noise: float | None = None,
    learned: str | None = None,
) -> Content:
    """The content of a result's folder or a data set, with a feed, a reference, a noise in N and weights if they are given.

    Raises
    ------
    InputError
        If there is nothing to show, or it has no taxels, or a data set has no sample that is done; if there are no weights.
    StorageError
        If a folder is no result and no data set, or is damaged.
    """
    if place is None and feed is None:
        raise InputError("nothing to show; name the folder of a result or a data set, or --live FILE, - or tcp://127.0.0.1:PORT")
    given = Reference.open(reference) if reference else None
    choices = offered_choices() if learned is None else (*offered_choices(), learned_choice(learned))
    if place is None:
        return Content({}, None, feed, given, noise, choices)
    if (place / "zarr.json").is_file():
        return Content({}, Samples.open(place), feed, given, noise, choices)
    folder = result_folder(place)
    stored = stored_choice(folder)
    return Content(result_recordings(folder), None, feed, given, noise, choices if stored is None else (stored, *choices))
