"""From which squeeze on elements at a free face wrinkle, long before the material would."""

from __future__ import annotations

WRINKLED = 0.72
"""Stretch below which wrinkles as long as an element lower the energy of its quadratic displacements and linear pressures at a
free face: incompressible blocks in plane strain get the first between 0.70 and 0.72 on grids of 8 to 32 cells, and more of them
on finer ones. Those of the material itself come below 0.544 (Biot 1963, Applied Scientific Research A 12, 168)."""


def wrinkled(height: float) -> list[str]:
    """What to say of a block that rigid bodies close to this part of its height.

    Between frictionless jaws, where the exact state is homogeneous, the force fell by 1.5 % below it at 0.66.
    """
    if height >= WRINKLED:
        return []
    return [
        f"the block is closed to {height:.2g} of its height: elements at free faces may wrinkle from {WRINKLED} on, each on its "
        "own, a rubber half-space only from 0.54 on (Biot 1963), and forces be some per cent off; compare with another mesh"
    ]
