"""The 200 grasps of ``plot_story_lump_detector.py``: computes the data set and keeps what a detector needs in ``grasps.npz``.

Run as ``python docs/gallery/stored/make_grasps.py``. A run that was stopped goes on where it ended.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import tactsim as ts

TISSUE = ts.material("icf_stable")
NO_LUMP = ts.MooneyRivlin3(c10=TISSUE.c10, c01=1.000001 * TISSUE.c01, c11=TISSUE.c11)
"""The tissue, but for a millionth: the mesh still follows the sphere, so that the mesh does not tell which block has a lump."""


def grasp() -> ts.Grasp:
    """A block with a sphere in it, two jaws of 3 x 3 taxels with film and electronics; a coarse mesh, one step."""
    return ts.Grasp(
        block=ts.Block(size=("40 mm", "40 mm", "20 mm"), tissue=TISSUE),
        inclusions=[ts.Embedded(shape=ts.Sphere(center=("20 mm", "20 mm", "10 mm"), radius="4 mm"), material="lump")],
        matrix=ts.TaxelLayout(rows=3, columns=3, pitch="10 mm", size="9 mm"),
        contact=ts.Coulomb(friction=0.6),
        loading=ts.close(to="1 mm", duration="1 s"),
        mesh={"kind": "graded", "size": "8 mm", "inclusion_size": "4 mm", "edge_size": "2.2 mm", "growth": 1},
        time={"steps": 1},
        penetration_tolerance="10 um",
        readout={
            "film": {"composite": "lingstat_identified"},
            "chain": {
                "sampling_rate": "200 Hz",
                "noise": {"white": "0.2 mV", "line": "0.5 mV"},
                "converter": {"low": "-5 V", "high": "5 V", "bits": 16},
                "low_pass": {"cutoff": "40 Hz", "order": 1},
            },
        },
    )


def main() -> None:
    """100 blocks, half of them with a lump, each grasped twice with another closing and another friction."""
    varied = grasp().vary(
        {
            "inclusions.0.shape.center": [
                ts.uniform("9 mm", "31 mm"),
                ts.uniform("9 mm", "31 mm"),
                ts.uniform("6 mm", "14 mm"),
            ],
            "inclusions.0.shape.radius": ts.uniform("2.5 mm", "5 mm"),
            "inclusions.0.material": {
                "choice": [{"kind": "neo_hookean", "c10": ts.log_uniform("6 kPa", "100 kPa")}, written(NO_LUMP)],
                "weights": [0.5, 0.5],
            },
            "loading.pieces.0.to": ts.uniform("0.8 mm", "1.2 mm"),
            "contact.friction": ts.uniform(0.3, 0.8),
            "readout.seed": {"integer": [0, 4294967295]},
        }
    )
    store = Path("results/gallery_grasps.zarr")
    data = ts.sweep(
        varied,
        samples=200,
        out=store,
        workers=int(sys.argv[1]) if len(sys.argv) > 1 else 2,
        resume=store.exists(),
        title="Lump or no lump, 200 grasps of 100 blocks",
        seed=4,
        samples_per_specimen=2,
        within_specimen=["experiment.loading.pieces.0.to", "experiment.contact.friction", "experiment.readout.seed"],
    )
    np.savez_compressed(
        Path(__file__).with_name("grasps.npz"),
        read_force=data["read_force"].values[:, 0].astype(np.float32),
        specimen=data["specimen"].values.astype(np.int16),
        lump=data["varied_inclusions_0_material"].values == 0,
        contrast=data["inclusion_contrast"].values[:, 0].astype(np.float32),
        radius=data["inclusion_radius"].values[:, 0].astype(np.float32),
        center=data["inclusion_center"].values[:, 0].astype(np.float32),
        closing=data["closing"].values.astype(np.float32),
        friction=data["friction"].values.astype(np.float32),
    )


def written(model: ts.Material) -> dict:
    """A material as a case file holds it."""
    return model.model_dump(mode="json", context={"units": "written"})


if __name__ == "__main__":
    main()
