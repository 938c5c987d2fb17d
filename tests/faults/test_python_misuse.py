"""What Python users hand in or do by mistake: numbers beyond all floats, names that are no names, pools forked too late."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

import tactsim as ts
from tactsim.errors import StorageError

FORKED = """
import multiprocessing
import tactsim as ts

def computed(displacement):
    specimen = ts.Specimen(material="icf_stable", thickness="4 mm", radius="8 mm")
    press = ts.Indentation(
        specimen=specimen, recess="0.8 mm", displacement=displacement, stop="displacement", mesh={"finest": "0.5 mm"}
    )
    return str(press.run().status)

if __name__ == "__main__":
    print(computed("20 um"))
    with multiprocessing.get_context("fork").Pool(1) as pool:
        try:
            pool.map(computed, ["20 um"])
        except ts.InputError as error:
            print(error)
"""


@pytest.mark.parametrize("limit", [-1, 0, math.nan, [1], True, "0 s"])
def test_a_time_limit_that_is_no_time_is_refused(limit: object) -> None:
    with pytest.raises(ts.InputError, match=r"time_limit is .*; needed: a positive number of seconds"):
        ts.ClosedForm.example().run(None, time_limit=limit)  # type: ignore[arg-type]


def test_progress_that_cannot_be_called_is_refused() -> None:
    with pytest.raises(ts.InputError, match="progress is 3; needed: a function of a step"):
        ts.ClosedForm.example().run(3)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", [3, None, ["icf_stable"], b"icf_stable"])
def test_names_that_are_no_text_are_refused(name: object) -> None:
    with pytest.raises(ts.InputError, match="unknown material set"):
        ts.material(name)  # type: ignore[arg-type]
    with pytest.raises(ts.InputError, match="read_uniaxial_curve: needed: a path or a text"):
        ts.read_uniaxial_curve(name)  # type: ignore[arg-type]
    if name is not None:
        with pytest.raises(ts.InputError, match="unknown extension point"):
            ts.kinds(name)  # type: ignore[arg-type]


@pytest.mark.parametrize("overrides", [5, b"experiment.points=3", ["experiment.points=3", 5], None])
def test_overrides_that_are_no_text_are_refused(overrides: object) -> None:
    with pytest.raises(ts.InputError, match=r"overrides: .*; needed: \{'experiment.recess'"):
        ts.load_case("annulus_icf", overrides)  # type: ignore[arg-type]


def test_an_override_cannot_forge_a_line() -> None:
    with pytest.raises(ts.InputError) as refused:
        ts.load_case("annulus_icf", "experiment.recess=3\nerror: forged")
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("number", [10**400, -(10**400)])
def test_a_whole_number_beyond_all_floats_is_refused(number: int) -> None:
    with pytest.raises(ts.InputError, match=r"radius: -?10+\.\.\.0+ is not finite; expected a quantity"):
        ts.Sphere(center=("20 mm", "20 mm", "12 mm"), radius=number)


def test_a_whole_number_of_more_digits_than_python_spells_is_refused() -> None:
    with pytest.raises(ts.InputError, match="radius: a whole number of 5000 digits is not finite; expected a quantity"):
        ts.Sphere(center=("20 mm", "20 mm", "12 mm"), radius=10**5000)
    for key in ("title", "experiment.displacement", "experiment.mesh.refinement", "experiment.contact.friction"):
        with pytest.raises(ts.InputError, match=f"override {key}: inf "):
            ts.load_case("annulus_icf", {key: 10**5000})


@pytest.mark.parametrize("name", ["x" * 5000, "x" * 300, "\N{MATHEMATICAL BOLD SMALL A}" * 64])
def test_a_name_longer_than_any_file_name_cannot_be_read(name: str) -> None:
    with pytest.raises(StorageError, match=r"^cannot read the case file .*File name too long"):
        ts.load_case(name)


def test_a_key_that_is_no_text_is_an_unknown_key() -> None:
    with pytest.raises(ts.InputError, match=r"override 1: unknown key; allowed: schema, title, experiment, output"):
        ts.load_case("annulus_icf", {1: 2})


def test_a_pool_that_is_forked_after_a_computation_is_told_and_does_not_wait_for_ever(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(FORKED, encoding="utf-8")
    root = str(Path(ts.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": root, "NUMBA_THREADING_LAYER": "omp"}
    done = subprocess.run(
        [sys.executable, str(script)], env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    if "No threading layer could be loaded" in done.stderr:
        pytest.skip("numba has no OpenMP here")
    assert done.stdout.splitlines() == [
        "converged",
        "this process was forked from one that has computed, and its threads did not come along; start processes with "
        "multiprocessing.get_context('spawn')",
    ]


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("annulus_convex", "experiment.specimen.surface_radius"),
        ("grasp_two_arteries", "experiment.inclusions.0.shape.centre_line.1.1"),
        ("published_bonded_disc", "experiment.geometry.radial.1.length"),
    ],
)
def test_a_length_whose_square_is_no_number_is_refused_in_words(name: str, place: str) -> None:
    with pytest.raises(ts.InputError, match=r"'1e300 m' is larger than anything in nature; allowed: up to 1e\+60 m$"):
        ts.load_case(name, {place: "1e300 m"})
