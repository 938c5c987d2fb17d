"""The rigid flat annulus on linear viscoelastic, incompressible tissue: displacement, force and rise, exact for any history."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from tactsim.analytic.allowed_range import checked
from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.analytic.force_factor import force_factor, rise_factor
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.histories import History
from tactsim.analytic.interconversion import maxwell_of
from tactsim.analytic.layer_kernel import Base
from tactsim.errors import InvalidQuantity

HALVINGS = 60
"""Halvings of the logarithm of a time, after which its interval is round-off."""
SMALL_DISPLACEMENT = 0.1
"""Displacement over the outer radius up to which linear theory is meant: a convention; what stiffens leaves it before."""


@dataclass(frozen=True, eq=False)
class ViscoelasticAnnulus:
    r"""A rigid frictionless annulus on viscoelastic tissue with Poisson's ratio 1/2, on a half-space or a layer.

    .. math::
        \epsilon(t) = \frac{1}{8 a \kappa} \int_{0^-}^t J(t - s)\, dP(s), \quad
        P(t) = 8 a \kappa \int_{0^-}^t G(t - s)\, d\epsilon(s)

    which is :math:`(1 - \nu) P = 4 G a \kappa \epsilon` with :math:`\nu = 1/2` and a compliance J = 1/G with memory. The contact
    area of a flat face does not change, so that the correspondence principle holds for every history, as long as the contact is
    closed. The equations are bilateral: where the total force would become negative, real contact opens and they end.

    Parameters
    ----------
    outer_radius : float
        ``a > 0`` in m.
    radius_ratio : float
        ``b / a`` in ``[0, 0.99]``.
    shear_compliance : GeneralizedKelvin
        ``J = 1/G`` in 1/Pa.
    formula : str
        Formula of the force factor on a half-space, one of ``force_factor.FORMULAS``; on a layer only ``"exact"``.
    radius_over_thickness : float
        Outer radius over the thickness of the layer; 0 for a half-space.
    base : str
        ``"bonded"`` or ``"slipping"``, of the layer.

    Raises
    ------
    InvalidQuantity, UnknownName
        If an argument is out of its range, or the formula is not exact on a layer.

    Source: thesis sections 4.6 and 4.7, eqs. 4.6.1 to 4.6.5; Lee & Radok 1960, doi:10.1115/1.3644020; Ting 1966,
    doi:10.1115/1.3625192.
    """

    outer_radius: float
    radius_ratio: float
    shear_compliance: GeneralizedKelvin
    formula: str = "exact"
    radius_over_thickness: float = 0.0
    base: Base = "bonded"
    force_factor: float = field(init=False)
    """kappa, dimensionless."""
    rise_factor: float = field(init=False)
    """Height of the tissue on the axis above the face, over the displacement; always that of the exact solution."""
    touch_factor: float = field(init=False)
    """The largest height in the hole, over the displacement: a small sensor as wide as the hole is touched there first."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "outer_radius", float(checked("outer radius", self.outer_radius, "(0, inf) m")))
        if checked("radius over thickness", self.radius_over_thickness, "[0, inf)"):
            if self.formula != "exact":
                raise InvalidQuantity(f"the formula {self.formula!r} is for a half-space; allowed on a layer: 'exact'")
            ratio = float(checked("radius ratio", self.radius_ratio, "[0, 0.99]"))
            punch = solve_annular_punch(ratio, radius_over_thickness=self.radius_over_thickness, base=self.base)
            factors = punch.force_factor, punch.rise_factor, punch.largest_rise_factor
        else:
            rise = float(rise_factor(self.radius_ratio))  # on a half-space the axis is highest
            factors = float(force_factor(self.radius_ratio, self.formula)), rise, rise
        object.__setattr__(self, "force_factor", factors[0])
        object.__setattr__(self, "rise_factor", factors[1] if self.radius_ratio else 0.0)
        object.__setattr__(self, "touch_factor", factors[2] if self.radius_ratio else 0.0)

    @property
    def length(self) -> float:
        """8 a kappa in m: the force per displacement and shear modulus."""
        return 8 * self.outer_radius * self.force_factor

    @cached_property
    def _shear_relaxation(self) -> GeneralizedMaxwell:
        """Found once: a run asks for the force after each of its steps."""
        return maxwell_of(self.shear_compliance)

    @property
    def thickness(self) -> float:
        """Of the layer in m; infinite for a half-space."""
        return self.outer_radius / self.radius_over_thickness if self.radius_over_thickness else np.inf

    def displacement(self, force_history: History, times: ArrayLike) -> np.ndarray:
        """Displacement in m under a force in N, positive into the tissue, at ``times`` in s; of the shape of ``times``.

        Raises
        ------
        InvalidQuantity
            If a time is not finite.
        """
        from tactsim.analytic.response import response  # compiled

        return response(self.shear_compliance, force_history, times) / self.length

    def force(self, displacement_history: History, times: ArrayLike) -> np.ndarray:
        """Force in N under a displacement in m, positive into the tissue, at ``times`` in s; of the shape of ``times``.

        A negative force is what a face glued to the tissue would need: there the contact has opened, and the answer is void.

        Raises
        ------
        InvalidQuantity
            If a time is not finite, or the compliance has no relaxation modulus in the range of floats.
        """
        from tactsim.analytic.response import response

        return self.length * response(self._shear_relaxation, displacement_history, times)

    def creep_displacement(self, force: ArrayLike, times: ArrayLike) -> np.ndarray:
        """Displacement in m at ``times`` in s after a step of ``force`` in N, of the broadcast shape."""
        return np.asarray(force, dtype=float) * self.shear_compliance.creep(times) / self.length

    def rise(self, displacement: ArrayLike) -> np.ndarray:
        """Height in m of the tissue on the axis above the face at a ``displacement`` in m, of its shape."""
        return self.rise_factor * np.asarray(displacement, dtype=float)

    def touch_displacement(self, recess: ArrayLike) -> np.ndarray:
        """Displacement in m at which the tissue in the hole has risen by ``recess`` in m, of its shape.

        Infinite without a hole, and where it would not be smaller than the thickness of the layer.

        Raises
        ------
        InvalidQuantity
            If a recess is not positive.
        """
        with np.errstate(divide="ignore"):
            depth = checked("recess", recess, "(0, inf) m") / np.float64(self.touch_factor)
        return self.above_base(depth)

    def above_base(self, displacement: np.ndarray) -> np.ndarray:
        """Displacements in m, of any shape, infinite where they are not smaller than the thickness of the layer."""
        return np.where(displacement < self.thickness, displacement, np.inf)

    def force_to_touch(self, recess: ArrayLike, times: ArrayLike) -> np.ndarray:
        r"""Constant force in N for which the tissue in the hole rises by ``recess`` in m within ``times`` in s, broadcast.

        .. math:: P = \frac{8 a \kappa L}{\rho J(t)}

        with the touch factor rho; infinite without a hole, and where the annulus would reach the base of the layer first.

        Raises
        ------
        InvalidQuantity
            If a recess is not positive or a time is negative.
        """
        height = checked("recess", recess, "(0, inf) m")
        compliance = self.shear_compliance.creep(checked("time", times, "[0, inf] s"))
        with np.errstate(divide="ignore"):
            force = height * self.length / (np.float64(self.touch_factor) * compliance)
        return np.where(np.isfinite(self.touch_displacement(height)), force, np.inf)

    def time_to_touch(self, recess: ArrayLike, force: ArrayLike) -> np.ndarray:
        """Time in s after which a constant ``force`` in N has raised the tissue in the hole by ``recess`` in m, broadcast.

        Zero if it does so at once, infinite if never, or if the annulus would reach the base of the layer first.

        Raises
        ------
        InvalidQuantity
            If a recess or a force is not positive.
        """
        height, load = checked("recess", recess, "(0, inf) m"), checked("force", force, "(0, inf) N")
        with np.errstate(divide="ignore"):
            compliance = height * self.length / (np.float64(self.touch_factor) * load)
        return creep_time(self.shear_compliance, np.where(np.isfinite(self.touch_displacement(height)), compliance, np.inf))


def creep_time(kelvin: GeneralizedKelvin, compliance: ArrayLike) -> np.ndarray:
    r"""Time in s at which the creep compliance reaches ``compliance`` in 1/Pa, of its shape: 0 up to J0, infinite if never.

    Halved in the logarithm of the time between the bounds that the tangent at t = 0, which lies above J, and the slowest unit,
    which the others are quicker than, give:

    .. math::
        \frac{J - J_0}{\varphi + \sum_i J_i / \tau_i} \le t \le \tau_n \ln \frac{\sum_i J_i}{J_\infty - J}, \quad
        t \le \frac{J - J_0}{\varphi}

    Raises
    ------
    InvalidQuantity
        If a compliance is not positive.

    Source: the bounds are derived here.
    """
    wanted = checked("compliance", compliance, "(0, inf] 1/Pa")
    times = np.where(wanted <= kelvin.glassy_compliance, 0.0, np.inf)
    between = (wanted > kelvin.glassy_compliance) & (wanted < kelvin.equilibrium_compliance)
    if not between.any():
        return times
    target = wanted[between]
    excess = target - kelvin.glassy_compliance
    low = excess / (kelvin.fluidity + (kelvin.compliances / kelvin.times).sum())
    if kelvin.fluidity:
        high = excess / kelvin.fluidity
    else:
        high = kelvin.times[-1] * np.log(kelvin.compliances.sum() / (kelvin.equilibrium_compliance - target))
    high = np.maximum(high, low)
    for _ in range(HALVINGS):
        middle = np.sqrt(low * high)
        reached = kelvin.creep(middle) >= target
        low, high = np.where(reached, low, middle), np.where(reached, middle, high)
    times[between] = np.sqrt(low * high)
    return times
