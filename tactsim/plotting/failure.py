"""What is said of a run that did not end as it should, across the foot of its figure, and of a picture that cannot be made."""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure

from tactsim.results import Result, Status

FAILED_COLOUR = "#b00020"
LETTERS_PER_INCH = 9
"""Of the words across the foot."""


def mark_failure(figure: Figure, result: Result, where: str = "") -> None:
    """Writes status and reason across the foot, in up to four lines, and draws a coloured frame, unless the run converged.

    Parameters
    ----------
    where : what follows the status, such as " at 2 s"
    """
    if result.status is Status.CONVERGED:
        return
    words = f"{str(result.status).upper()}{where}: {result.reason}"
    lines = textwrap.wrap(words, int(LETTERS_PER_INCH * figure.get_figwidth()), max_lines=4, placeholder=" …")
    figure.set_layout_engine("constrained", w_pad=0.12, h_pad=0.1)
    figure.supxlabel("\n".join(lines), color=FAILED_COLOUR, fontsize=9.5, fontweight="bold")
    figure.patch.set(edgecolor=FAILED_COLOUR, linewidth=5)
