"""The sensor film of a case file: any registered kind, a piezoresistive one if no ``kind`` is named."""

from __future__ import annotations

from typing import Annotated

from tactsim.interfaces import SensorFilm
from tactsim.registry import Registered

AnyFilm = Annotated[SensorFilm, Registered(SensorFilm, default="film")]
"""Pydantic type of a film of any kind."""
ConductingFilm = Annotated[
    SensorFilm,
    Registered(
        SensorFilm,
        lambda cls: cls.signal == "conductance",
        default="film",
        unfit="has no conductance, which is what a voltage divider reads",
    ),
]
"""Pydantic type of a film that a divider can read."""
