"""CalculiX on the block: python calculix_block.py LIMIT PROBLEM.npz RESULT.npz. Quadratic tetrahedra C3D10, displacement form."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from block_problem import read

Array = np.ndarray
INCREMENTS_LIMIT = 100
NO_SECOND_TERM = 1e30
"""D2 so large that (J - 1)^4 / D2 is nothing."""


def deck(problem: dict[str, Array]) -> str:
    """Input deck; U = (J - 1)^2 / D1 with D1 = 2 / K."""
    levels = problem["levels"]
    c10, c01, c11 = problem["mooney"]
    compliance = 2 / problem["bulk"]
    tissue = [c10, c01, 0.0, c11, 0.0, compliance[0], NO_SECOND_TERM]
    top, bottom = problem["top"] + 1, problem["bottom"] + 1
    elements = np.column_stack([np.arange(1, len(problem["elements"]) + 1), problem["elements"] + 1])
    nodes = np.column_stack([np.arange(1, len(problem["nodes"]) + 1), problem["nodes"]])
    parts = ["*NODE,NSET=ALL", _rows(nodes, "%d,%.15g,%.15g,%.15g")]
    for region, name in enumerate(("TISSUE", "BALL")):
        parts += [f"*ELEMENT,TYPE=C3D10,ELSET={name}", _rows(elements[problem["regions"] == region], ",".join(["%d"] * 11))]
    parts += ["*NSET,NSET=TOP", _rows(top[:, None], "%d"), "*NSET,NSET=BOTTOM", _rows(bottom[:, None], "%d")]
    parts += ["*MATERIAL,NAME=TISSUE", "*HYPERELASTIC,POLYNOMIAL,N=2", ",".join(f"{value:.15g}" for value in tissue)]
    parts += ["*MATERIAL,NAME=BALL", "*HYPERELASTIC,NEO HOOKE", f"{problem['ball_shear'] / 2:.15g},{compliance[1]:.15g}"]
    parts += [f"*SOLID SECTION,ELSET={name},MATERIAL={name}" for name in ("TISSUE", "BALL")]
    parts += ["*BOUNDARY", "BOTTOM,1,3"]
    for level in levels:
        parts += [f"*STEP,NLGEOM,INC={INCREMENTS_LIMIT}", "*STATIC", "1.,1."]
        parts += ["*CONTROLS,PARAMETERS=FIELD", f"{float(problem['tolerance']):g},1.,,,,,,"]
        parts += ["*BOUNDARY", "TOP,1,2", f"TOP,3,3,{level:.15g}", "*NODE PRINT,NSET=TOP", "RF", "*END STEP"]
    return "\n".join([*parts, ""])


def _rows(table: Array, form: str) -> str:
    return "\n".join(form % tuple(row) for row in table.tolist())


def reactions(text: str, top: Array) -> Array:
    """Forces (n, 3) in N of the last block of a ``.dat`` file, in the order of the nodes ``top``."""
    rows = [line.split() for line in text.rsplit("forces (fx,fy,fz)", 1)[1].splitlines()[1:] if line.strip()]
    by_node = {int(row[0]) - 1: [float(value) for value in row[1:4]] for row in rows}
    return np.array([by_node[int(node)] for node in top])


def main() -> None:
    """Write the deck, run the program on every core for at most ``LIMIT`` seconds, read what it printed."""
    limit, path, result = float(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])
    problem = read(path)
    with tempfile.TemporaryDirectory() as place:
        Path(place, "block.inp").write_text(deck(problem))
        environment = {**os.environ, "OMP_NUM_THREADS": str(os.cpu_count())}
        begin = time.perf_counter()
        try:
            done = subprocess.run(
                ["ccx", "block"], cwd=place, env=environment, capture_output=True, text=True, check=False, timeout=limit
            )
        except subprocess.TimeoutExpired:
            np.savez(result, stopped_seconds=limit)
            return
        seconds = time.perf_counter() - begin
        printed = Path(place, "block.dat")
        if done.returncode or not printed.exists() or "*ERROR" in done.stdout:
            raise SystemExit(f"ccx failed ({done.returncode}): {done.stdout[-2000:]}{done.stderr[-500:]}")
        forces = reactions(printed.read_text(), problem["top"])
    iterations = [done.stdout.count("iteration ")]
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    version = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout.split()[-1]
    np.savez(
        result,
        setup_seconds=0.0,
        step_seconds=[seconds],
        processor_seconds=usage.ru_utime + usage.ru_stime,
        iterations=iterations,
        factorisations=sum(iterations),
        solutions=sum(iterations),
        unknowns=problem["nodes"].size,
        forces=forces,
        version=version,
        peak_megabytes=usage.ru_maxrss / 1024,
    )


if __name__ == "__main__":
    main()
