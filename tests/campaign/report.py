"""What a campaign says: a table of its outcomes, and the page of the documentation that holds it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from campaign.record import ANSWERS, first_runs, last_runs
from campaign.trials import OUTCOMES, Ended
from tactsim.dataset.ranking.intervals import share

WANTED = 0.99
"""Part of the sensible cases that must be answered."""
LONGEST_REASON = 300
"""Characters of a reason that a table shows."""

INTRODUCTION = """\
# Random cases

Convergence should not depend on experience with this program. These cases were drawn at random within what a user could sensibly
write: indentations by an annulus, a ball or a flat punch of shipped and other tissues, and grasps of blocks with up to two lumps;
`tests/campaign/random_cases.py` holds the ranges. A case is a function of its seed and number, so that each can be made again.
At least {wanted:.0%} of the sensible cases shall be answered, none may hang, and none may lie.

*Answered* means that the case converged, or that it asked for a threshold that lies beyond its displacement, which is an answer
too. *Refused* cases, such as lumps too near to a face, are no sensible ones and are left out of the share. *Wrong* is a result
that contradicts itself: an internal error, values that are not finite, forces that do not add up, tissue turned inside out.
Some of these checks are younger than the run of seed 28: missing numbers, forces of the lower jaw and of the base, penetration,
and displacements cut short. *Hung* is what does not end {patience:g} s after its time limit. *Stopped by time* depends on
the machine and on what else it does: the limit is by the clock, and the seconds of the processor stand beside it. In brackets
the 95 % interval by Wilson.
"""


def table_text(record: Sequence[Ended]) -> str:
    """Markdown: kinds and how many of their cases ended in which way."""
    counts = Counter((one.kind, one.outcome) for one in record)
    lines = [
        "| kind | cases | " + " | ".join(OUTCOMES) + " | answered of those not refused |",
        "|---" * (len(OUTCOMES) + 3) + "|",
    ]
    for kind in sorted({one.kind for one in record}):
        numbers = [counts[kind, outcome] for outcome in OUTCOMES]
        earnest = [one.outcome in ANSWERS for one in record if one.kind == kind and one.outcome != "refused"]
        lines.append(f"| {kind} | {sum(numbers)} | " + " | ".join(map(str, numbers)) + f" | {share_text(earnest)} |")
    return "\n".join(lines) + "\n"


def share_text(answered: Sequence[bool]) -> str:
    """Part of the answered ones in percent with its interval."""
    part = share(enumerate(answered))
    return f"{part['value']:.1%} [{part['low']:.1%}, {part['high']:.1%}]".replace("%", " %") if part else "-"


def page(record: Sequence[Ended], *, asked: int | None, limit: float, patience: float) -> str:
    """The page: what was run and how, the first runs, what failed and why, and what came of the failed ones later."""
    first = first_runs(record)
    seeds = sorted({one.seed for one in first})
    kinds = sorted({one.kind for one in first})
    command = f"scripts/campaign --seed {seeds[0]} --cases {asked or max(one.number for one in first) + 1} --no-faults"
    of = f" of {asked} asked" if asked else ""
    ran = ", ".join(f"{sum(one.kind == kind for one in first)}{of} of the kind `{kind}`" for kind in kinds)
    texts = [
        INTRODUCTION.format(patience=patience, wanted=WANTED).replace("99%", "99 %"),
        f"<!-- not run: takes hours -->\n```text\n{command} {' '.join(kinds)}\n```\n",
        f"Run so far: {ran}, with a limit of {limit:g} s and one thread each. {_times(first)}\n",
        "## First run\n",
        table_text(first),
        _programs(first),
        "## What was not answered\n",
        _failures(first, last_runs(record)),
    ]
    if len(record) > len(first):
        texts += ["## The failed ones run again\n", _again(record, first)]
    return "\n".join(texts)


def _times(record: Sequence[Ended]) -> str:
    seconds = [one.processor_seconds for one in record]
    return f"A case took {np.median(seconds):.1f} s of the processor in the middle, {max(seconds):.0f} s at most."


def _programs(record: Sequence[Ended]) -> str:
    counts = Counter(one.program for one in record)
    return "Programs: " + ", ".join(f"`{program}` ({count} cases)" for program, count in counts.items()) + ".\n"


def _failures(first: Sequence[Ended], last: dict[tuple[str, int], Ended]) -> str:
    """A row for each case that was not answered at first, with its reason and what it did last."""
    rows = [one for one in first if one.outcome not in ANSWERS]
    lines = ["| case | outcome | processor [s] | reason | run again |", "|---|---|---|---|---|"]
    for one in sorted(rows, key=lambda one: (one.kind, one.outcome, one.number)):
        latest = last[one.kind, one.number]
        again = "" if latest is one else latest.outcome
        if again and latest.outcome not in ANSWERS:
            again += f": {_shown(latest.reason)}"
        lines.append(
            f"| {one.kind} {one.number} | {one.outcome} | {one.processor_seconds:.0f} | {_shown(one.reason)} | {again} |"
        )
    return "\n".join(lines) + "\n"


def _shown(reason: str) -> str:
    """A reason in a cell of a table."""
    words = re.sub(r"^error: (case\.yaml(:\d+)?: )?", "", " ".join(reason.split()))
    words = words if len(words) <= LONGEST_REASON else words[: LONGEST_REASON - 3] + "..."
    return words.replace("|", "\\|").replace("<", "&lt;")


def _again(record: Sequence[Ended], first: Sequence[Ended]) -> str:
    """What came of the cases that were run again, and the share if those outcomes stood for the first ones."""
    initial = {id(one) for one in first}
    again = list(last_runs(one for one in record if id(one) not in initial).values())
    words = (
        "With the program as it was mended since. The last column of this table concerns those cases only; if their new outcomes "
        "stand for the old ones, all cases read"
    )
    return "\n".join([table_text(again), _programs(again), f"{words}\n", table_text(list(last_runs(record).values()))])
