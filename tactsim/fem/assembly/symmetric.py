"""How symmetric tensors are stored: their six components 11, 22, 33, 12, 23, 13, in this order."""

from __future__ import annotations

import numpy as np

ROWS_AND_COLUMNS = (np.array([0, 1, 2, 0, 1, 0]), np.array([0, 1, 2, 1, 2, 2]))
"""Rows and columns of the components in the tensor."""
MULTIPLICITY = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
"""How often each component stands in the tensor."""
SLOTS = (0, 3, 5, 3, 1, 4, 5, 4, 2)
"""Place of the entry 3 i + J of the tensor among the components; a tuple, which compiled loops unroll."""
FULL = np.reshape(SLOTS, (3, 3))
"""The same as (3, 3): ``components[FULL]`` is the tensor (3, 3, ...) of components (6, ...)."""
