"""Pictures of surfaces in space by pyvista without a window, in a process of its own.

VTK ends the whole process where it finds no graphics library (EGL, OSMesa or an X server); the run that asks for a picture must
survive that. Run as a program with SCENE.npz PICTURE.png ... this module is that process.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.errors import TactsimError
from tactsim.outside.arrays import read_arrays
from tactsim.outside.processes import run_child

PATIENCE = 120.0
"""Time in s after which a renderer that does not answer is given up."""
MODULE = "tactsim.plotting.off_screen"
REMEDY = "on Debian: apt-get install libegl1 libgl1-mesa-dri, or libosmesa6"


@dataclass(frozen=True)
class Surface:
    """Triangles (T, 3) of points (n, 3) in one colour with light and shade, or in one per triangle (T, 3) from 0 to 1 without."""

    points: Array
    triangles: Array
    colour: str | Array
    opacity: float = 1.0
    smooth: bool = False
    creases: bool = False
    """Whether edges between faces at an angle of more than 40 degrees are drawn."""


@dataclass(frozen=True)
class Camera:
    """A parallel projection: what is looked at, from which direction (both (3,)), and half the height of the picture."""

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


def pictures(surfaces: Sequence[Surface], cameras: Sequence[Camera]) -> list[bytes]:
    """The PNG of a scene from each camera.

    Raises
    ------
    TactsimError
        If this machine cannot render; the message says why.
    """
    with tempfile.TemporaryDirectory() as folder:
        scene, drawn = Path(folder) / "scene.npz", [Path(folder) / f"picture{k}.png" for k in range(len(cameras))]
        _save(scene, surfaces, cameras)
        arguments = [str(scene), *map(str, drawn)]
        done = run_child(MODULE, arguments, time_limit=PATIENCE, environment={"PYVISTA_OFF_SCREEN": "true"})
        if done.out_of_time:
            raise TactsimError(f"the renderer did not answer in {PATIENCE:g} s")
        if done.code or not all(path.is_file() for path in drawn):
            raise TactsimError(f"pyvista cannot render here: {_cause(done.error_output, done.code)} ({REMEDY})")
        return [path.read_bytes() for path in drawn]


def _save(path: Path, surfaces: Sequence[Surface], cameras: Sequence[Camera]) -> None:
    arrays: dict[str, Array] = {}
    parts = []
    for number, surface in enumerate(surfaces):
        arrays |= {f"points{number}": surface.points, f"triangles{number}": surface.triangles}
        if not isinstance(surface.colour, str):
            arrays[f"colour{number}"] = surface.colour
        colour = surface.colour if isinstance(surface.colour, str) else None
        parts.append({"colour": colour, "opacity": surface.opacity, "smooth": surface.smooth, "creases": surface.creases})
    scene = json.dumps({"surfaces": parts, "cameras": [asdict(camera) for camera in cameras]})
    np.savez(path, drawing=np.array(scene), **arrays)  # type: ignore[arg-type]


def _cause(words: str, code: int) -> str:
    """What VTK or Python said last, without its decoration; the exit code if it said nothing."""
    lines = [re.sub(r"\x1b\[[\d;]*m", "", line).split("WARN|")[-1].split("ERR|")[-1].strip() for line in words.splitlines()]
    filled = [line for line in lines if line]
    return filled[-1][:300] if filled else f"the renderer ended with the code {code}"


def _main(scene: str, *drawn: str) -> None:
    """Draws a scene that ``_save`` wrote, once for each of its cameras."""
    import pyvista
    from matplotlib.image import imsave

    arrays = read_arrays(Path(scene).read_bytes(), "the scene")
    drawing = json.loads(str(arrays["drawing"]))
    parts = [
        (part, arrays[f"points{k}"], arrays[f"triangles{k}"], part["colour"] or arrays[f"colour{k}"])
        for k, part in enumerate(drawing["surfaces"])
    ]
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=drawing["cameras"][0]["pixels"])
    plotter.set_background("white")
    for part in parts:
        _add(plotter, *part)
    plotter.enable_parallel_projection()
    plotter.disable_anti_aliasing()  # several samples per pixel leave out what is translucent
    plotter.enable_depth_peeling(8)
    for camera, path in zip(drawing["cameras"], drawn, strict=True):
        focus, direction = np.array(camera["focus"]), np.array(camera["direction"])
        eye = focus + direction * 20 * camera["half_height"] / np.linalg.norm(direction)
        plotter.camera_position = [eye, focus, (0, 0, 1)]
        plotter.camera.parallel_scale = camera["half_height"]
        plotter.render()
        image = plotter.screenshot(return_img=True)
        if np.ptp(image) == 0:
            raise TactsimError("the renderer drew nothing")
        imsave(path, image)


def _add(plotter: Any, part: dict[str, Any], points: Array, triangles: Array, colour: str | Array) -> None:
    import pyvista

    mesh = pyvista.PolyData.from_regular_faces(points, triangles)
    if isinstance(colour, str):
        plotter.add_mesh(mesh, color=colour, opacity=part["opacity"], smooth_shading=part["smooth"], ambient=0.25)
    else:
        mesh.cell_data["colour"] = (255 * colour).round().astype(np.uint8)
        plotter.add_mesh(mesh, scalars="colour", rgb=True, opacity=part["opacity"], lighting=False)
    if part["creases"]:
        edges = mesh.extract_feature_edges(40.0, non_manifold_edges=False, manifold_edges=False)
        if edges.n_points:
            plotter.add_mesh(edges, color="#30363d", line_width=2.0)


if __name__ == "__main__":
    _main(*sys.argv[1:])
