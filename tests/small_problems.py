"""Small boundary value problems: shapes, materials and what is asked of their solutions."""

from __future__ import annotations

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.results.result import Status

C10, C01, SIDE = 1e3, 250.0, 0.01
RUBBER = {"kind": "mooney_rivlin_2", "c10": C10, "c01": C01}
CELLS = [{"length": SIDE, "cells": 2}]
CELL = [{"length": SIDE, "cells": 1}]
CUBE = {"kind": "block", "x": CELL, "y": CELL, "z": CELL}
"""One cell: of states that are the same everywhere."""
BRICK = {"kind": "block", "x": CELLS, "y": CELLS, "z": CELLS}
SQUARE = {"kind": "block", "x": CELLS, "y": CELLS}
ROD = {"kind": "cylinder", "radial": CELLS, "axial": CELLS}
PLANES = [{"kind": "displacement", "face": face, axis: 0.0} for face, axis in (("left", "x"), ("front", "y"), ("bottom", "z"))]
STRETCH = 1.3
NOMINAL = 2 * (STRETCH - STRETCH**-2) * (C10 + C01 / STRETCH)
"""Of an incompressible bar in tension."""
TOP = (SIDE, SIDE, SIDE)


def result_of(**fields):
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "steps": 4} | fields
    result = BoundaryValueProblem.model_validate(fields).run()
    assert result.status is Status.CONVERGED, result.reason
    return result


def asked(kind, **fields):
    return {"number": {"kind": kind, **fields}}


def number(**fields):
    return float(result_of(**fields).quantities["number"].value)


def numbers(**fields):
    return {name: float(one.value) for name, one in result_of(**fields).quantities.items()}


EXTENSION = asked("displacement", at=TOP, component="z")
