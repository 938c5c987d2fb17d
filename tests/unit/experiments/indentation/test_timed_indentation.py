"""What a timed indentation accepts, and how it follows force, displacement, relaxation, the touch and unloading."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scenes import unmarked_figures

from tactsim.contact.annulus import Annulus
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.punch import Punch
from tactsim.contact.sphere import Sphere
from tactsim.errors import CaseError
from tactsim.experiments.indentation.graded_section import MeshSettings
from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.contact import contact_equilibrium
from tactsim.mechanics.models.specimen import Layer, Specimen
from tactsim.mechanics.paths import history_path
from tactsim.mechanics.paths.loading import DisplacementLoading, ForceLoading
from tactsim.mechanics.paths.step_policy import TimeSettings
from tactsim.plotting import figures_for
from tactsim.relaxation import Relaxation
from tactsim.results.result import Status

pytestmark = pytest.mark.usefixtures("one_thread")
FADING = Relaxation(fractions=(0.4, 0.2), times=(0.1, 2.0))
TISSUE = NeoHookean(c10=1000.0, relaxation=FADING)
ELASTIC = NeoHookean(c10=1000.0)
COARSE = MeshSettings(finest=0.6e-3, growth=2.0)
JUMP = {"kind": "jump", "to": 0.1e-3, "duration": 10.0}


def displaced(*pieces):
    return DisplacementLoading.model_validate({"control": "displacement", "pieces": list(pieces)})


def forced(*pieces):
    return ForceLoading.model_validate({"control": "force", "pieces": list(pieces)})


def thin(**changes):
    material = changes.pop("material", TISSUE)
    given = {
        "specimen": Specimen(material=material, thickness=3e-3, radius=7e-3),
        "body": Annulus(fillet=0.4e-3),
        "contact": Coulomb(friction=0.0),
        "loading": displaced(JUMP),
        "mesh": COARSE,
        "time": TimeSettings(tolerance=5e-3, per_decade=1),
    }
    return TimedIndentation(**(given | changes))


def history(result, name):
    assert result.status == "converged", result.reason
    return np.array([step.values[name] for step in result.steps])


def fading(times):
    equilibrium, parts, tau = FADING.amplitudes
    return equilibrium + np.exp(-np.asarray(times)[:, None] / tau) @ parts


@pytest.fixture(scope="module")
def held():
    return thin(contact=Coulomb(friction=0.4)).run()


def test_a_held_displacement_relaxes_by_the_series(held):
    force, times = history(held, "reaction_force"), history(held, "time")
    np.testing.assert_allclose(force / force[0], fading(times), rtol=2e-3, err_msg="the penetration follows the pressure")
    assert history(held, "base_force") == pytest.approx(force, rel=1e-7)
    assert times[-1] == 10.0


@pytest.mark.slow
def test_a_ball_on_a_ramp_passes_its_first_touch_and_fades_as_its_growing_contact_should():
    """Reference: the hereditary integral over the elastic force, exact while contact grows (Ting 1966, doi:10.1115/1.3625192).

    Mutant: the elastic force. Quick: ``test_withdrawal.py``.
    """
    ball = {"body": Sphere(radius=5e-3), "mesh": MeshSettings(finest=0.15e-3, growth=1.5)}
    ball["loading"] = displaced({"kind": "ramp", "to": 0.1e-3, "duration": 1.0})
    faded, elastic = thin(**ball).run(), thin(**ball, material=ELASTIC).run()
    times = np.linspace(0.0, 1.0, 2001)
    force = np.interp(times, [0.0, *history(elastic, "time")], [0.0, *history(elastic, "reaction_force")])
    middles = (times[1:] + times[:-1]) / 2

    def check(last):
        assert history(faded, "reaction_force")[-1] == pytest.approx(last, rel=3e-3)

    check(float(fading(1.0 - middles) @ np.diff(force)))
    assert_kills(check, elastic=(force[-1],))


def test_a_sudden_change_goes_in_parts_where_its_whole_leaves_an_element_without_volume(held, monkeypatch):
    """What Newton finds far away may be another equilibrium, of an element that no shorter step brings back."""
    told = iter(["element 7 has kept 12% of its volume"])
    monkeypatch.setattr(history_path, "collapsed_in_words", lambda body, kinematics, unknowns: next(told, None))
    result = thin(contact=Coulomb(friction=0.4)).run()
    assert result.scene.solver.rejected_steps == held.scene.solver.rejected_steps + 1
    forces = [history(one, "reaction_force")[0] for one in (result, held)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-3), "with friction the parts of the way count a little"


def test_a_held_force_creeps():
    result = thin(loading=forced({"kind": "jump", "to": 0.01, "duration": 100.0})).run()
    force, depth = history(result, "reaction_force"), history(result, "displacement")
    np.testing.assert_allclose(force, 0.01, rtol=1e-8)
    assert (np.diff(depth) > -5e-3 * depth.max()).all(), "up to the tolerance in time"
    elastic = thin(material=ELASTIC, loading=forced({"kind": "jump", "to": 0.01, "duration": 1.0})).run()
    slow = NeoHookean(c10=1000.0 * FADING.amplitudes[0])
    relaxed = thin(material=slow, loading=forced({"kind": "jump", "to": 0.01, "duration": 1.0})).run()
    assert depth[0] == pytest.approx(history(elastic, "displacement")[-1], rel=1e-3)
    assert depth[-1] == pytest.approx(history(relaxed, "displacement")[-1], rel=2e-3)


def test_a_cycle_dissipates_and_the_contact_opens_before_the_body_is_back():
    ramps = ({"kind": "ramp", "to": 0.1e-3, "duration": 0.2}, {"kind": "ramp", "to": 0.0, "duration": 0.2})
    result = thin(loading=displaced(*ramps, {"kind": "hold", "duration": 0.1})).run()
    force, depth = history(result, "reaction_force"), history(result, "displacement")
    work = np.trapezoid(force, depth)
    assert work > 0.05 * force.max() * depth.max()
    assert force[-1] == pytest.approx(0.0, abs=1e-9)
    opened = depth[np.argmax((force <= 0) & (history(result, "time") > 0.2))]
    assert 0.0 < opened < 0.1e-3
    elastic = thin(material=ELASTIC, loading=displaced(*ramps)).run()
    loop = np.trapezoid(history(elastic, "reaction_force"), history(elastic, "displacement"))
    assert abs(loop) < 0.02 * force.max() * depth.max(), "the trapezoidal rule on twenty steps each way"


def test_the_touch_is_located_in_time():
    loading = displaced({"kind": "ramp", "to": 0.6e-3, "duration": 1.0})
    result = thin(loading=loading, recess=0.1e-3, stop="touch").run()
    assert history(result, "tissue_rise")[-1] == pytest.approx(0.1e-3, rel=1e-4)
    assert 0 < result.quantities["time_of_touch"].value < 1.0
    short = thin(material=ELASTIC, loading=displaced(JUMP), recess=2e-3, stop="touch").run()
    assert (short.status, short.reason) == ("failed", "the tissue did not touch the inner sensor within the history")
    beyond = thin(material=ELASTIC, loading=displaced(JUMP | {"to": 0.3e-3}), recess=0.05e-3).run()
    assert any("rose beyond the recess" in warning for warning in beyond.warnings)


def test_one_relaxing_layer_is_enough(held):
    specimen = Specimen(material=ELASTIC, thickness=3e-3, radius=7e-3, layers=(Layer(thickness=1e-3, material=TISSUE),))
    force = history(thin(specimen=specimen, contact=Coulomb(friction=0.4)).run(), "reaction_force")
    whole = history(held, "reaction_force")
    assert whole[-1] / whole[0] < force[-1] / force[0] < 1


def test_elastic_tissue_has_no_memory_and_a_figure():
    result = thin(material=ELASTIC, compare="layer").run()
    assert np.ptp(history(result, "reaction_force")) < 1e-6 * history(result, "reaction_force")[0]
    assert abs(result.quantities["closed_form_difference"].value) < 0.5, "a fillet of an eighth of the radius costs force"
    assert all(draw().startswith(b"\x89PNG") for draw in figures_for(result).values())
    assert unmarked_figures(result) == []
    assert any("closed form is meant for" in warning for warning in result.warnings)


def test_an_interruption_keeps_the_steps():
    def stop(step):
        if step.step == 2:
            raise KeyboardInterrupt

    result = thin().run(stop)
    assert (result.status, len(result.steps)) == ("interrupted", 2)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"loading": forced(JUMP | {"to": 0.1}, {"kind": "sine", "amplitude": 0.1, "frequency": 1.0, "duration": 1.0})},
            "preload",
        ),
        ({"loading": forced({"kind": "ramp", "to": -1.0, "duration": 1.0})}, "must press all the time"),
        ({"loading": displaced(JUMP | {"to": 4e-3})}, "smaller than the specimen's thickness"),
        ({"compare": "layer", "body": Sphere(radius=2e-3)}, "not for a sphere"),
        ({"compare": "layer", "material": NeoHookean(c10=1e3, bulk_modulus=1e6)}, "incompressible"),
        ({"loading": displaced({"kind": "hold", "duration": 1.0})}, "never becomes positive"),
        ({"loading": displaced(JUMP | {"to": -1e-4})}, "never becomes positive"),
        ({"stop": "touch"}, "needs the recess"),
        ({"body": Sphere(radius=2e-3), "recess": 1e-4}, "only a body with a hole, such as an annulus, has one"),
    ],
)
def test_impossible_experiments_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        thin(**changes)


def test_a_tissue_a_thousand_times_softer_in_the_end_is_the_same_by_either_constants():
    """Constants at once of 2 MPa, or in the end of 2 kPa: the round-off of its stress is that of the stiff one."""

    def force(c10: float, constants: str) -> float:
        memory = {"fractions": (0.5, 0.499), "times": ("0.1 s", "1 s"), "constants": constants}
        tissue = {"kind": "neo_hookean", "c10": c10, "relaxation": memory}
        pieces = [{"kind": "ramp", "to": "0.1 mm", "duration": "1 s"}, {"kind": "hold", "duration": "9 s"}]
        result = TimedIndentation(
            specimen={"material": tissue, "thickness": "4 mm", "radius": "6 mm"},
            body={"kind": "punch"},
            mesh={"finest": "0.7 mm", "growth": 1},
            time={"tolerance": 1e-2, "per_decade": 0, "first": "0.1 s"},
            loading={"control": "displacement", "pieces": pieces},
        ).run(None)
        assert result.status == "converged"
        return float(result.quantities["reaction_force"].value)

    assert force(2e3, "equilibrium") == pytest.approx(force(2e6, "instantaneous"), rel=1e-9)


STIFF_AT_ONCE = {"material": "atrial", "time": TimeSettings(tolerance=2e-2, per_decade=1)}
"""A thousandth of a percent of its stiffness lasts, and it relaxes within microseconds."""


def test_a_ramp_of_force_starts_with_a_step_that_its_round_off_does_not_hide():
    """After 9 ns, a thousandth of the shortest relaxation time, the force is half of the round-off of the contact."""
    result = thin(loading=forced({"kind": "ramp", "to": 1e-3, "duration": 0.1}), **STIFF_AT_ONCE).run()
    assert result.status is Status.CONVERGED
    assert float(result["reaction_force"].value) == pytest.approx(1e-3, rel=1e-6)


HELD_FORCE = forced({"kind": "jump", "to": 30e-3, "duration": 0.3})


def test_under_a_force_the_contact_of_tissue_that_relaxes_becomes_softer_where_steps_fail():
    """It comes to the displacement of the contact that stays as stiff as the jump asked, and penetrates more."""
    result = thin(loading=HELD_FORCE, mesh=MeshSettings(finest=0.3e-3, growth=1.5), **STIFF_AT_ONCE).run()
    assert result.status is Status.CONVERGED
    stiff = 346.793e-6  # of the contact that stays stiff, on this mesh
    assert float(result["displacement"].value) == pytest.approx(stiff, rel=1e-3)
    assert 5e-9 < float(result["max_penetration"].value) < thin().tolerance, "a contact that stays stiff leaves 1.6 nm"


def with_friction():
    return thin(loading=HELD_FORCE, contact=Coulomb(friction=0.4), **STIFF_AT_ONCE)


def test_a_contact_with_friction_softens_with_the_tissue_and_comes_to_its_end():
    assert with_friction().run().status is Status.CONVERGED


@pytest.mark.slow
def test_with_friction_a_contact_that_stays_as_stiff_would_not_come_to_its_end(monkeypatch):
    monkeypatch.setattr(contact_equilibrium, "_softened", lambda *_: None)
    assert with_friction().run().status is Status.FAILED


@pytest.mark.parametrize("fillet", [0.7e-3, 1.6e-3])
def test_a_force_begins_on_a_slope_with_friction(fillet):
    """What the body covers before it touches is no slip: as one it outweighed the first force, and the point opened and closed
    in turns however short the step."""
    skin = Layer(thickness=1e-3, material=NeoHookean(c10=30e3))
    slope = Specimen(material=ELASTIC, thickness=8e-3, radius=7e-3, layers=(skin,), surface="concave", surface_radius=25e-3)
    pressed = thin(
        specimen=slope,
        body=Punch(radius=3e-3, fillet=fillet),
        contact=Coulomb(friction=1.0),
        loading=forced({"kind": "ramp", "to": 20e-3, "duration": 1.0}),
        mesh=MeshSettings(finest=0.45e-3, growth=1.5),
    )
    assert history(pressed.run(), "reaction_force")[-1] == pytest.approx(20e-3, rel=1e-6)
