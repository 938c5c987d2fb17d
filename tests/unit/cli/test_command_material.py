"""``tactsim material``."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from tactsim.case import load_case
from tactsim.cli import main
from tactsim.identification.uniaxial import fit_uniaxial, uniaxial_nominal_stress
from tactsim.identification.uniaxial_data import read_uniaxial_curve
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.materials.any_material import AnyMaterial
from tactsim.materials.library import LIBRARY, named_material
from tactsim.model import FrozenModel
from tactsim.registry import register

NAME = "icf_stable"


class Sample(FrozenModel):
    """A piece of material."""

    material: AnyMaterial
    """What it is made of."""


class Stack(Experiment):
    """Holds materials at several depths."""

    kind: Literal["stack"] = "stack"
    samples: tuple[Sample, ...]
    """From the bottom up."""
    skin: AnyMaterial | None = None
    """What covers them."""

    def begin(self) -> Course:
        """Nothing."""
        return Course.computed(Findings(""))

    @classmethod
    def example(cls) -> Stack:
        """One sample."""
        return cls(samples=(Sample(material=named_material(NAME).material),))


@pytest.fixture
def stack_file(tmp_path: Path) -> Path:
    register(Stack)
    path = tmp_path / "stack.yaml"
    lines = ["schema: tactsim/case/1", "experiment:", "  kind: stack", "  samples:", f"    - material: {NAME}"]
    lines += ["    - material: {kind: neo_hookean, c10: 3 kPa}", "  skin: b1a_stable"]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.fixture
def curve(tmp_path: Path) -> Path:
    """A neo-Hookean curve of c10 = 3 kPa."""
    stretch = np.linspace(0.6, 0.95, 36)
    rows = [f"{x},{2 * 3 * (x - x**-2)}" for x in stretch]
    path = tmp_path / "rubber.csv"
    path.write_text("\n".join(["stretch,nominal_stress_kPa", *rows]), encoding="utf-8")
    return path


def test_shipped_materials_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["material"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == sorted(LIBRARY)


def test_a_shipped_material_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["material", NAME, "--save", str(tmp_path / "curves.png")]) == 0
    out = capsys.readouterr().out
    assert out.startswith(NAME)
    assert "c10" in out
    assert (tmp_path / "curves.png").read_bytes().startswith(b"\x89PNG")


def test_every_material_of_a_case_is_reported(stack_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["material", str(stack_file), "--save", str(tmp_path / "c.png")]) == 0
    out = capsys.readouterr().out
    for name in ("samples.0.material", "samples.1.material (neo_hookean)", "skin"):
        assert name in out
    assert {"c-samples-0-material.png", "c-skin.png"} <= {path.name for path in tmp_path.iterdir()}


def test_a_shipped_case_goes_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["material", "annulus_icf"]) == 0
    assert "specimen.material (mooney_rivlin_3)" in capsys.readouterr().out
    assert main(["material", "annulus_icv"]) == 2


def test_a_curve_is_fitted_and_gives_lines_for_a_case(
    curve: Path, stack_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["material", "--fit", str(curve), "--form", "2-parameter", "--save", str(tmp_path / "fit.png")]) == 0
    first, second, *_ = capsys.readouterr().out.splitlines()
    assert first.startswith("2-parameter: largest relative error 0.0 %")
    assert (tmp_path / "fit.png").read_bytes().startswith(b"\x89PNG")
    case = load_case(stack_file, [f"experiment.skin={second.strip()}"])
    assert isinstance(case.experiment, Stack)
    assert case.experiment.skin is not None
    assert case.experiment.skin.shear_modulus == pytest.approx(6e3, rel=1e-3)  # five printed digits


def test_a_relaxation_gives_the_line_of_a_material(stack_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    held = tmp_path / "held.csv"
    rows = "\n".join(f"{t},{2 + 2 * 0.5 ** (t / 0.1)}" for t in (0.2 + 0.02 * k for k in range(100)))
    held.write_text(f"time [s], stress [kPa]\n{rows}\n", encoding="utf-8")
    assert main(["material", "--relaxation", str(held), "--rise", "0.2 s"]) == 0
    first, second, third = capsys.readouterr().out.splitlines()
    assert (
        "95 % intervals: fractions 0.316 to 0.316" in third
    )  # the response at once, of a rise of 0.2 s, is 3.2 kPa of relaxing part
    assert first.startswith("1 relaxation times: largest relative error 0.0 %")
    case = load_case(stack_file, [f"experiment.skin={{kind: neo_hookean, c10: 3 kPa, {second.strip()}}}"])
    assert case.experiment.skin.relaxation.times == pytest.approx([0.1 / 0.693147], rel=1e-4)  # halves in 0.1 s


def test_every_form_is_tried(curve: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["material", "--fit", str(curve)]) == 0
    out = capsys.readouterr().out
    for form in ("2-parameter", "3-parameter", "5-parameter", "stable"):
        assert f"{form}: " in out


@pytest.mark.parametrize(("largest", "open_in_tension"), [(0.98, True), (1.6, False)])
def test_a_curve_in_compression_alone_leaves_tension_open(
    largest: float, open_in_tension: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stretch = np.linspace(0.6, largest, 40)
    stress = uniaxial_nominal_stress(named_material("icf_printed").material, stretch)
    curve = tmp_path / "icf.csv"
    points = zip(stretch.tolist(), stress.tolist(), strict=True)
    curve.write_text("\n".join(["stretch,nominal_stress_Pa", *(f"{x!r},{p!r}" for x, p in points)]))
    assert main(["material", "--fit", str(curve)]) == 0
    out, err = capsys.readouterr()
    fits = [fit_uniaxial(read_uniaxial_curve(curve), form).material for form in ("stable-c20", "stable")]  # stiffest and softest
    most, least = (uniaxial_nominal_stress(material, np.array([1.5])).item() for material in fits)
    assert (f"at a stretch of 1.5 the stable fits differ by a factor of {most / least:.2g}" in err) == open_in_tension
    assert ("compression alone" in err) == open_in_tension
    assert "stable-c20: largest relative error" in out


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["icf_stabel"], 2, "did you mean 'icf_stable'"),
        (["missing.yaml"], 5, "cannot read the case file"),
        (["--save", "x.png"], 2, "--save needs a material"),
        (["icf_stable", "--save", "x.pdf"], 2, "must end in .png"),
        (["--strains", "0", "1"], 2, "--strains goes with --fit"),
        (["--absolute"], 2, "--absolute goes with --fit"),
        (["--form", "stable"], 2, "--form goes with --fit"),
        (["--fit", "missing.csv"], 5, "missing.csv"),
        (["icf_stable", "--fit", "x.csv"], 2, "not allowed with"),
        (["--relaxation", "missing.csv"], 5, "missing.csv"),
        (["icf_stable", "--rise", "1 s"], 2, "--rise goes with --relaxation"),
        (["--relaxation", "x.csv", "--rise", "1 mm"], 2, "'1 mm'"),
        (["--relaxation", "x.csv", "--save", "x.png"], 2, "--form, --strains, --absolute and --save go with --fit"),
    ],
)
def test_what_cannot_be_answered(
    arguments: list[str],
    code: int,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["material", *arguments]) == code
    assert words in capsys.readouterr().err


def test_a_case_without_material_is_reported(case_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["material", str(case_file)]) == 2
    assert "the case has no material" in capsys.readouterr().err
