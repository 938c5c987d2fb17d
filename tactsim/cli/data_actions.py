"""The actions of ``tactsim data``: what each does and takes."""

from __future__ import annotations

import argparse
from pathlib import Path

EXAMPLES = """\
examples:
  tactsim data check lumps.zarr
  tactsim data info lumps.zarr
  tactsim data export lumps.zarr --to lumps_shards --split train
  tactsim run grasp_plain --set experiment.loading.pieces.0.to="1.2 mm" --set experiment.time.steps=12 --out results/plain
  tactsim data train lumps.zarr --reference results/plain --out lumps_estimator.npz
  tactsim data rank judged.zarr --reference results/plain --learned lumps_estimator.npz --out ranking
  tactsim data confusion classes.zarr --reference results/plain --noise '0.63 mN' --out confusion
"""
RANKING, CONFUSION = "ranking", "confusion"
ACTIONS = {
    "check": (
        "find what is damaged, missing, doubled, constant or leaking",
        """\
Reads every sample and finds damaged content (checksums), missing, doubled, constant and not
finite samples, specimens that are in two splits, arrays with other names, units, types, shapes
or words than the sweep writes, and files of others. The exit code is 4 if it finds one.
""",
    ),
    "info": ("print counts, splits and variables with their units", "Prints counts, splits and variables with their units.\n"),
    "export": (
        "write the samples as HDF5, or as Parquet with npz shards",
        """\
Writes the samples that are done as one HDF5 file, or as a folder with an index (Parquet) and
shards (npz).
""",
    ),
    "rank": (
        "judge every estimator by the truth",
        """\
Applies every estimator to every grasp that is done and judges it by the truth: errors, misses,
false alarms, coverage; report.json, report.md and figures go to --out. The reference is the
tissue without a lump, closed in several steps or in several results.
""",
    ),
    "train": (
        "fit the learned estimator",
        """\
Fits the learned estimator (kind: learned) to a part of a store (default: train). The reference
is the tissue without a lump, closed in several steps or in several results.
""",
    ),
    CONFUSION: (
        "count which inclusions are taken for which",
        """\
Counts how often nothing, one lump, two lumps, an artery and two arteries are taken for which, in
grasps that all close as far as the reference; noise is added to the solved forces.
""",
    ),
}
"""What each action is called, does in a line, and does in a paragraph."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the actions, each with the options that it takes."""
    actions = parser.add_subparsers(title="actions", dest="action", metavar="ACTION", required=True)
    for name, (summary, description) in ACTIONS.items():
        examples = "".join(line for line in EXAMPLES.splitlines(keepends=True) if f" {name} " in line)
        action = actions.add_parser(
            name,
            help=summary,
            description=description,
            epilog=f"example:\n{examples}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        action.add_argument("store", metavar="STORE", type=Path, help="folder that tactsim sweep wrote")
        if name not in ("check", "info"):
            action.add_argument("--split", metavar="NAME", action="append", help="only this part; may be repeated")
        needed: list[argparse.Action] = []
        if name == "export":
            words = "file ending in .h5, or folder for Parquet and npz"
            needed.append(action.add_argument("--to", metavar="PLACE", type=Path, required=True, help=words))
        elif name in ("rank", "train", CONFUSION):
            needed = _add_judging(action, name)
        action.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help="show the traceback of an error")
        action.usage = action.format_usage().removeprefix("usage: ").rstrip()
        for option in needed:
            option.required = False  # argparse would only name it, and hide an unknown option; the command says what to give


def _add_judging(action: argparse.ArgumentParser, name: str) -> list[argparse.Action]:
    """The options of what compares samples with a plain grasp; those without which it cannot begin."""
    again, added = "" if name == CONFUSION else "; may be repeated", "default: rounding to 0.1 N"
    words = f"plain grasp{again}"
    needed = [action.add_argument("--reference", metavar="RESULT", action="append", default=[], required=True, help=words)]
    place = "file ending in .npz" if name == "train" else f"folder (default: {RANKING if name == 'rank' else name})"
    out = action.add_argument("--out", metavar="PLACE", type=Path, required=name == "train", help=place)
    if name != CONFUSION:
        added += ", read_force: none"
        words = "what is read (default: read_force if the store has it)"
        action.add_argument("--readings", choices=("read_force", "taxel_force"), help=words)
    action.add_argument("--noise", metavar="FORCE", help=f"added, such as '2 mN' ({added})")
    if name == "rank":
        action.add_argument("--learned", metavar="FILE", type=Path, help="also the estimator that train wrote")
    seeded = "of added noise and of training" if name == "train" else "of added noise and of what is drawn"
    action.add_argument("--seed", metavar="N", type=int, default=1, help=f"{seeded} (default 1)")
    return [*needed, out] if out.required else needed
