"""The extension points by the names that users call them."""

from __future__ import annotations

from typing import Any

from tactsim import interfaces, registry
from tactsim.errors import UnknownName

POINTS = {
    "experiment": interfaces.Experiment,
    "material": interfaces.Material,
    "body": interfaces.RigidBody,
    "contact": interfaces.ContactLaw,
    "inclusion": interfaces.Inclusion,
    "film": interfaces.SensorFilm,
    "estimator": interfaces.Estimator,
}
"""Name -> base class, of those whose kinds a case file can name."""


def kinds(point: str | None = None) -> dict[str, Any]:
    """Kind -> class of everything known for an extension point, such as ``kinds("experiment")["film_test"]``.

    >>> import tactsim as ts
    >>> sorted(ts.kinds("estimator"))
    ['hypotheses', 'learned', 'model_based', 'thesis']
    >>> ts.kinds("body")["annulus"] is ts.Annulus
    True

    Parameters
    ----------
    point : experiment, material, body, contact, inclusion, film or estimator; without one, point -> kind -> class of all

    Raises
    ------
    UnknownName
        If there is no such point.
    """
    if point is None:
        return {name: registry.kinds(base) for name, base in POINTS.items()}
    if not isinstance(point, str) or point not in POINTS:
        raise UnknownName("extension point", point, POINTS)
    return registry.kinds(POINTS[point])
