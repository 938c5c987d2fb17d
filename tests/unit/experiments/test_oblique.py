"""Laws and bodies with a direction of their own: what is computed of the tissue depends on where they point."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

import numpy as np
import pytest

from tactsim.array import Array
from tactsim.case.loading import load_case
from tactsim.errors import CaseError, InputError
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.symmetry import mirror_axes
from tactsim.interfaces import RigidBody
from tactsim.materials.mirrored import law_mirrors
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mesh.revolved import SweepSymmetry
from tactsim.registry import forget

LEAN = 0.1


@pytest.fixture(autouse=True)
def kinds() -> Iterator[None]:
    """A law with linear fibres beside a neo-Hookean matrix, and a plane that leans."""

    class Fibres(NeoHookean):
        kind: Literal["fibres"] = "fibres"
        stiffness: float = 5e3
        direction: tuple[float, float, float] = (1.0, 0.0, 0.0)

        def _along(self) -> tuple[Array, Array]:
            a = np.array(self.direction) / np.linalg.norm(self.direction)
            pairs = np.multiply.outer(a, a)
            return pairs, pairs - np.eye(3) / 3

        def first_piola_kirchhoff(self, F: Array, pressure: Array) -> Array:
            pairs, deviator = self._along()
            strain = np.einsum("iJ,iJ...->...", pairs, F) - 1
            return super().first_piola_kirchhoff(F, pressure) + self.stiffness * np.multiply.outer(deviator, strain)

        def tangent(self, F: Array, pressure: Array) -> Array:
            pairs, deviator = self._along()
            fibres = self.stiffness * np.multiply.outer(deviator, pairs)
            return super().tangent(F, pressure) + fibres.reshape(3, 3, 3, 3, *(1,) * (F.ndim - 2))

    class Slope(RigidBody):
        kind: Literal["slope"] = "slope"

        @classmethod
        def example(cls) -> Slope:
            return cls()

        def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
            normal = np.zeros_like(x)
            normal[0], normal[-1] = np.sin(LEAN), -np.cos(LEAN)
            return (normal * x).sum(axis=0), normal, np.zeros((len(x), *x.shape))

    yield
    for cls in (Fibres, Slope):
        forget(cls)


def fibres(*direction: float) -> dict[str, Any]:
    return {"kind": "fibres", "c10": "2 kPa", "direction": list(direction)}


def pressed(material: Any, body: dict[str, Any], kind: str = "indentation_3d", **more: Any) -> Any:
    specimen = {"material": material, "thickness": "4 mm", "radius": "6 mm"}
    mesh = {"finest": "2 mm", "growth": 2, "adaptive": False}
    stop = {"stop": "displacement", "displacement": "0.1 mm", "contact": {"kind": "coulomb", "friction": 0}}
    experiment = {"kind": kind, "specimen": specimen, "body": body, "mesh": mesh, **stop, **more}
    return load_case({"schema": "tactsim/case/1", "experiment": experiment}).experiment


def pulled(geometry: dict[str, Any], material: dict[str, Any], dimension: str = "3d", **more: Any) -> Any:
    conditions = [{"kind": "clamped", "face": "bottom"}, {"kind": "displacement", "face": "top", "z": "1 mm"}]
    spans = {"radial": [{"length": "5 mm", "cells": 2}], "axial": [{"length": "5 mm", "cells": 2}], "around": 2}
    asked = {"force": {"kind": "force", "face": "top", "component": "z"}}
    problem = {"kind": "boundary_value_problem", "dimension": dimension, "geometry": {"kind": "cylinder", **spans, **geometry}}
    experiment = problem | {"material": material, "conditions": conditions, "asked": asked, **more}
    return load_case({"schema": "tactsim/case/1", "experiment": experiment}).experiment


def test_an_oblique_fibre_is_seen() -> None:
    material = pulled({"part": "whole"}, fibres(1, 1, 0)).material
    assert [law_mirrors(material, axis) for axis in range(3)] == [False, False, True]
    assert all(law_mirrors(NeoHookean(c10=1e3), axis) for axis in range(3))


def test_a_body_that_leans_by_itself_is_pressed_as_one_that_is_tilted() -> None:
    leaning, tilted = pressed("lump", {"kind": "slope"}), pressed("lump", {"kind": "plane"}, tilt_y=f"{LEAN} rad")
    assert leaning.symmetry is tilted.symmetry is SweepSymmetry.HALF
    own, other = (float(one.run(None).quantities["reaction_force"].value) for one in (leaning, tilted))
    assert own == pytest.approx(other, rel=1e-9), "one plane; beside the round-off of the turn"


def test_no_plane_cuts_the_tissue_that_does_not_mirror_its_fibres() -> None:
    ball = {"kind": "sphere", "radius": "5 mm"}
    along, oblique, steep = (pressed(fibres(*direction), ball) for direction in ((1, 0, 0), (1, 1, 0), (1, 0, 1)))
    assert [one.symmetry.name for one in (along, oblique, steep)] == ["QUARTER", "WHOLE", "HALF"]


def test_a_part_of_the_body_is_refused_to_a_law_that_its_planes_do_not_mirror() -> None:
    half, whole = (pulled({"part": part}, fibres(1, 0, 1)) for part in ("half", "whole"))
    forces = [float(one.run(None).quantities["force"].value) for one in (half, whole)]
    assert 2 * forces[0] == pytest.approx(forces[1], rel=1e-9)
    with pytest.raises(CaseError, match=r"material: fibres is not its own mirror image across x_plane.*part: whole"):
        pulled({"part": "quarter"}, fibres(1, 0, 1))


def test_a_body_that_planes_of_symmetry_do_not_mirror_is_refused() -> None:
    contact = {"body": {"kind": "slope"}, "face": "top", "side": "top", "z": "-0.1 mm"}
    bottom, asked = [{"kind": "clamped", "face": "bottom"}], {"force": {"kind": "contact_force", "contact": 1, "component": "z"}}
    pulled({"part": "half"}, {"kind": "neo_hookean", "c10": "2 kPa"}, conditions=bottom, contacts=[contact], asked=asked)
    with pytest.raises(CaseError, match=r"contacts\.0\.body: slope is not its own mirror image across x_plane.*part: whole"):
        pulled({"part": "quarter"}, {"kind": "neo_hookean", "c10": "2 kPa"}, conditions=bottom, contacts=[contact], asked=asked)


def test_a_section_is_refused_to_a_law_that_leaves_its_plane() -> None:
    assert pulled({"around": 8}, fibres(1, 1, 0), "axisymmetric").run(None).status == "converged"
    with pytest.raises(CaseError, match="material: material fibres shears a section out of its plane"):
        pulled({"around": 8}, fibres(0, 1, 1), "axisymmetric")
    with pytest.raises(InputError, match="material fibres shears a section out of its plane"):
        pressed(fibres(0, 1, 1), {"kind": "sphere", "radius": "5 mm"}, kind="indentation").run(None)


def test_a_grasp_of_oblique_tissue_is_not_its_own_mirror_image() -> None:
    tissues = [fibres(*direction) for direction in ((1, 0, 0), (1, 1, 0))]
    changes = [{"experiment.block.tissue": tissue, "experiment.inclusions": []} for tissue in tissues]
    assert [mirror_axes(load_case("grasp_plain", one).experiment) for one in changes] == [(0, 1), ()]


def test_no_part_of_a_grasp_is_solved_across_planes_that_oblique_tissue_leaves() -> None:
    chosen = {"experiment.inclusions": [], "experiment.mesh": {"kind": "graded", "size": "8 mm", "edge_size": "6 mm"}}
    copies = {}
    for direction in ((1, 0, 0), (1, 0, 1), (1, 1, 0), (1, 1, 1)):
        case = load_case("grasp_plain", chosen | {"experiment.block.tissue": fibres(*direction)})
        copies[direction] = grasp_model(case.experiment, grasp_mesh(case.experiment)).problem.copies
    assert copies == {(1, 0, 0): 8, (1, 0, 1): 2, (1, 1, 0): 2, (1, 1, 1): 1}
