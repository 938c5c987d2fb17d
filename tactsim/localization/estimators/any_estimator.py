"""The estimator of a case file: any registered kind."""

from __future__ import annotations

from typing import Annotated

from tactsim.localization.interface import Estimator
from tactsim.registry import Registered

AnyEstimator = Annotated[Estimator, Registered(Estimator)]
"""Pydantic type of an estimator."""
