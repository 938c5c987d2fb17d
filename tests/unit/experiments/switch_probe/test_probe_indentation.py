"""The probe in plane strain: forces on strips of its sides, balance of forces, and the plane measure of an indentation."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact.coulomb import Coulomb
from tactsim.contact.trapezoid import Trapezoid
from tactsim.experiments.indentation.course import HistoryPath
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.indentation.record import IndentationRecord
from tactsim.experiments.switch_probe.probe_indentation import ProbeIndentation, probe_states, side_forces
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.models.specimen import Specimen
from tactsim.mechanics.paths.loading import DisplacementLoading
from tactsim.mechanics.paths.step_policy import TimeSettings
from tactsim.sensors.switch_array import SwitchArray

pytestmark = pytest.mark.usefixtures("one_thread")


def indentation(depth=1e-3, **changes):
    given = {
        "specimen": Specimen(material=NeoHookean(c10=5e3), thickness=20e-3, radius=20e-3),
        "body": Trapezoid(),
        "contact": Coulomb(friction=0.4),
        "loading": DisplacementLoading.model_validate(
            {"control": "displacement", "pieces": [{"kind": "ramp", "to": depth, "duration": 1.0}]}
        ),
        "penetration_tolerance": 1e-6,
        "mesh": MeshSettings(finest=0.4e-3, growth=0.8),
        "time": TimeSettings(tolerance=0.05, per_decade=0, first=0.05),
    }
    return ProbeIndentation(**(given | changes))


def test_a_strip_carries_the_pressure_on_it():
    """A wall at 45 degrees, so that a mm of height is one of undeformed length, under a pressure that grows with it."""
    along = np.linspace(0, 6e-3, 61)
    array = SwitchArray(strip=0.5e-3)
    highest, carried = side_forces(along, along, 1e6 * along, array)
    np.testing.assert_allclose(carried, 1e6 * array.heights * 0.5e-3, rtol=2e-3)  # ends of strips between the samples
    assert highest == pytest.approx(6e-3)
    untouched, none = side_forces(along, along, np.zeros(61), array)
    assert untouched == 0.0
    assert not none.any()
    half, some = side_forces(along, along, np.where(along < 2.6e-3, 1e3, 0.0), array)
    assert half == pytest.approx(2.6e-3, abs=0.1e-3)
    assert (some > 0).tolist() == [True, True, False, False, False]


def test_forces_balance_in_plane_strain_and_scale_with_the_width():
    setup = indentation(depth=0.3e-3)
    model = setup.model()
    assert model.space.measure == "plane_strain"
    assert model.surface.points.weights.sum() == pytest.approx(20e-3, rel=1e-12), "the half width, per m"
    path = HistoryPath(setup, setup.drive(), model)
    *_, (last, _) = path.states()
    values = IndentationRecord(setup, model, path).values(last)
    assert values["base_force"] == pytest.approx(values["reaction_force"], rel=1e-7)
    *_, state = probe_states(setup, SwitchArray(), width=10e-3)
    assert state.force == pytest.approx(2 * 10e-3 * values["reaction_force"], rel=1e-9)
    assert state.depth == pytest.approx(0.3e-3)
    assert state.contact_height == 0.0, "the sides begin above the fillet"


def test_a_small_fillet_is_resolved_on_the_surface_without_small_elements_in_all_the_tissue_beneath():
    """That tissue bends over the face, not over the fillet; as small elements there were 145 000 nodes."""
    usual, small = (indentation(body=Trapezoid(fillet=r), mesh=MeshSettings()).section().mesh() for r in (0.5e-3, 0.05e-3))
    assert len(small.nodes) < 4 * len(usual.nodes)
    top = small.nodes[np.abs(small.nodes[:, 1]) < 1e-9, 0]
    beside = np.sort(top[np.abs(top - 1e-3) < 0.5e-3])
    assert np.diff(beside).max() < 1.1 * 0.05e-3 / 6, "two nodes to an element of a third of the fillet"


def test_a_sharp_corner_goes_deep_on_default_elements():
    """Strain at it is singular: elements of a fiftieth of half the face collapsed there at 0.8 mm, whatever the steps."""
    setup = indentation(depth=1.2e-3, body=Trapezoid(fillet=0.0), mesh=MeshSettings())
    *_, state = probe_states(setup, SwitchArray(), width=10e-3)
    assert state.depth == pytest.approx(1.2e-3)


def test_refining_keeps_the_plane_measure():
    setup = indentation()
    model = setup.model()
    contact = HistoryPath(setup, setup.drive(), model).start
    finer, _, _ = model.refined(contact, np.array([0, 1]))
    assert finer.space.measure == "plane_strain"
    assert len(finer.space.elements) > len(model.space.elements)
