"""What a result rests on."""

from __future__ import annotations

from tactsim import __version__
from tactsim.code_identity import code_identity
from tactsim.experiments.durometer.durometer import Durometer
from tactsim.experiments.grasp.matrix_readout import MatrixReadoutRun
from tactsim.experiments.threshold.catheter_tip import CatheterTip
from tactsim.results.provenance import provenance


def test_versions_code_case_and_seeds_are_reported() -> None:
    given = {"case_file": "/elsewhere/of/someone/case.yaml", "overrides": ["a=/elsewhere/y.stl"], "seeds": {"readout.seed": 3}}
    content = provenance({"title": "x"}, "abc", **given)
    assert content["versions"]["tactsim"] == __version__
    assert {"python", "numpy", "scipy", "scikit-fem"} <= set(content["versions"])
    assert (content["case_id"], content["seeds"], content["case"]) == ("abc", {"readout.seed": 3}, {"title": "x"})
    assert content["code"] == code_identity()
    assert content["code"].startswith(f"{__version__}+")
    assert (content["case_file"], content["overrides"]) == ("case.yaml", ["a=y.stl"])


def test_no_folder_user_or_host_is_reported() -> None:
    case = {"mesh": "/home/someone/part.stl", "other": [r"C:\Users\someone\part.stl"], "relative": "meshes/part.stl"}
    content = provenance(case, "abc")
    assert content["case"] == {"mesh": "part.stl", "other": ["part.stl"], "relative": "meshes/part.stl"}
    assert set(content) == {"case_id", "case_file", "overrides", "seeds", "code", "versions", "platform", "case"}
    assert set(content["platform"]) == {"system", "machine"}


def test_an_experiment_knows_its_seeds_wherever_they_stand() -> None:
    assert Durometer.example().seeds() == {}
    assert CatheterTip.example().seeds() == {"seed": 1}
    assert CatheterTip.example().model_copy(update={"seed": 7}).seeds() == {"seed": 7}
    assert MatrixReadoutRun.example().seeds()["readout.seed"] == 1
