"""What a result rests on."""

from __future__ import annotations

from tactsim import __version__
from tactsim.results.provenance import provenance


def test_versions_case_and_seed_are_told() -> None:
    content = provenance({"title": "x"}, "abc", case_file="/home/someone/case.yaml", overrides=["a=/tmp/y.stl"], seed=3)
    assert content["versions"]["tactsim"] == __version__
    assert {"python", "numpy", "scipy", "scikit-fem"} <= set(content["versions"])
    assert (content["case_id"], content["seed"], content["case"]) == ("abc", 3, {"title": "x"})
    assert (content["case_file"], content["overrides"]) == ("case.yaml", ["a=y.stl"])


def test_no_folder_user_or_host_is_told() -> None:
    case = {"mesh": "/home/someone/part.stl", "other": [r"C:\Users\someone\part.stl"], "relative": "meshes/part.stl"}
    content = provenance(case, "abc")
    assert content["case"] == {"mesh": "part.stl", "other": ["part.stl"], "relative": "meshes/part.stl"}
    assert set(content) == {"case_id", "case_file", "overrides", "seed", "versions", "platform", "case"}
    assert set(content["platform"]) == {"system", "machine"}
