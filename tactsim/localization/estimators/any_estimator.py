"""The estimator of a case file: any registered kind, told apart by ``kind``."""

from __future__ import annotations

from tactsim.localization.interface import Estimator
from tactsim.registry import tagged_union

PACKAGE = "tactsim.localization.estimators"
AnyEstimator = tagged_union(PACKAGE, Estimator)
"""Pydantic type of an estimator."""
