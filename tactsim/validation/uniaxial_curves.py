"""The uniaxial compression curve that stands for the unpublished data of Fig. 3.8, and fits to it."""

from __future__ import annotations

from functools import cache

import numpy as np

from tactsim.identification.uniaxial import UniaxialFit, fit_uniaxial, uniaxial_nominal_stress
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.materials.library import named_material

LARGEST_COMPRESSION = 0.6
"""Smallest stretch, an assumption: the height of the specimen of the compression test is not printed."""
POINTS = 200


@cache
def compression_curve(name: str) -> UniaxialCurve:
    """Nominal stress of a material set by 3.1.9 with c11, at even stretches from ``LARGEST_COMPRESSION`` to just below 1."""
    stretch = np.linspace(LARGEST_COMPRESSION, 1.0, POINTS + 1)[:-1]
    return UniaxialCurve(stretch, uniaxial_nominal_stress(named_material(name).material, stretch), name)


@cache
def fitted(name: str, form: str) -> UniaxialFit:
    """The relative least-squares fit of a form to the curve of a material set."""
    return fit_uniaxial(compression_curve(name), form)
