"""The type of an array."""

from __future__ import annotations

import numpy as np

Array = np.ndarray
"""An array of numpy; docstrings say shape and unit."""
