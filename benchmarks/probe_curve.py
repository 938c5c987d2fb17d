"""Prints the elastic curve of chapter 5's probe, from finite elements, as the module `probe_curve` of the experiment holds it.

python benchmarks/probe_curve.py
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

from tactsim.experiments.switch_probe.probe_curve import CHAPTER_5
from tactsim.experiments.switch_probe.probe_indentation import probe_states
from tactsim.experiments.switch_probe.setup import ProbeTissue
from tactsim.experiments.switch_probe.switch_probe import SwitchProbe
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.paths.loading import DisplacementLoading

ELASTIC = NeoHookean(c10=5e3)


def rows() -> Iterator[tuple[float, float, float, float]]:
    """Depth, force over shear modulus and width, contact height, force on the first switch over the same; all in mm."""
    probe = SwitchProbe(tissues=(ProbeTissue(name="elastic", material=ELASTIC),), model="fem")
    stops = [float(depth) for depth in CHAPTER_5.depth[1:]]
    pieces = [{"kind": "ramp", "to": stop, "duration": 1.0} for stop in stops]
    loading = DisplacementLoading.model_validate({"control": "displacement", "pieces": pieces})
    setup = probe.indentation(probe.tissues[0], probe.rates[0]).model_copy(update={"loading": loading})
    scale = 1e-3 * ELASTIC.shear_modulus * probe.width
    yield 0.0, 0.0, 0.0, 0.0
    for state in probe_states(setup, probe.array, width=probe.width):
        if min(abs(state.depth - stop) for stop in stops) < 1e-9:
            yield 1e3 * state.depth, state.force / scale, 1e3 * state.contact_height, state.switch_forces[0] / scale


if __name__ == "__main__":
    for depth, force, height, first in rows():
        sys.stdout.write(f"    ({depth:.2f}, {force:.4f}, {height:.3f}, {first:.4f}),\n")
