"""The sensor film of a case file: any registered kind, a piezoresistive one if no ``kind`` is named."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator

from tactsim.interfaces import SensorFilm
from tactsim.registry import Registered
from tactsim.results.checked import NEEDED_TEXTS, are_texts


def _checked(film: SensorFilm) -> SensorFilm:
    """The film, if what it says of itself is texts: the letters of one would be as many assumptions."""
    by_method = {"assumptions": film.assumptions(), "warnings": film.warnings(film.largest_force)}
    for method, texts in by_method.items():
        if not are_texts(texts):
            raise ValueError(f"{method}() of {type(film).__name__} returned {texts!r:.60}; {NEEDED_TEXTS}")
    return film


AnyFilm = Annotated[SensorFilm, Registered(SensorFilm, default="film"), AfterValidator(_checked)]
"""Pydantic type of a film of any kind."""
ConductingFilm = Annotated[
    SensorFilm,
    Registered(
        SensorFilm,
        lambda cls: cls.signal == "conductance",
        default="film",
        unfit="has no conductance, which is what a voltage divider reads",
    ),
    AfterValidator(_checked),
]
"""Pydantic type of a film that a divider can read."""
