"""The command line with the pretended experiment beside the real ones: ``python pretended_cli.py run CASE``."""

from __future__ import annotations

import pretence

from tactsim import plotting
from tactsim.cli import main


def pretend() -> None:
    """Give the pretended experiment, which the import of its module registers, its figure."""
    plotting.figures_for = lambda result: {"pretence": lambda: pretence.PNG}


if __name__ == "__main__":
    pretend()
    raise SystemExit(main())
