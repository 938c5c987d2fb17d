"""The equilibrium of a body for prescribed values: the displacement or force of the rigid bodies, and pressures on its walls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from tactsim.array import Array
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.models.first_guess import FirstGuess

if TYPE_CHECKING:
    from tactsim.mechanics.models.block_model import GraspModel
    from tactsim.mechanics.models.pressed_model import PressedModel


class PressedBody:
    """Finds the equilibrium for a displacement in m or a force in N, followed by a pressure in Pa for each wall.

    Parameters
    ----------
    model : body and rigid bodies
    by_force : whether the first value is a force
    first_displacement : guess in m of a displacement under a force with which something touches
    walls : what the pressures act on
    first_guess : where Newton starts from the undeformed body, which it is given, by the displacement in m; by default without
        a deformation
    """

    def __init__(
        self,
        model: PressedModel | GraspModel,
        *,
        by_force: bool,
        first_displacement: float,
        walls: Sequence[FollowerPressure] = (),
        first_guess: Callable[[ContactEquilibrium, float], FirstGuess] | None = None,
    ):
        self._model, self._by_force, self._first_displacement = model, by_force, first_displacement
        self._walls, self._first_guess = walls, first_guess

    @property
    def body(self) -> Body:
        """What deforms."""
        return self._model.body

    def equilibrium(
        self, now: ContactEquilibrium, loads: tuple[float, ...], guess: Array, relaxation: RelaxationStep | None
    ) -> ContactEquilibrium:
        """The equilibrium at prescribed values, reached from ``now``; bodies without a force stay where they are.

        ``guess`` (size + 1,) is that of `EquilibriumProblem`.

        Raises
        ------
        ConvergenceError
            If there is none that Newton finds.
        """
        model, pressures = self._model, [wall.at(p) for wall, p in zip(self._walls, loads[1:], strict=True)]
        if not self._by_force:
            begin = FirstGuess(now, guess[:-1])
            if self._first_guess is not None and loads[0] > now.load and not now.unknowns.any():
                begin = self._first_guess(now, loads[0])
            return model.equilibrium(begin.state, loads[0], begin.unknowns, relaxation=relaxation, loads=pressures)
        if loads[0] == 0:
            return model.equilibrium(now, now.load, guess[:-1], relaxation=relaxation, loads=pressures)
        rigid_displacement = guess[-1] if guess[-1] > 0 else self._first_displacement
        return model.equilibrium(now, rigid_displacement, guess[:-1], force=loads[0], relaxation=relaxation, loads=pressures)
