"""The command line with the pretended experiment instead of the real ones: ``python pretended_cli.py run CASE``."""

from __future__ import annotations

import pretence

from tactsim import display
from tactsim.case import model
from tactsim.cli import main

if __name__ == "__main__":
    model.kinds = lambda package, base: {"pretence": pretence.Pretence}  # type: ignore[assignment]
    display.figures_for = lambda result: {"pretence": lambda: pretence.PNG}  # type: ignore[attr-defined]
    raise SystemExit(main())
