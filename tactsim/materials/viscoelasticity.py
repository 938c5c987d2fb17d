"""Between the shear response of linear viscoelasticity and the relaxation of a material."""

from __future__ import annotations

import numpy as np

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.interconversion import kelvin_of, maxwell_of
from tactsim.interfaces import Material
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.relaxation import Relaxation

FLOWING = 1e-3
"""Part of its stiffness below which tissue that keeps no more flows: atrial tissue keeps 1e-5. Of grasps of 14 random tissues
that keep 1e-4 to 0.1, a contact that expects forces to grow led 11 to the end, one made for tissue that flows 7."""


def neo_hookean_of(shear_compliance: GeneralizedKelvin) -> NeoHookean:
    """Incompressible neo-Hookean material whose small-strain shear response has this creep compliance 1/G in 1/Pa.

    The Prony series follows exactly; a neo-Hookean energy is what linear viscoelasticity says at finite strain if nothing else
    is known.

    Raises
    ------
    InvalidQuantity
        If the compliances and times are so many decades apart that a result leaves the range of floats.
    """
    shear = maxwell_of(shear_compliance)
    instantaneous = shear.instantaneous_modulus
    fractions, times = tuple((shear.moduli / instantaneous).tolist()), tuple(shear.times.tolist())
    return NeoHookean(c10=instantaneous / 2, relaxation=Relaxation(fractions=fractions, times=times))


def shear_relaxation(material: Material) -> GeneralizedMaxwell:
    """Small-strain shear relaxation modulus of a material in Pa; constant if it does not relax."""
    modulus = material.shear_modulus
    if material.relaxation is None:
        return GeneralizedMaxwell(modulus, np.zeros(0), np.zeros(0))
    equilibrium, amplitudes, times = material.relaxation.amplitudes
    return GeneralizedMaxwell(modulus * equilibrium, modulus * amplitudes, times)


def flows(material: Material) -> bool:
    """Whether a material relaxes to next to nothing, so that its forces follow the rate of a motion, not the motion."""
    relaxation = shear_relaxation(material)
    return relaxation.equilibrium_modulus < FLOWING * relaxation.instantaneous_modulus


def shear_compliance(material: Material) -> GeneralizedKelvin:
    """Small-strain shear creep compliance of a material in 1/Pa.

    Raises
    ------
    InvalidQuantity
        If the moduli and times are so many decades apart that a result leaves the range of floats.
    """
    return kelvin_of(shear_relaxation(material))
