"""A law of friction as a case file names it."""

from __future__ import annotations

from typing import Annotated, Any

from tactsim.interfaces import ContactLaw
from tactsim.registry import Registered

AnyLaw: Any = Annotated[ContactLaw, Registered(ContactLaw)]
