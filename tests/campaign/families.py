"""Families of random cases: one of each kind that needs nothing but its case, and harder ones of some kinds.

Each case is a function of its family, seed and number only.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from campaign.posed_cases import layered_indentation, posed_grasp, posed_indentation
from campaign.random_cases import Case, Generator, grasp, indentation, varied_example
from campaign.relaxing_cases import relaxing_grasp, relaxing_indentation
from tactsim.interfaces import Experiment
from tactsim.registry import kinds

NEEDS_FILES = ("localization", "matrix_readout", "confusion", "detectability")
"""Kinds that read a stored grasp or data set: the tests of the faults try them."""
FEW_TRIALS = {
    "threshold_trial": 0.02,
    "elastomer_ranking": 0.02,
    "switch_probe": 0.1,
    "posed_indentation": 0.1,
    "relaxing_grasp": 0.3,
}
"""Share of all cases that a family gets whose runs take minutes."""
MADE: dict[str, tuple[str, Callable[[Generator], Case]]] = {
    "indentation": ("indentation", indentation),
    "grasp": ("grasp", grasp),
    "layered_indentation": ("indentation", layered_indentation),
    "posed_indentation": ("indentation_3d", posed_indentation),
    "posed_grasp": ("grasp", posed_grasp),
    "relaxing_grasp": ("grasp", relaxing_grasp),
    "relaxing_indentation": ("timed_indentation", relaxing_indentation),
}
"""Kind and maker of the families that are no examples with other numbers."""


def random_case(family: str, seed: int, number: int) -> Case:
    """The document of a case of a family."""
    rng = np.random.default_rng([seed, number, *family.encode()])
    kind, make = MADE.get(family, (family, lambda rng: varied_example(family, rng)))
    return {"schema": "tactsim/case/1", "title": f"{family} {number} of seed {seed}", "experiment": {"kind": kind, **make(rng)}}


def all_families() -> list[str]:
    """Names of all families."""
    return list(dict.fromkeys([*(kind for kind in kinds(Experiment) if kind not in NEEDS_FILES), *MADE]))
