"""Limits on small-strain moduli that every material keeps."""

from __future__ import annotations

from tactsim.units import Positive, Pressure

LARGEST_BULK_TO_SHEAR_RATIO = 1e7
"""Assumption: beyond it p / K, of the order of G / K, drowns in the round-off of J - 1 after a solve."""

BulkModulus = Positive[Pressure]
"""Bulk modulus in Pa."""


def youngs_modulus(shear_modulus: float, bulk_modulus: float | None) -> float:
    """E = 9KG / (3K + G) in Pa from G and K in Pa, 3G if K is None (incompressible).

    Source: Landau & Lifshitz 1986, Theory of Elasticity, section 5.
    """
    G, K = shear_modulus, bulk_modulus
    return 3 * G if K is None else 9 * K * G / (3 * K + G)


def poisson_ratio(shear_modulus: float, bulk_modulus: float | None) -> float:
    """nu = (3K - 2G) / (6K + 2G), dimensionless, from G and K in Pa, 1/2 if K is None (incompressible).

    Source: Landau & Lifshitz 1986, Theory of Elasticity, section 5.
    """
    G, K = shear_modulus, bulk_modulus
    return 0.5 if K is None else (3 * K - 2 * G) / (6 * K + 2 * G)


def check_moduli(shear_modulus: float, bulk_modulus: float | None) -> None:
    """Check that a simulation can use these moduli in Pa.

    Raises
    ------
    ValueError
        Naming the modulus, its value and what is allowed.
    """
    if not shear_modulus > 0:
        raise ValueError(f"small-strain shear modulus = {shear_modulus:g} Pa; it must be > 0 Pa")
    if bulk_modulus is not None and bulk_modulus > LARGEST_BULK_TO_SHEAR_RATIO * shear_modulus:
        raise ValueError(
            f"bulk modulus = {bulk_modulus:g} Pa is {bulk_modulus / shear_modulus:.2g} times the shear modulus; "
            f"allowed are up to {LARGEST_BULK_TO_SHEAR_RATIO:g} times: use null, exactly incompressible, instead"
        )
