"""Pictures of surfaces in 3D by VTK without a window, in a process of its own.

VTK ends the whole process where it finds no graphics library (EGL, OSMesa or an X server); the run that asks for a picture must
survive that.
"""

from __future__ import annotations

import json
import re
import tempfile
import weakref
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.errors import TactsimError
from tactsim.outside.arrays import read_arrays
from tactsim.outside.processes import Child

PATIENCE = 120.0
"""Time in s after which a renderer that does not answer is given up."""
MODULE = "tactsim.plotting.renderer"
ONE_THREAD = {"LP_NUM_THREADS": "0"}
"""Mesa renders in the thread that asks: handing small pictures to others costs a tenth of their time."""
REMEDY = "on Debian: apt-get install libegl1 libgl1-mesa-dri, or libosmesa6"


@dataclass(frozen=True)
class Surface:
    """Triangles (T, 3) of points (n, 3) in one colour, lit if it is opaque, or in one per triangle (T, 3) from 0 to 1, unlit."""

    points: Array
    triangles: Array
    colour: str | Array
    opacity: float = 1.0
    smooth: bool = False
    creases: bool = False
    """Whether edges between faces at an angle of more than 30 degrees are drawn."""
    seen_by: tuple[int, ...] | None = None
    """Numbers of the cameras that see it, None for all."""


@dataclass(frozen=True)
class Camera:
    """A parallel projection: what is looked at, from which direction (both (3,)), and half the height of the picture; lengths in
    the unit of the points."""

    focus: tuple[float, float, float]
    direction: tuple[float, float, float]
    half_height: float
    pixels: tuple[int, int]

    def project(self, points: Array) -> Array:
        """Places (n, 2) in pixels from the upper left corner of points (n, 3)."""
        back = np.asarray(self.direction) / np.linalg.norm(self.direction)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        away = np.asarray(points, float) - self.focus
        flat = np.stack([away @ right, -(away @ np.cross(back, right))], axis=-1)
        return np.array(self.pixels) / 2 + flat * self.pixels[1] / (2 * self.half_height)


class Rendering:
    """A scene as each camera sees it, rendered by a process of its own while this one does other work.

    Parameters
    ----------
    surfaces : what the scene is made of
    cameras : one for each picture
    """

    def __init__(self, surfaces: Sequence[Surface], cameras: Sequence[Camera]):
        self.cameras = tuple(cameras)
        self._folder = tempfile.TemporaryDirectory()
        scene, self._drawn = Path(self._folder.name) / "scene.npz", Path(self._folder.name) / "pictures.npz"
        try:
            _save(scene, surfaces, cameras)
            self._child = Child(MODULE, [str(scene), str(self._drawn)], environment=ONE_THREAD)
        except BaseException:
            self._folder.cleanup()
            raise
        self._close = weakref.finalize(self, _closed, self._child, self._folder)

    def pictures(self) -> list[Array]:
        """The pictures (height, width, 3) from 0 to 255, waited for; once.

        Raises
        ------
        TactsimError
            If this machine cannot render; the message says why.
        """
        try:
            done = self._child.wait(PATIENCE)
            if done.out_of_time:
                raise TactsimError(f"the renderer did not answer in {PATIENCE:g} s")
            if done.code or not self._drawn.is_file():
                raise TactsimError(f"VTK cannot render here: {_cause(done.error_output, done.code)} ({REMEDY})")
            images = read_arrays(self._drawn.read_bytes(), "the pictures")
            return [images[str(number)] for number in range(len(self.cameras))]
        finally:
            self._close()


def _closed(child: Child, folder: tempfile.TemporaryDirectory[str]) -> None:
    child.stop()
    folder.cleanup()


def _save(path: Path, surfaces: Sequence[Surface], cameras: Sequence[Camera]) -> None:
    arrays: dict[str, Array] = {}
    parts = []
    for number, surface in enumerate(surfaces):
        arrays |= {f"points{number}": surface.points, f"triangles{number}": surface.triangles}
        if not isinstance(surface.colour, str):
            arrays[f"colour{number}"] = surface.colour
        colour = surface.colour if isinstance(surface.colour, str) else None
        look = {"opacity": surface.opacity, "smooth": surface.smooth, "creases": surface.creases}
        parts.append({"colour": colour, "seen_by": surface.seen_by, **look})
    scene = json.dumps({"surfaces": parts, "cameras": [asdict(camera) for camera in cameras]})
    np.savez(path, drawing=np.array(scene), **arrays)  # type: ignore[arg-type]


def _cause(words: str, code: int) -> str:
    """What VTK or Python said last, without its decoration; the exit code if it said nothing."""
    lines = [re.sub(r"\x1b\[[\d;]*m", "", line).split("WARN|")[-1].split("ERR|")[-1].strip() for line in words.splitlines()]
    filled = [line for line in lines if line]
    return filled[-1][:300] if filled else f"the renderer ended with the code {code}"
