"""Elastic curve of chapter 5's probe in its default geometry, computed once by finite elements."""

from __future__ import annotations

import numpy as np

from tactsim.experiments.switch_probe.probe_force import ProbeCurve

COUNT = 5
"""Switches of the probe of chapter 5; at the depths below the tissue reaches the first one only."""

_ROWS = (
    # depth, force over shear modulus and width, contact height, force on the first switch over shear modulus and width; all in mm
    (0.00, 0.0000, 0.000, 0.0000),
    (0.25, 0.4957, 0.000, 0.0000),
    (0.50, 1.0206, 0.000, 0.0000),
    (0.75, 1.5678, 0.000, 0.0000),
    (1.00, 2.1351, 0.000, 0.0000),
    (1.25, 2.7210, 0.000, 0.0000),
    (1.50, 3.3245, 0.000, 0.0000),
    (1.75, 3.9454, 0.000, 0.0000),
    (2.00, 4.5835, 0.345, 0.0000),
    (2.25, 5.2399, 0.408, 0.0000),
    (2.50, 5.9165, 0.473, 0.0000),
    (2.75, 6.6149, 0.541, 0.0000),
    (3.00, 7.3367, 0.631, 0.0000),
    (3.25, 8.0832, 0.714, 0.0000),
    (3.50, 8.8558, 0.806, 0.0000),
    (3.75, 9.6560, 0.914, 0.0004),
    (4.00, 10.4854, 1.009, 0.0413),
    (4.25, 11.3453, 1.121, 0.1173),
    (4.50, 12.2373, 1.236, 0.1793),
    (4.75, 13.1633, 1.356, 0.2295),
    (5.00, 14.1247, 1.470, 0.2741),
)


def _curve() -> ProbeCurve:
    depth, force, height, first = 1e-3 * np.array(_ROWS).T
    switches = np.zeros((len(depth), COUNT))
    switches[:, 0] = first
    return ProbeCurve(depth, force, height, switches)


CHAPTER_5 = _curve()
"""Face of 2 mm, sides of 20 degrees, fillet 0.5 mm, friction 0.4, on an incompressible neo-Hookean block 40 mm wide and 20 mm
high on a fixed base, in plane strain; strips of 0.2 mm at every mm of height.

Source: computed with the finite elements of this package on the default mesh, by ``python benchmarks/probe_curve.py``. A test
computes it again and compares: forces to 0.1 %, forces on the switch to 4e-3 mm, heights from a depth of 2 mm on to 0.02 mm.
"""
