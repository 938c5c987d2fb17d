"""Where Newton starts a grasp from."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.path import grasped_block

CLOSING = 1e-3


class Model:
    """Remembers what it is asked to start from; its uniform compression is one everywhere."""

    space, body = None, SimpleNamespace(pattern=None)

    def __init__(self, *facets):
        self.facets = dict.fromkeys(facets)

    def compressed(self, closing):
        return np.ones(4)

    def equilibrium(self, now, closing, guess, **settings):
        return guess


@pytest.mark.parametrize(("facets", "first"), [(("upper", "lower"), 1.0), (("upper", "lower", "lumen:1"), 0.0)])
def test_a_hollow_tube_is_not_squeezed_by_the_first_guess(facets, first):
    rest = SimpleNamespace(load=0.0, unknowns=np.zeros(4))
    computed = grasped_block(Grasp.example(), Model(*facets)).equilibrium(rest, (CLOSING,), np.zeros(5), None)
    assert (computed == first).all()
