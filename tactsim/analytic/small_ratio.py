"""h - 1 + exp(-h) for a small ratio h of step to time, which subtraction would leave without digits."""

from __future__ import annotations

import math

SERIES_END = 0.5
"""Ratio below which h - 1 + exp(-h) is summed as a series."""
SERIES = tuple((-1.0) ** k / math.factorial(k) for k in range(15, 1, -1))
"""Coefficients of h^k, k = 15 .. 2; the next one is below 1e-17 of the sum at ``SERIES_END``."""
