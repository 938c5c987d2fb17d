"""The first run on a machine, which compiles the loops, gives the numbers of those that find them compiled."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest
from solids import body_of, box

from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2


def strained(measure: str) -> str:
    """Residual and tangent of a strained block, as the hash of all their digits."""
    dim = 3 if measure == "solid" else 2
    body = body_of(box((1.0,) * dim, (2,) * dim, jitter=0.1), measure, MooneyRivlin2(c10=80.0, c01=20.0))
    unknowns = np.random.default_rng(0).uniform(-0.02, 0.02, body.space.size)
    together = np.concatenate([body.residual(unknowns), body.tangent(unknowns)])
    return hashlib.sha256(together.tobytes()).hexdigest()


@pytest.mark.slow  # compiles the loops
@pytest.mark.parametrize("measure", ["solid", "axisymmetric"])
def test_loops_give_the_same_compiled_anew_and_from_the_cache(tmp_path, measure):
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}

    def run() -> str:
        command = [sys.executable, __file__, measure]
        return subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout

    anew, kept = run(), run()
    assert len(anew.strip()) == 64
    assert anew == kept


if __name__ == "__main__":
    sys.stdout.write(strained(sys.argv[1]))
