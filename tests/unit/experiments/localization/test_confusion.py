"""Stored grasps, made up, counted by their true and their estimated class."""

import numpy as np
import pytest
from made_grasps import PLAIN
from scenes import grasp_scene, unmarked_figures

from tactsim.errors import InputError
from tactsim.experiments.localization.confusion import Confusion
from tactsim.experiments.localization.source import folder_words
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.results import Quantity, Result, Status, StepRecord
from tactsim.results.writing import write_result

SPHERE = Sphere(center=(20e-3, 20e-3, 12e-3), radius=5e-3)
LUMP = PLAIN + np.outer([1.0, 0.5], np.eye(9)[4]).reshape(2, 3, 3)


def stored(folder, forces, inclusions, status=Status.CONVERGED, **fields):
    layout = TaxelLayout()
    quantities = {"displacement": Quantity(1e-3, "m", "")}
    for jaw, side in enumerate(JAWS):
        quantities[f"taxel_force_{side}"] = Quantity(forces[jaw].tolist(), "N", "")
    scene = grasp_scene([40e-3, 40e-3, 20e-3], layout, inclusions, **{"width": 40e-3, "depth": 40e-3} | fields)
    step = StepRecord(1, 3, 0.0, {"displacement": 1e-3})
    result = Result("grasp", status, "by the user", quantities, steps=(step,), units={"displacement": "m"}, scene=scene)
    return str(write_result(result, folder, case_id="0" * 16, provenance={}))


@pytest.fixture
def folders(tmp_path):
    return {
        "plain": stored(tmp_path / "plain", PLAIN, ()),
        "lump": stored(tmp_path / "lump", LUMP, (SPHERE,)),
        "hidden": stored(tmp_path / "hidden", PLAIN, (SPHERE,)),
        "both": stored(tmp_path / "both", LUMP, (SPHERE, Tube.example())),
    }


def run(folders, *names, **changes):
    given = {"noise": 1e-3, "draws": 3, "estimator": ThesisEstimator(background="reference")} | changes
    experiment = Confusion(grasps=tuple(folders[name] for name in names), **({"reference": folders["plain"]} | given))
    return experiment.run()


def test_jaws_unlike_those_of_the_reference_are_named(folders, tmp_path):
    folders["leaning"] = stored(tmp_path / "leaning", LUMP, (SPHERE,), tilt_x=0.05)
    notes = run(folders, "lump", "leaning").warnings
    assert sum("leaning: tilt_x of the upper jaw is 2.8648°, in the reference 0°" in note for note in notes) == 1
    assert not any("lump: " in note for note in notes)


def test_classes_are_counted(folders):
    result = run(folders, "plain", "lump", "hidden")
    counts = np.array(result.quantities["confusion"].value)
    assert counts[0, 0] == 3
    assert counts[1].tolist() == [3, 3, 0, 0, 0]
    assert counts.sum() == 9
    assert result.quantities["share_right"].value == pytest.approx(6 / 9)
    assert result.quantities["recalls"].value == [1.0, 0.5, None, None, None]
    assert unmarked_figures(result) == []
    assert "colour: share of the true class" in result.plot()["confusion"].axes[0].get_xlabel()  # 8 of 10 is paler than 5 of 5
    assert str(folders["lump"]) not in str(result.scene)


def test_grasps_that_did_not_come_to_their_end_are_told_of_once(folders, tmp_path):
    cut = stored(tmp_path / "cut", LUMP, (SPHERE,), Status.INTERRUPTED)
    (warning,) = run(folders | {"cut": cut}, "lump", "cut", "cut").warnings
    assert warning == f"the grasp in {folder_words(cut)} ended as interrupted (by the user)"
    assert run(folders, "lump").warnings == ()
    assert len(run(folders | {"cut": cut}, "lump", reference=cut).warnings) == 2, "it holds a lump, too"


def test_a_reference_that_holds_a_lump_is_warned_of(folders):
    reference = {"reference": folders["hidden"]}
    assert run(folders, "lump").warnings == ()
    assert any("the reference holds an inclusion" in line for line in run(folders, "lump", **reference).warnings)


def test_much_noise_hides_the_lump(folders):
    assert run(folders, "lump", noise=1.0).quantities["share_right"].value < 1


def test_a_lump_beside_an_artery_has_no_class(folders):
    with pytest.raises(InputError, match=r"both has sphere, tube; allowed"):
        run(folders, "both")
