"""Where Newton begins in a grasp, and how exactly its equilibrium is found."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from tactsim.model import FrozenModel

FirstGuessName = Literal["compression", "tissue"]


class GraspSolverSettings(FrozenModel):
    """How the equilibrium of a grasp is found."""

    first_guess: FirstGuessName = "compression"
    """Where Newton begins in the undeformed block: in an even compression; or, with "tissue", in the grasp without its
    inclusions, where an elastic block of graded cells without hollow tubes is closed by a displacement. That grasp is solved
    once for all of a process that differ little but in their inclusions. In data sets on few cells it saves half of the linear
    systems; in a block that is its own mirror image, or on fine meshes, none."""
    balance: Annotated[float, Field(ge=1e-10, le=1e-2)] = 1e-10
    """Largest unbalanced force at a node over the largest nodal force, where Newton ends: with 1e-3 taxels of `sweep_lumps` move
    by 6e-5 of the largest at most."""
