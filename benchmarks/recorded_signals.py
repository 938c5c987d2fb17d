"""Writes the recorded signals of the annulus from the history of a run: cases/data/annulus_icf_signals.csv.

tactsim run cases/annulus_icf.yaml --set experiment.stop=displacement --set "experiment.displacement=4.6 mm" --out results/signals
python benchmarks/recorded_signals.py results/signals
"""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

RECORDED = Path(__file__).parents[1] / "cases" / "data" / "annulus_icf_signals.csv"
COLUMNS = ("displacement [m]", "reaction_force [N]", "tissue_rise [m]", "sensor_force [N]")


def signals(result: Path) -> list[list[float]]:
    """Displacement in m, force on the plate in N, rise in m and force on the small sensor in N, from the state at rest on."""
    with (result / "history.csv").open(encoding="utf-8", newline="") as file:
        rows = [[float(row[column]) for column in COLUMNS] for row in csv.DictReader(file)]
    return [[0.0] * len(COLUMNS), *rows]


def write(result: Path) -> None:
    """The recorded file, with how it was made."""
    document = json.loads((result / "result.json").read_text(encoding="utf-8"))
    if document["status"] != "converged":
        sys.exit(f"{result}: {document['status']}, {document['reason']}; nothing is recorded")
    touch = 1e3 * document["quantities"]["threshold_displacement"]["value"]
    lines = [
        f"# Annular hardness sensor on ICF: forces on filler plate and small sensor over displacement, touch at {touch:.4f} mm.",
        '# Made by: tactsim run cases/annulus_icf.yaml --set experiment.stop=displacement --set "experiment.displacement=4.6 mm"',
        "# and python benchmarks/recorded_signals.py RESULT. Specimen: icf_stable, 10 mm thick, radius 15 mm,",
        f"# fixed base, friction 0.4; annulus 1.5 mm / 3 mm, fillet 0.2 mm, recess 0.8 mm. Case {document['case_id']}.",
        "displacement [m], plate force [N], tissue rise [m], small sensor force [N]",
        *(", ".join(f"{value:.6e}" for value in row) for row in signals(result)),
    ]
    RECORDED.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
