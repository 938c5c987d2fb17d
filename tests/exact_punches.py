"""Exact forces and rises of flat annular and solid punches, against which closed form and finite elements are held."""

from __future__ import annotations

import csv
from pathlib import Path

_TABLE = Path(__file__).parent / "verification" / "annular_punch.csv"
"""Ring-load integral equation by Chebyshev collocation; 40 and 60 terms agree to 1e-12."""
SLENDERNESS = (0.1, 0.2, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0)
SOLID = {
    # base, nu: P (1 - nu) / (4 G a eps) at SLENDERNESS a/h; Fredholm equation of Lebedev and Ufliand, converged to 1e-12
    ("bonded", 0.30): (1.0954, 1.2066, 1.4726, 1.6240, 1.7848, 2.1260, 2.4835, 3.4090, 4.3532),
    ("bonded", 0.49): (1.1234, 1.2741, 1.6638, 1.9028, 2.1694, 2.7796, 3.4840, 5.6322, 8.3370),
    ("bonded", 0.50): (1.1260, 1.2806, 1.6837, 1.9329, 2.2129, 2.8602, 3.6187, 6.0030, 9.1495),
    ("slipping", 0.2): (1.0799, 1.1710, 1.3851, 1.5061, 1.6346, 1.9089, 2.1986, 2.9546, 3.7276),
}
"""On a slipping layer Poisson's ratio only scales the force."""
RINGS = [
    # a/h, base, b/a, P / (8 G a eps), u(0) / eps: incompressible layer, a second program of the same method
    (0.5, "bonded", 0.25, 1.9225, 0.775),
    (0.5, "bonded", 0.50, 1.8464, 0.554),
    (0.5, "bonded", 0.75, 1.6183, 0.344),
    (1.0, "bonded", 0.25, 3.5535, 0.443),
    (1.0, "bonded", 0.50, 3.1677, 0.030),
    (1.0, "bonded", 0.75, 2.4056, -0.132),
    (1.0, "slipping", 0.25, 2.1815, None),
    (1.0, "slipping", 0.50, 2.0647, None),
]


def half_space_rows() -> list[tuple[float, float, float]]:
    """b/a, P / (8 G a eps) and u(0) / eps of annuli on the incompressible half-space."""
    lines = [line for line in _TABLE.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return [(float(r["beta"]), float(r["kappa"]), float(r["u0_over_eps"])) for r in csv.DictReader(lines)]


def solid_factor(slenderness: float, base: str, poisson_ratio: float) -> float:
    """P (1 - nu) / (4 G a eps) of a solid punch on a layer."""
    return SOLID[base, poisson_ratio][SLENDERNESS.index(slenderness)]
