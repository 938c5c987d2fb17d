"""The program that renders a scene of ``off_screen`` without a window: SCENE.npz PICTURES.npz.

VTK is used without pyvista, whose import takes longer than the rendering. What is translucent is sorted from back to front
instead of peeled in layers, each of which is a rendering of its own, and has one colour from all sides: light on a dozen layers
takes half of the rendering, and darkens what lies behind.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  it makes the windows
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkPolyDataNormals
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkLightKit,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

from tactsim.array import Array
from tactsim.errors import TactsimError
from tactsim.outside.arrays import read_arrays

AMBIENT = 0.25
CREASE_ANGLE, CREASE_COLOUR, CREASE_WIDTH = 60.0, "#30363d", 2.0
FINEST = 1 / 16
"""Longest edge of a translucent triangle over the size of the scene: small ones are sorted well by their middles."""
DISTANCE = 20
"""Of the eye, in half heights of the picture."""


def main(scene: str, pictures: str) -> None:
    """Renders a scene once for each of its cameras, all in one window, and writes the pictures (height, width, 3).

    Raises
    ------
    TactsimError
        If a picture is empty.
    """
    arrays = read_arrays(Path(scene).read_bytes(), "the scene")
    drawing = json.loads(str(arrays["drawing"]))
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    images = {}
    for number, camera in enumerate(drawing["cameras"]):
        renderer = _renderer(camera)
        seen = [k for k, part in enumerate(drawing["surfaces"]) if part["seen_by"] is None or number in part["seen_by"]]
        _fill(renderer, {k: drawing["surfaces"][k] for k in seen}, arrays, camera)
        images[str(number)] = _picture(window, renderer, camera)
    np.savez(pictures, **images)  # type: ignore[arg-type]


def _renderer(camera: Mapping[str, Any]) -> Any:
    """An empty scene with lights and the camera."""
    renderer = vtkRenderer()
    renderer.SetBackground(1.0, 1.0, 1.0)
    vtkLightKit().AddLightsToRenderer(renderer)
    eye = renderer.GetActiveCamera()
    eye.ParallelProjectionOn()
    eye.SetFocalPoint(*camera["focus"])
    eye.SetPosition(*(np.array(camera["focus"]) + DISTANCE * camera["half_height"] * _backward(camera)))
    eye.SetViewUp(0.0, 0.0, 1.0)
    eye.SetParallelScale(camera["half_height"])
    return renderer


def _backward(camera: Mapping[str, Any]) -> Array:
    """Unit vector (3,) to the eye."""
    direction = np.array(camera["direction"])
    return direction / np.linalg.norm(direction)


def _fill(renderer: Any, parts: Mapping[int, Mapping[str, Any]], arrays: Mapping[str, Array], camera: Mapping[str, Any]) -> None:
    """Adds the surfaces: those that are opaque one by one, the triangles of all others in one mesh from back to front."""
    translucent = []
    for number, part in parts.items():
        points, triangles = arrays[f"points{number}"].astype(float), arrays[f"triangles{number}"]
        mesh = _mesh(points, triangles)
        if part["opacity"] < 1.0:
            shade = [*_rgb(part["colour"]), round(255 * part["opacity"])]
            corners = _divided(points[triangles], FINEST * 2 * camera["half_height"])
            translucent.append((corners, np.tile(np.array(shade, np.uint8), (len(corners), 1))))
        elif part["colour"] is None:
            renderer.AddActor(_painted(mesh, (255 * arrays[f"colour{number}"]).round().astype(np.uint8)))
        else:
            renderer.AddActor(_plain(mesh, part))
        if part["creases"]:
            renderer.AddActor(_creases(mesh))
    if translucent:
        corners, shades = (np.concatenate(columns) for columns in zip(*translucent, strict=True))
        order = np.argsort(corners.mean(axis=1) @ _backward(camera), kind="stable")
        sorted_mesh = _painted(_mesh(corners[order].reshape(-1, 3), np.arange(3 * len(order)).reshape(-1, 3)), shades[order])
        sorted_mesh.ForceTranslucentOn()
        renderer.AddActor(sorted_mesh)


def _divided(corners: Array, longest: float) -> Array:
    """Triangles (T, 3, 3), each quartered until its edges are not longer."""
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    if not (edge > longest).any():
        return corners
    a, b, c = np.moveaxis(corners[edge > longest], 1, 0)
    middles = (a + b) / 2, (b + c) / 2, (c + a) / 2
    ab, bc, ca = middles
    parts = np.concatenate([np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.concatenate([corners[edge <= longest], _divided(parts, longest)])


def _mesh(points: Array, triangles: Array) -> Any:
    mesh, places, faces = vtkPolyData(), vtkPoints(), vtkCellArray()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    faces.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(triangles, np.int64).ravel(), deep=True))
    mesh.SetPoints(places)
    mesh.SetPolys(faces)
    return mesh


def _actor(mesh: Any) -> Any:
    mapper, actor = vtkPolyDataMapper(), vtkActor()
    mapper.SetInputData(mesh)
    actor.SetMapper(mapper)
    return actor


def _plain(mesh: Any, part: Mapping[str, Any]) -> Any:
    """A surface in one colour with light and shade."""
    if part["smooth"]:
        normals = vtkPolyDataNormals()
        normals.SetInputData(mesh)
        normals.SetFeatureAngle(CREASE_ANGLE)  # an end of a tube is flat, its rim sharp
        normals.Update()
        mesh = normals.GetOutput()
    actor = _actor(mesh)
    look = actor.GetProperty()
    look.SetColor(*(level / 255 for level in _rgb(part["colour"])))
    look.SetAmbient(AMBIENT)
    if part["smooth"]:
        look.SetInterpolationToPhong()
    else:
        look.SetInterpolationToFlat()
    return actor


def _painted(mesh: Any, colours: Array) -> Any:
    """A surface with a colour for each triangle, without light and shade."""
    mesh.GetCellData().SetScalars(numpy_to_vtk(colours, deep=True))
    actor = _actor(mesh)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    look.SetLighting(False)
    return actor


def _creases(mesh: Any) -> Any:
    """The edges between faces at a large angle, and those of the boundary."""
    edges = vtkFeatureEdges()
    edges.SetInputData(mesh)
    edges.SetFeatureAngle(CREASE_ANGLE)
    edges.NonManifoldEdgesOff()
    edges.ManifoldEdgesOff()
    edges.ColoringOff()
    edges.Update()
    actor = _actor(edges.GetOutput())
    actor.GetMapper().ScalarVisibilityOff()
    actor.GetProperty().SetColor(*(level / 255 for level in _rgb(CREASE_COLOUR)))
    actor.GetProperty().SetLineWidth(CREASE_WIDTH)
    return actor


def _rgb(colour: str) -> list[int]:
    """Red, green and blue, each from 0 to 255, of a colour like ``#30363d``."""
    return list(bytes.fromhex(colour.removeprefix("#")))


def _picture(window: Any, renderer: Any, camera: Mapping[str, Any]) -> Array:
    """What the camera sees (height, width, 3).

    Raises
    ------
    TactsimError
        If it is nothing.
    """
    window.SetSize(*camera["pixels"])
    window.AddRenderer(renderer)
    renderer.ResetCameraClippingRange()
    window.Render()
    grabbed = vtkWindowToImageFilter()
    grabbed.SetInput(window)
    grabbed.ReadFrontBufferOff()
    grabbed.ShouldRerenderOff()
    grabbed.Update()
    window.RemoveRenderer(renderer)
    width, height, _ = grabbed.GetOutput().GetDimensions()
    image = vtk_to_numpy(grabbed.GetOutput().GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3]
    if np.ptp(image) == 0:
        raise TactsimError("the renderer drew nothing")
    return image


if __name__ == "__main__":
    main(*sys.argv[1:])
