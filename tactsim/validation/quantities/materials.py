"""The material sets of Table 3.1, their stress by 3.1.9, the fits of Fig. 3.8 and where they are stable: thesis, chapter 3."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Literal

import numpy as np
import scipy
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InputError, UnknownName
from tactsim.identification.uniaxial import UniaxialFit, fit_uniaxial, uniaxial_nominal_stress, uniaxial_stress_as_printed
from tactsim.identification.uniaxial_data import UniaxialCurve
from tactsim.interfaces import Material, drawing, quantity
from tactsim.materials.any_material import AnyMaterial
from tactsim.materials.homogeneous import nominal_stress
from tactsim.materials.library import named_material
from tactsim.validation.curves import Data, Title, curves_figure, panel, series

SetName = Annotated[str, Field(description="Shipped set.")]
FitForm = Annotated[str, Field(description="Form of the fit, as in ``tactsim material --fit``.")]
Measure = Annotated[Literal["max", "rms"], Field(description="Largest error, or root mean square.")]
LARGEST_COMPRESSION = 0.6
"""Smallest stretch, an assumption: the height of the specimen of the compression test is not printed."""
POINTS = 200
"""Evenly spaced stretches at which curves are compared."""
SEARCHED = (1.001, 5.0)
"""Stretches between which a change of sign is looked for; the stress is zero at 1."""


def _constant(material: Material, name: str) -> float:
    constants = material.model_dump(exclude={"kind", "bulk_modulus"})
    if name not in constants:
        raise UnknownName("constant", name, constants)
    return float(constants[name])


@quantity(unit="Pa")
def initial_modulus(material: SetName) -> float:
    """Young's modulus E = 3 G in Pa of an incompressible material set: 6 (c10 + c01) for Mooney-Rivlin.

    Raises
    ------
    UnknownName
        If there is no such set.
    """
    return 3 * named_material(material).material.shear_modulus


@quantity(unit="Pa")
def library_constant(material: SetName, constant: str) -> float:
    """A constant in Pa as the library holds it.

    Parameters
    ----------
    constant : name of the constant

    Raises
    ------
    UnknownName
        If there is no such set or constant.
    """
    return _constant(named_material(material).material, constant)


@quantity(unit="1")
def rotated_stress(material: SetName) -> float:
    r"""Largest difference of :math:`\sigma(Q F)` and :math:`Q \sigma(F) Q^T` over the largest stress; zero if objective.

    The Cauchy stress is :math:`P F^T / J`, at a general volume-preserving deformation and a turn about no axis of it. A stress of
    the right Cauchy-Green tensor, as 3.1.1 to 3.1.3 read (E19), does not turn with the body.

    Raises
    ------
    UnknownName
        If there is no such set.
    """
    law = named_material(material).material
    F = np.array([[1.1, 0.3, -0.1], [0.05, 0.8, 0.2], [-0.15, 0.1, 1.2]])
    F /= np.linalg.det(F) ** (1 / 3)
    Q = scipy.spatial.transform.Rotation.from_rotvec([0.4, -0.7, 0.5]).as_matrix()

    def cauchy_stress(gradient: Array) -> Array:
        stress: Array = law.first_piola_kirchhoff(gradient[..., None], np.zeros(1))[..., 0] @ gradient.T
        return stress

    turned = Q @ cauchy_stress(F) @ Q.T
    return float(np.abs(cauchy_stress(Q @ F) - turned).max() / np.abs(turned).max())


@cache
def compression_curve(name: str) -> UniaxialCurve:
    """The curve that stands for the unpublished data of Fig. 3.8: nominal stress of a material set by 3.1.9 with c11.

    At evenly spaced stretches from ``LARGEST_COMPRESSION`` to just below 1.

    Raises
    ------
    UnknownName
        If there is no such set.
    """
    stretch = _stretches(LARGEST_COMPRESSION)
    return UniaxialCurve(stretch, uniaxial_nominal_stress(named_material(name).material, stretch), name)


@cache
def fitted(name: str, form: str) -> UniaxialFit:
    """The relative least-squares fit of a form to the curve of a material set.

    Raises
    ------
    UnknownName
        If there is no such set or form.
    """
    return fit_uniaxial(compression_curve(name), form)


def _stretches(smallest: float) -> Array:
    """Evenly spaced stretches up to one spacing below 1, where all stresses vanish."""
    return np.linspace(smallest, 1.0, POINTS + 1)[:-1]


@quantity(unit="1")
def fit_error(material: SetName, form: FitForm, measure: Measure = "max") -> float:
    """Relative error of the nominal stress of a fit to the uniaxial compression curve of a set.

    Raises
    ------
    UnknownName
        If there is no such set or form.
    """
    fit = fitted(material, form)
    return fit.max_relative_error if measure == "max" else fit.rms_relative_error


@quantity(unit="1")
def difference_of_fits(material: SetName, forms: Annotated[tuple[FitForm, ...], Field(min_length=2)]) -> float:
    """Largest relative difference of the nominal stress between any two fits to the uniaxial compression curve of a set.

    Parameters
    ----------
    forms : forms of the fits

    Raises
    ------
    UnknownName
        If there is no such set or form.
    """
    stretch = compression_curve(material).stretch
    stresses = np.stack([np.abs(uniaxial_nominal_stress(fitted(material, form).material, stretch)) for form in forms])
    return float((stresses.max(axis=0) / stresses.min(axis=0) - 1).max())


@quantity(unit="1")
def material_error(
    *,
    material: AnyMaterial,
    reference: SetName,
    between: tuple[Annotated[float, Field(gt=0, lt=1)], Literal[1]] = (0.6, 1),
    measure: Measure,
) -> float:
    """Relative error of the uniaxial nominal stress of a material against a reference set.

    Parameters
    ----------
    material : shipped set or constants that are judged
    reference : shipped set that it stands for
    between : stretches; at 1 both stresses vanish, so the last point lies one spacing below

    Raises
    ------
    UnknownName
        If there is no such set.
    """
    stretch = _stretches(between[0])
    judged, true = (nominal_stress(law, "uniaxial", stretch) for law in (material, named_material(reference).material))
    error = judged / true - 1
    return float(np.abs(error).max() if measure == "max" else np.sqrt(np.mean(error**2)))


@quantity(unit="Pa")
def corrected_stress(material: SetName, stretch: float) -> float:
    """True uniaxial stress in Pa at a stretch by 3.1.9 corrected: W1 and W2 keep the terms of c11.

    Parameters
    ----------
    stretch : stretch along the load

    Raises
    ------
    UnknownName
        If there is no such set.
    """
    return float(uniaxial_nominal_stress(named_material(material).material, np.array([stretch]))[0]) * stretch


@quantity(unit="1")
def printed_stress_sign(material: SetName) -> float:
    """Stretch in tension at which the stress of 3.1.9 as printed (no c11) changes its sign.

    Parameters
    ----------
    material : shipped set with c10 and c01

    Raises
    ------
    UnknownName, InputError
        If there is no such set, or the stress keeps its sign.
    """
    constants = named_material(material).material.model_dump()

    def stress(stretch: float) -> float:
        return float(uniaxial_stress_as_printed(constants["c10"], constants["c01"], np.array(stretch)))

    if stress(SEARCHED[0]) * stress(SEARCHED[1]) > 0:
        raise InputError(f"the printed stress of {material} keeps its sign up to a stretch of {SEARCHED[1]:g}")
    return float(scipy.optimize.brentq(stress, *SEARCHED, xtol=1e-12))


@quantity(unit="1")
def ellipticity_window(
    *, material: SetName, path: Literal["uniaxial", "planar"] = "uniaxial", end: Literal["lower", "upper"]
) -> float:
    """Stretch at one end of the compression window in which a material set is not strongly elliptic.

    Parameters
    ----------
    path : loading path
    end : which end

    Raises
    ------
    UnknownName, InputError
        If there is no such set, or it loses strong ellipticity in no or in several windows.
    """
    from tactsim.materials.stability_range import stability_range

    windows = stability_range(named_material(material).material).paths[path].elliptic_lost
    compressed = [window for window in windows if window[1] < 1]
    if len(compressed) != 1:
        raise InputError(f"{material} loses strong ellipticity in {len(compressed)} windows of {path} compression")
    return compressed[0][0 if end == "lower" else 1]


@drawing
def uniaxial_fits(title: Title, material: SetName, forms: tuple[str, ...]) -> Data:
    """Nominal stress in Pa of a material set with fits of several forms, relative errors in percent below, as Fig. 3.8.

    Parameters
    ----------
    forms : forms of the fit

    Raises
    ------
    UnknownName
        If there is no such set or form.
    """
    curve = compression_curve(material)
    stretch, stress = curve.stretch, curve.nominal_stress
    stresses, errors = [series("3.1.9 with c11, constants of Table 3.1", stretch, stress, "points")], []
    for form in forms:
        fit = fitted(material, form)
        model = uniaxial_nominal_stress(fit.material, stretch)
        label = f"{form}: max {100 * fit.max_relative_error:.1f} %, rms {100 * fit.rms_relative_error:.1f} %"
        stresses.append(series(label, stretch, model))
        errors.append(series(label, stretch, 100 * (model / stress - 1)))
    panels = [panel("nominal stress", "Pa", stresses), panel("relative error in %", "", errors)]
    return curves_figure(title, "stretch", "", panels)
