"""What an indentation in space accepts, which part it computes, how it goes past the touch, and heights on curved facets."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact.annulus import Annulus
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.sphere import Sphere
from tactsim.errors import CaseError
from tactsim.experiments.indentation.indentation_3d import Indentation3D, MeshSettings3D
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.fields.surface_peaks import surface_peaks
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mesh.revolved import SweepSymmetry

SOFT = NeoHookean(c10=1000.0)
COARSE = MeshSettings3D(finest=0.7e-3, growth=2.0, coarsest=2e-3, sectors=2)


def thin(**changes):
    specimen = changes.pop("specimen", {})
    given = {
        "specimen": Specimen(**({"material": SOFT, "thickness": 3e-3, "radius": 7e-3} | specimen)),
        "body": Annulus(fillet=0.5e-3),
        "recess": 0.05e-3,
        "displacement": 0.15e-3,
        "mesh": COARSE,
        "steps": {"first": 0.03e-3},
        "penetration_tolerance": 5e-7,
    }
    return Indentation3D(**(given | changes))


@pytest.mark.parametrize(
    ("changes", "part", "images"),
    [
        ({}, SweepSymmetry.QUARTER, 4),
        ({"offset": 1e-3}, SweepSymmetry.HALF, 2),
        ({"tilt_y": "2 deg"}, SweepSymmetry.HALF, 2),
        ({"tilt_x": "2 deg"}, SweepSymmetry.WHOLE, 1),
    ],
)
def test_the_smallest_part_is_computed(changes, part, images):
    assert thin(**changes).symmetry is part
    assert len(part.mirrors) == images
    assert part.quarters * images == 4


@pytest.mark.slow
def test_it_stops_at_the_threshold():
    touched = thin().run()
    assert touched.status == "converged"
    assert touched.quantities["tissue_rise"].value == pytest.approx(0.05e-3, rel=1e-4)


def test_small_displacements_press_in_proportion():
    """With a contact the stiffer the smaller the displacement is, points stick and slip by turns, and neither finds a way."""
    small = {"material": "icf_stable", "thickness": 4e-3, "radius": 8e-3}
    settings = {"specimen": small, "body": Annulus(), "recess": 1e-3, "penetration_tolerance": None}
    settings |= {"stop": "displacement", "steps": {}, "mesh": COARSE}
    stiffness = []
    for displacement in (1e-6, 1e-7):
        result = thin(**settings, contact=Coulomb(friction=0.4), displacement=displacement).run()
        assert result.status == "converged"
        stiffness.append(result.quantities["reaction_force"].value / displacement)
    assert stiffness[0] == pytest.approx(stiffness[1], rel=2e-2)  # the fillet touches 20 um further in 3 mm


def test_threshold_then_the_sensor_presses_too():
    beyond = thin(stop="displacement", displacement=0.08e-3, steps={"first": 0.05e-3}).run()
    values = {name: quantity.value for name, quantity in beyond.quantities.items()}
    last = beyond.steps[-1].values
    assert beyond.status == "converged"
    assert values["threshold_displacement"] < last["displacement"]
    assert values["threshold_pressure"] == pytest.approx(values["threshold_force"] / (np.pi * (3e-3**2 - 1.5e-3**2)))
    assert {name for step in beyond.steps for name in step.values} <= set(beyond.units)
    assert set(beyond.frames[-1].cells) == {"tetra10"}
    assert last["tissue_rise"] == pytest.approx(0.05e-3, rel=0.02), "the sensor holds the tissue back"
    assert last["sensor_force"] > 1e-4 * last["base_force"], "far more than the tolerance of the balance"
    assert last["reaction_force"] + last["sensor_force"] == pytest.approx(last["base_force"], rel=1e-8)


def test_stopped_before_the_threshold_and_interruption_keep_what_was_accepted():
    short = thin(displacement=0.03e-3).run()
    assert short.status == "failed"
    assert "not reached" in short.reason

    def stop_at_once(step):
        raise KeyboardInterrupt

    result = thin().run(stop_at_once)
    assert result.status == "interrupted"
    assert len(result.steps) == len(result.frames) == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"offset": 2e-3}, "offset 2 mm is too close to the side .* at most 1.36 mm"),
        ({"offset": -1e-3}, "at least 0"),
        ({"tilt_x": "40 deg"}, "at most 28.648"),
        ({"tilt_y": "1 mm"}, "wrong dimension"),
        ({"offset": 1e-3, "specimen": {"surface": "concave", "surface_radius": 20e-3}}, "needs a flat surface"),
        ({"tilt_y": 0.01, "specimen": {"base": "slipping"}}, "set base: fixed"),
        ({"mesh": {"sectors": 1}}, "at least 2"),
        ({"mesh": {"adaptive": True}}, "False"),
        ({"recess": None}, "needs the recess"),
        ({"body": Sphere(radius=2e-3)}, "only a body with a hole, such as an annulus, has one"),
        ({"displacement": 3e-3}, "smaller than the specimen's thickness"),
    ],
)
def test_impossible_experiments_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        thin(**changes)


def test_peaks_of_curved_facets_are_their_largest_heights():
    generator = np.random.default_rng(11)
    facets = generator.normal(size=(200, 6, 3))
    s, t = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 81), np.linspace(0, 1, 81)))
    s, t = s[s + t <= 1], t[s + t <= 1]
    r = 1 - s - t
    shapes = np.stack([r * (2 * r - 1), s * (2 * s - 1), t * (2 * t - 1), 4 * r * s, 4 * s * t, 4 * t * r])
    sampled = np.einsum("fid,in->fnd", facets, shapes)
    inner = 0
    for facet, points in zip(facets, sampled, strict=True):
        peak = surface_peaks(facet[None])[:, 2].max()
        assert points[:, 2].max() <= peak + 1e-12
        assert peak - points[:, 2].max() < 5e-3, "the grid misses a stationary point by at most half a step"
        inner += peak > facet[:, 2].max() + 5e-3
    assert inner > 20, "twin: the nodes alone are not enough"
