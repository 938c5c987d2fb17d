"""What figures share: canvas, off-screen window, cuts; each experiment's own figures stand in its folder."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tactsim.plotting.result_figures import figures_for

__all__ = ["figures_for"]


def __getattr__(name: str) -> Any:
    """``figures_for`` when it is first used: the renderer, a process of its own, does without it."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from tactsim.plotting.result_figures import figures_for

    return figures_for
