"""The command line with the pretended experiment beside the real ones: ``python pretended_cli.py run CASE``."""

from __future__ import annotations

import pretence

from tactsim import plotting
from tactsim.cli import main

if __name__ == "__main__":
    plotting.figures_for = lambda result: {"pretence": lambda: pretence.PNG}  # type: ignore[attr-defined]
    raise SystemExit(main())
