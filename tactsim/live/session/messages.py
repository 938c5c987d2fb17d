"""What the server sends to the page: a scene as JSON, a frame as JSON with numbers and pictures behind it."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.errors import TactsimError
from tactsim.experiments.grasp.figures.views import ESTIMATE, colour_table
from tactsim.interfaces.readings import Readings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.live.session.estimating import shown_signal
from tactsim.live.session.shapes import drawn_inclusions
from tactsim.live.sources.scene import Frame, PageScene
from tactsim.localization.views import SHAPE, views
from tactsim.outside.text import one_line

VIEWS = ("front", "left", "top")
TRUE_COLOUR = "#009e73"
"""Of the true inclusions; the colour-blind distinguish it from the estimate's, and the one is filled, the other lines."""
LEVELS = 255
LONGEST_TEXT = 1000
"""Characters of a note or a reason on the page: more than any of this program's own has."""


def scene_message(scene: PageScene, **more: Any) -> str:
    """The scene without the shapes of its inclusions; lengths in mm."""
    layout, size = scene.layout, scene.size
    middle = 1e3 * scene.grasp.middle
    jaws = [
        {"width": 1e3 * jaw.width, "depth": 1e3 * jaw.depth, "rotation": np.asarray(jaw.rotation).T.ravel().tolist()}
        for jaw in (scene.grasp.jaws[side] for side in JAWS)
    ]
    content = {
        "is": "scene",
        "title": scene.title,
        "size": (1e3 * size).tolist(),
        "rows": layout.rows,
        "columns": layout.columns,
        "taxel": 1e3 * layout.size,
        "pitch": 1e3 * layout.pitch,
        "area": layout.area,
        "x": (1e3 * layout.borders("x") + middle[0]).ravel().tolist(),
        "y": (1e3 * layout.borders("y") + middle[1]).ravel().tolist(),
        "jaws": jaws,
        "shape": SHAPE,
        "truth": scene.inclusions is not None,
        "colours": colour_table(LEVELS + 1),
        "true_colour": TRUE_COLOUR,
        "estimate_colour": ESTIMATE,
    }
    return plain_json(content | more)


def shapes_message(scene: PageScene) -> str:
    """The shapes of the true inclusions, which take up to a second or two for a curved artery."""
    return plain_json({"is": "shapes", "inclusions": drawn_inclusions(scene)})


def plain_json(content: Mapping[str, Any]) -> str:
    """Strict JSON, in which the texts of files and sensors are harmless: one line each, bounded, without control characters."""
    return json.dumps(_harmless(content), allow_nan=False, separators=(",", ":"))


def _harmless(value: Any) -> Any:
    if isinstance(value, str):
        return one_line(value, LONGEST_TEXT)
    if isinstance(value, Mapping):
        return {one_line(key): _harmless(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return value if value and isinstance(value[0], float | int) else [_harmless(item) for item in value]
    return value


class Scales:
    """Ends of the colour scales in N of the three views and of single taxels: the largest so far, so that frames compare."""

    def __init__(self) -> None:
        self.ends = np.zeros(len(VIEWS) + 1)

    def take(self, pictures: list[Array], forces: Array) -> None:
        """Lets a frame in: its ``pictures`` (rows, columns) and ``forces`` (jaw, row, column) in N."""
        largest = [float(picture.max(initial=0.0)) for picture in pictures]
        strongest = float(np.nan_to_num(forces, nan=0.0).max(initial=0.0))
        self.ends = np.maximum(self.ends, [*largest, strongest])

    def take_range(self, signals: list[tuple[Array, Array]]) -> None:
        """Lets signals (jaw, row, column) in N and forces in, without drawing them: pictures never exceed these sums.

        A section between two arrays is brightest where both add up (eq. .2.4); the top view has a section between any two rows.
        """
        for signal, forces in signals:
            both = np.maximum(signal, 0.0).sum(axis=0)
            pairs = both[:-1] + both[1:] if len(both) > 1 else both
            self.take([both.sum(axis=0), both.sum(axis=1), pairs], forces)


def frame_message(scene: PageScene, frame: Frame, readings: Readings | TactsimError, scales: Scales, **more: Any) -> bytes:
    """A frame: length of the JSON, JSON, then all forces as float32 and the three pictures as bytes, 255 at the scale's end.

    The JSON is filled up with spaces so that what follows begins at a multiple of four. Without usable readings the pictures are
    empty. Integers and floats are little-endian.
    """
    notes, meaning, forces = list(frame.notes()), "force", frame.shown_forces()
    if isinstance(readings, TactsimError):
        meaning, pictures = "", [np.zeros(SHAPE) for _ in VIEWS]
    else:
        signal, meaning = shown_signal(readings)
        three = views(signal, SHAPE)
        pictures = [three.front, three.left, three.top]
    scales.take(pictures, forces)
    content = {
        "is": "frame",
        "time": _known(frame.time),
        "closing": _known(frame.closing, 1e3),
        "places": (1e3 * scene.places_at(frame.closing)).tolist(),
        "invalid": np.flatnonzero(~frame.valid).tolist(),
        "scales": scales.ends.tolist(),
        "meaning": meaning,
        "notes": notes,
    }
    head = plain_json(content | more).encode()
    head += b" " * (-len(head) % 4)
    levels = [_levels(picture, end) for picture, end in zip(pictures, scales.ends[:3], strict=True)]
    return b"".join([struct.pack("<I", len(head)), head, forces.astype("<f4").tobytes(), *levels])


def _levels(picture: Array, end: float) -> bytes:
    return np.round(LEVELS * np.clip(picture / end if end > 0 else 0 * picture, 0, 1)).astype(np.uint8).tobytes()


def _known(value: float | None, factor: float = 1.0) -> float | None:
    return None if value is None or not math.isfinite(value) else factor * value
