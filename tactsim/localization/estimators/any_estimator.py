"""The estimator of a case file, any registered kind, chosen by ``kind``; and those that are offered without settings."""

from __future__ import annotations

from typing import Annotated

from tactsim.interfaces import Estimator
from tactsim.registry import Registered, kinds

AnyEstimator = Annotated[Estimator, Registered(Estimator)]
"""Pydantic type of an estimator."""


def offered_estimators() -> dict[str, Estimator]:
    """Name -> every variant of every registered estimator, those first that need and give least."""
    variants: dict[str, Estimator] = {}
    for cls in kinds(Estimator).values():
        variants |= cls.variants()

    def demand(name: str) -> tuple[bool, bool, bool, str]:
        one = variants[name]
        return one.needs_reference, one.needs_response, one.gives_classes, name

    return {name: variants[name] for name in sorted(variants, key=demand)}
