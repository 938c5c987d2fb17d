"""Estimators judged with references of the tissue that was grasped, and of others: docs/verification/estimators.json and .md.

python benchmarks/estimator_references.py --work FOLDER [--samples 64] [--out docs/verification]

FOLDER keeps the plain grasps and the data set, which are not computed again. The grasps of ``cases/sweep_judged.yaml`` are drawn
with a seed by which no setting of ``model_based`` was chosen; the prior of ``hypotheses`` was changed after half of them were
seen. They take some seconds each, the judging a quarter of an hour.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tactsim.cli import main
from tactsim.dataset.ranking.intervals import share
from tactsim.dataset.ranking.measures import JudgedEstimate, measures, outcome
from tactsim.dataset.ranking.samples import JudgedSamples, Truth, judged_samples
from tactsim.dataset.use.loading import load
from tactsim.experiments.localization.response_store import stored_response
from tactsim.interfaces import Estimator
from tactsim.interfaces.readings import Readings
from tactsim.localization.estimators.hypotheses import HypothesesEstimator
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.localization.lump_response import LumpResponse
from tactsim.localization.plain_parts import plain_parts_warning
from tactsim.materials.library import named_material

ROOT = Path(__file__).parents[1]
REPORT = ROOT / "docs" / "verification"
SCHEMA = "tactsim/estimator-references/1"
SEED, SAMPLES = 21, 64
CLOSINGS = ("0.5", "0.65", "0.8", "1", "1.2")
"""Of the plain grasps, in mm per jaw, as text."""
SOFTER = 0.8
REFERENCES = {
    "matched": "the tissue that was grasped",
    "friction": "friction 0.4 instead of 0.6",
    "softer": "tissue 20 % softer",
}
FACTOR, RIGID = "one factor fitted", "no factor"
ESTIMATORS: dict[tuple[str, str], Estimator] = {
    ("model_based", FACTOR): ModelBasedEstimator(),
    ("model_based", RIGID): ModelBasedEstimator(factor_spread=0.0),
    ("hypotheses", FACTOR): HypothesesEstimator(),
    ("hypotheses", RIGID): HypothesesEstimator(factor_spread=0.0),
    ("thesis with reference", RIGID): ThesisEstimator(background="reference"),
}
KEPT_ROWS = 4
"""Samples whose estimates are kept one by one, so that a test can make them anew."""
COLUMNS = (
    ("found", ("detection_rate",), "%"),
    ("false alarms", ("false_alarm_rate",), "%"),
    ("off in plan [mm]", ("lateral_error", "median"), "mm"),
    ("off in height [mm]", ("depth_error", "median"), "mm"),
    ("in the 90 % region", ("coverage",), "%"),
    ("its width [mm]", ("region_width",), "mm"),
    ("warned, lumps", ("warned_with_lump",), "%"),
    ("warned, plain", ("warned_without_lump",), "%"),
)


def overrides(reference: str, closing: str) -> list[str]:
    """What distinguishes a plain grasp from ``cases/grasp_plain.yaml``."""
    changed = {
        "experiment.time.steps": "1",
        "experiment.mesh": "{kind: graded, size: 8 mm, inclusion_size: 4 mm, edge_size: 2.2 mm, growth: 1}",
        "experiment.loading.pieces": f"[{{kind: ramp, to: {closing} mm, duration: 1 s}}]",
    }
    if reference == "friction":
        changed["experiment.contact.friction"] = "0.4"
    if reference == "softer":
        tissue = named_material("icf_stable").material.model_dump(include={"c10", "c01", "c11"})
        constants = ", ".join(f"{name}: {SOFTER * value:g} Pa" for name, value in tissue.items())
        changed["experiment.block.tissue"] = f"{{kind: mooney_rivlin_3, {constants}}}"
    return [part for key, value in changed.items() for part in ("--set", f"{key}={value}")]


def plain_grasps(work: Path, reference: str) -> list[str]:
    """Folders of the plain grasps of a reference, run unless they are there."""
    folders = []
    for closing in CLOSINGS:
        folder = work / "ref" / f"{reference}_{closing}"
        if not (folder / "result.json").exists():
            order = ["run", str(ROOT / "cases/grasp_plain.yaml"), "--out", str(folder), "--quiet", "--figures", "none"]
            run(order + overrides(reference, closing))
        folders.append(str(folder))
    return folders


def grasps(work: Path, samples: int) -> Path:
    """The data set, computed as far as it is not there."""
    place = work / "judged.zarr"
    if not place.exists():
        sweep = ["sweep", str(ROOT / "cases/sweep_judged.yaml"), "--out", str(place), "--set", f"sweep.seed={SEED}"]
        run([*sweep, "--samples", str(samples), "--workers", "1", "--quiet"])
    return place


def run(order: Sequence[str]) -> None:
    """One command of tactsim."""
    if main(list(order)) != 0:
        raise SystemExit(f"tactsim {' '.join(order)} failed")


def estimated(estimator: Estimator, readings: Readings, truth: Truth) -> tuple[JudgedEstimate, dict[str, Any]]:
    """One estimate against the truth, and what is kept of it."""
    estimate = estimator.estimate(readings)
    center = [round(1e3 * value, 3) for value in estimate.inclusions[0].center] if estimate.inclusions else None
    factor = None if estimate.factor is None else round(estimate.factor, 4)
    warned = plain_parts_warning(readings, estimate) is not None
    return outcome(estimate, truth), {"sample": truth.sample, "center_mm": center, "factor": factor, "warned": warned}


def judged(estimator: Estimator, samples: JudgedSamples, response: LumpResponse) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Measures of an estimator with its warnings, and its first estimates one by one."""
    each = [estimated(estimator, *one) for one in zip(samples.readings(response), samples.truths, strict=True)]
    numbers = measures([one for one, _ in each], samples.block_size)
    for name, present in (("warned_with_lump", True), ("warned_without_lump", False)):
        numbers[name] = share((one.truth.group, row["warned"]) for one, row in each if one.truth.present is present)
    factors = [row["factor"] for _, row in each if row["factor"] is not None]
    numbers["factor"] = float(np.median(factors)) if factors else None
    return numbers, [row for _, row in each[:KEPT_ROWS]]


def record(work: Path, samples: int, references: Sequence[str] = tuple(REFERENCES), kinds: Sequence[str] = ()) -> dict[str, Any]:
    """All numbers, in SI but for the places of the first samples; ``kinds`` of estimators, by default all."""
    store, entries, noise, truths = grasps(work, samples), [], None, ()
    for reference in references:
        folders = plain_grasps(work, reference)
        given, response = judged_samples(store, folders), stored_response(folders[-1])
        noise, truths = noise or float(np.median(given.noise)), given.truths
        for (kind, factor), estimator in ESTIMATORS.items():
            if not kinds or kind in kinds:
                numbers, rows = judged(estimator, given, response)
                head = {"reference": reference, "estimator": kind, "factor": factor}
                entries.append({**head, "measures": numbers, "first_samples": rows})
    lumps = sum(truth.present for truth in truths)
    return {
        "schema": SCHEMA,
        "command": f"python benchmarks/estimator_references.py --work FOLDER --samples {samples}",
        "case": "cases/sweep_judged.yaml",
        "seed": SEED,
        "samples": len(truths),
        "lumps": lumps,
        "done": int(load(store).sizes["sample"]),
        "noise": noise,
        "references": REFERENCES,
        "entries": entries,
    }


def as_text(content: Mapping[str, Any]) -> str:
    """The report in Markdown."""
    heads = ["reference", "estimator", "", *(name for name, _, _ in COLUMNS)]
    lines = [
        "# Estimators and their references",
        "",
        f"Made by `{content['command']}` from `{content['case']}` with the seed {content['seed']}: {content['samples']} grasps, "
        f"{content['lumps']} with a lump, {content['samples'] - content['lumps']} without, "
        f"read with {1e3 * content['noise']:.2f} mN of noise. In brackets the 95 % interval, of rates by Wilson.",
        "",
        "An estimator compares with a grasp of plain tissue, the reference. Good numbers belong to a reference of the tissue "
        "that was grasped; what another reference costs stands beside them. *Warned* counts grasps of which `result.warnings` "
        "doubts the reference: the readings away from the estimate do not fit it, or, where too few taxels lie away from it, "
        "those of all are a multiple of it or a fitted factor cannot be told from what the inclusions do.",
        "",
        f"| {' | '.join(heads)} |",
        "|" + " --- |" * len(heads),
    ]
    for entry in content["entries"]:
        words = content["references"][entry["reference"]]
        cells = [
            words,
            f"`{entry['estimator']}`",
            entry["factor"],
            *(_cell(entry["measures"], *column[1:]) for column in COLUMNS),
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _cell(numbers: Mapping[str, Any], place: Sequence[str], unit: str) -> str:
    entry: Any = numbers
    for key in place:
        entry = None if entry is None else entry[key]
    if entry is None:
        return "-"
    scale, digits = (100, 0) if unit == "%" else (1e3, 1)
    value, low, high = (f"{scale * entry[name]:.{digits}f}" for name in ("value", "low", "high"))
    return f"{value}{' %' if unit == '%' else ''} [{low}, {high}]"


def write(content: Mapping[str, Any], folder: Path) -> None:
    """estimators.json and estimators.md."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "estimators.json").write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    (folder / "estimators.md").write_text(as_text(content), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--samples", type=int, default=SAMPLES)
    parser.add_argument("--out", type=Path, default=REPORT)
    arguments = parser.parse_args()
    write(record(arguments.work, arguments.samples), arguments.out)
