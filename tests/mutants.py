"""Wrong models that a check has to notice: mutants, as mutation testing calls them."""

from __future__ import annotations

from collections.abc import Callable


def assert_kills(check: Callable[..., None], **mutants: tuple[object, ...]) -> None:
    """Fail, naming them, if ``check`` passes with one of the mutants: by name, the arguments of the check with a wrong model."""
    survivors = [name for name, arguments in mutants.items() if _passes(check, arguments)]
    assert not survivors, f"the check passes with wrong models: {', '.join(survivors)}"


def _passes(check: Callable[..., None], arguments: tuple[object, ...]) -> bool:
    try:
        check(*arguments)
    except AssertionError:
        return False
    return True
