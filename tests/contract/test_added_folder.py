"""A folder of experiments is whole: one more is added and removed, and the package works without those that nothing builds on."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from textwrap import dedent
from typing import Any

import grimp
import pytest
from fork_server import forked_python
from sweeps import content, small_store

import tactsim.experiments
from tactsim import kinds_in_source, registry
from tactsim.cli.entry import main
from tactsim.dataset.sampling.json_schema import sweep_json_schema
from tactsim.errors import AmbiguousKind, CaseError
from tactsim.interfaces import Experiment, Recorder, ResultFigures
from tactsim.registry import kinds
from tactsim.results import read_result
from tactsim.results.scene import Scene

PACKAGE = Path(tactsim.__file__).parent
FAMILIES, SPRING = "tactsim.experiments", "tactsim.experiments.spring"
NAMED = '"spring"'
"""How a schema names the kind."""
POINTS = (Experiment, Scene, ResultFigures, Recorder)
FOLDER = {
    "__init__": '"""A spring."""',
    "spring": '''
        """A spring that is drawn out step by step."""
        from typing import Annotated, ClassVar, Literal, Self
        from pydantic import Field
        from tactsim.experiments.spring.scene import SpringScene
        from tactsim.interfaces import Experiment
        from tactsim.interfaces.run import Course, Findings
        from tactsim.results import Quantity, StepRecord
        from tactsim.units import Force, Length

        class Spring(Experiment):
            """A force that is proportional to the extension."""
            kind: Literal["spring"] = "spring"
            extension: Annotated[Length, Field(gt=0)]
            """Extension at the end."""
            force: Annotated[Force, Field(gt=0)] = 2.0
            """Force at that extension."""
            history_units: ClassVar[dict[str, str]] = {"extension": "m", "force": "N"}

            @classmethod
            def example(cls) -> Self:
                """A centimetre."""
                return cls(extension=1e-2)

            def begin(self) -> Course:
                """Four steps."""
                records = []

                def steps():
                    for k in range(1, 5):
                        values = {"extension": k / 4 * self.extension, "force": k / 4 * self.force}
                        records.append(StepRecord(k, 0, 0.0, values))
                        yield records[-1]

                def findings():
                    quantities = {"stiffness": Quantity(self.force / self.extension, "N/m", "of the spring")}
                    return Findings("drawn out", records, quantities, scene=SpringScene(colour="green"))

                return Course(steps(), findings)
    ''',
    "scene": '''
        """What its figure needs."""
        from typing import Literal
        from tactsim.results.scene import Scene

        class SpringScene(Scene):
            """The colour of the line."""
            kind: Literal["spring"] = "spring"
            colour: str
    ''',
    "figures": '''
        """Force over extension."""
        from typing import Literal
        from tactsim.experiments.spring.scene import SpringScene
        from tactsim.interfaces import ResultFigures
        from tactsim.plotting.canvas import Plot, new_figure

        class SpringFigures(ResultFigures):
            """One figure."""
            kind: Literal["spring"] = "spring"

            def drawings(self, result):
                """``spring.png``."""
                if not result.steps:
                    return {}
                figure = new_figure(3.0, 2.0)
                colour = result.scene_as(SpringScene).colour
                figure.subplots().plot(result.history_values("extension"), result.history_values("force"), color=colour)
                return {"spring.png": Plot(lambda: figure)}
    ''',
    "recorder": '''
        """Its extension and its stiffness."""
        from typing import ClassVar, Literal
        import numpy as np
        from tactsim.interfaces import Recorder
        from tactsim.interfaces.variable import label

        class SpringRecorder(Recorder):
            """One label and one reading."""
            kind: Literal["spring"] = "spring"
            quantities: ClassVar = {"stiffness": ("N/m", "stiffness of the spring")}

            def labels_of(self, experiment):
                """The extension."""
                return [label("extension", "m", "extension at the end")]

            def labels(self, experiment):
                """Its value."""
                return {"extension": np.array(experiment.extension)}

            def describe(self):
                """What is simulated."""
                return "A spring."
    ''',
}
SWEEP = """\
schema: tactsim/sweep/1
title: springs
experiment: {kind: spring, extension: {uniform: [1 mm, 2 mm]}}
sweep: {samples: 3, seed: 1}
"""
QUICK_CASE = """\
schema: tactsim/case/1
title: What is left still runs
experiment:
  kind: closed_form
  material: {kind: neo_hookean, c10: 3 kPa}
  loading: {control: displacement, pieces: [{kind: ramp, to: 0.1 mm, duration: 1 s}]}
  points: 5
"""
ANEW = """
import sys, warnings
del sys.argv[1]
for name in [name for name in sys.modules if name.partition(".")[0] == "tactsim"]:
    del sys.modules[name]
warnings.simplefilter("error")
"""
"""In a process with all libraries loaded: the package is loaded anew, from the working folder."""
WITHOUT = """
import importlib, json, pkgutil, sys
import tactsim
from tactsim.cli.entry import main
from tactsim.errors import AmbiguousKind, CaseError
from tactsim.interfaces import Experiment, Recorder, ResultFigures
from tactsim.registry import kinds
from tactsim.results.scene import Scene

for module in pkgutil.walk_packages(tactsim.__path__, "tactsim."):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
code = main(["run", sys.argv[1], "--out", sys.argv[2], "--quiet"])
registered = {base.__name__: sorted(kinds(base)) for base in (Experiment, Scene, ResultFigures, Recorder)}
print(json.dumps({"package": tactsim.__path__[0], "code": code, "kinds": registered}))
"""

SWEPT = """
schema: tactsim/sweep/1
title: What is left is swept
experiment:
  kind: closed_form
  material: {kind: neo_hookean, c10: 3 kPa}
  outer_radius: {uniform: [3 mm, 4 mm]}
  loading: {control: displacement, pieces: [{kind: ramp, to: 0.1 mm, duration: 1 s}]}
  points: 5
sweep: {samples: 2}
"""
ALONE = """
import json
from contextlib import redirect_stderr
import sweeps, tactsim, tactsim.outside.worker_pool
from tactsim.cli import command_sweep
from tactsim.cli.entry import main

command_sweep._executor = lambda sweep, arguments: sweeps.Inline(sweep)
runs = [["run", "case.yaml", "--out", out, "--quiet"] for out in ("first", "second")]
shown = [["compare", "first", "second"], ["list", "kinds"], ["schema", "--out", "case.schema.json"]]
data = [["sweep", "sweep.yaml", "--out", "annuli.zarr", "--quiet"], ["data", "info", "annuli.zarr"]]
drawn = [["show", place, "--save", place.partition(".")[0] + ".png"] for place in ("first", "annuli.zarr")]
tables = [["validate", "equation_4_7_1", "--out", "report"]]
codes = {" ".join(command): main(command) for command in (*runs, *shown, *data, *drawn, *tables)}
with open("refusal.txt", "w", encoding="utf-8") as refusal, redirect_stderr(refusal):
    refused = main(["validate", "section_3_1_2", "--out", "none"])
print(json.dumps({"package": tactsim.__path__[0], "codes": codes, "refused": refused}))
"""
"""What a user does with a result, with a data set and with a table, of any kind of experiment."""


def start_anew() -> None:
    """What a process that starts anew does not know: the spring, and which modules the folders of experiments hold."""
    for base in POINTS:
        for cls in [cls for cls in registry._registered.get(base, {}).values() if cls.__module__.startswith(SPRING)]:
            registry.forget(cls)
    for name in [name for name in sys.modules if name.startswith(SPRING)]:
        del sys.modules[name]
    vars(tactsim.experiments).pop("spring", None)
    kinds_in_source.module_names.cache_clear()
    kinds_in_source.kinds_in_source.cache_clear()
    kinds_in_source.load_all.cache_clear()
    registry._load_named.cache_clear()


@pytest.fixture
def spring(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder of the spring, a further one among those of experiments."""
    folder = tmp_path / "experiments" / "spring"
    folder.mkdir(parents=True)
    for name, text in FOLDER.items():
        (folder / f"{name}.py").write_text(dedent(text), encoding="utf-8")
    monkeypatch.setattr(tactsim.experiments, "__path__", [*tactsim.experiments.__path__, str(folder.parent)])
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    start_anew()
    yield folder
    monkeypatch.undo()
    start_anew()


def run_case(folder: Path) -> tuple[int, Path]:
    """Exit code and output folder of ``tactsim run`` of a case with a spring."""
    case, out = folder / "case.yaml", folder / "result"
    case.write_text("schema: tactsim/case/1\ntitle: a spring\nexperiment: {kind: spring, extension: 5 mm}\n", encoding="utf-8")
    return main(["run", str(case), "--out", str(out), "--force"]), out


def test_a_folder_is_all_that_a_kind_needs(spring: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out = run_case(tmp_path)
    assert code == 0, capsys.readouterr().err
    result = read_result(out).result
    assert result.quantities["stiffness"].value == pytest.approx(400.0, rel=1e-12)
    assert result.scene.colour == "green"  # type: ignore[union-attr]
    assert [step.values["force"] for step in result.steps] == [0.5, 1.0, 1.5, 2.0]
    assert (out / "figures" / "spring.png").read_bytes()[:4] == b"\x89PNG"
    stored = content(small_store(tmp_path, SWEEP))
    assert stored["stiffness"] == pytest.approx(2.0 / stored["extension"], rel=1e-12)


def test_a_folder_that_is_deleted_is_known_no_more(spring: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert all("spring" in kinds(base) for base in POINTS)
    assert NAMED in json.dumps(sweep_json_schema()["properties"]["experiment"])
    shutil.rmtree(spring)
    start_anew()
    assert not any("spring" in kinds(base) for base in POINTS)
    assert NAMED not in json.dumps(sweep_json_schema())  # made of the schema of cases
    code, out = run_case(tmp_path)
    assert code == CaseError.exit_code
    assert "'spring'" in capsys.readouterr().err
    assert not out.exists()


def test_a_kind_that_a_second_module_states_is_no_kind_of_either(
    spring: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also where only one of the two bears its name, which is all that has to be loaded for a run."""
    text = dedent(FOLDER["spring"]).replace("class Spring(", "class Coil(")
    (spring / "coils.py").write_text(text, encoding="utf-8")
    start_anew()
    code, out = run_case(tmp_path)
    assert code == AmbiguousKind.exit_code
    assert f"called 'spring': {SPRING}.coils.Coil and {SPRING}.spring.Spring" in capsys.readouterr().err
    assert not out.exists()


@cache
def built_on() -> dict[str, set[str]]:
    """Folder of experiments -> rooms of the package and other folders of experiments that import any of its modules."""
    graph = grimp.build_graph("tactsim", cache_dir=None)
    folders = sorted(name for name in graph.find_children(FAMILIES) if graph.find_children(name))

    def place(module: str) -> str:
        inside = module.startswith(f"{FAMILIES}.")
        return module.split(".")[2] if inside else module.partition(".")[2].partition(".")[0]

    return {
        place(folder): {
            place(user)
            for module in {folder, *graph.find_descendants(folder)}
            for user in graph.find_modules_that_directly_import(module)
        }
        - {place(folder), ""}  # the public surface names classes that are loaded when they are used
        for folder in folders
    }


def builders(unnamed: set[str]) -> set[str]:
    """Which of the folders that the tiers do not name import another folder."""
    return {user for users in built_on().values() for user in users & unnamed}


def test_a_folder_that_the_tiers_do_not_name_builds_on_no_other() -> None:
    contracts = tomllib.loads((PACKAGE.parent / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    tiers = next(contract["layers"] for contract in contracts if contract.get("containers") == [FAMILIES])
    named = {name.strip() for tier in tiers for name in tier.split("|")}
    assert builders(set(built_on()) - named) == set()
    assert builders(set(built_on()) - (named - {"durometer"})) == {"durometer"}


def answer_of(folder: Path, script: str, *arguments: str) -> dict[str, Any]:
    """What a script prints last, run with the package in a folder."""
    command = [*forked_python(), ANEW + script, *arguments]
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=folder, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_the_package_works_without_the_folders_that_nothing_builds_on(tmp_path: Path) -> None:
    removed = {folder for folder, users in built_on().items() if not users}
    assert {"film", "dma", "switch_probe"} <= removed
    copy = tmp_path / "tactsim"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("page"))
    for name in removed:
        shutil.rmtree(copy / "experiments" / name)
    case = tmp_path / "case.yaml"
    case.write_text(QUICK_CASE, encoding="utf-8")
    answer = answer_of(tmp_path, WITHOUT, str(case), str(tmp_path / "result"))
    assert (answer["package"], answer["code"]) == (str(copy), 0)
    for base in POINTS:
        left = {kind for kind, cls in kinds(base).items() if cls.__module__.split(".")[2] not in removed}
        assert set(answer["kinds"][base.__name__]) == left, base.__name__
    assert read_result(tmp_path / "result").result.kind == "closed_form"


def test_a_family_that_builds_on_none_is_all_that_its_cases_and_data_sets_need(tmp_path: Path) -> None:
    copy = tmp_path / "tactsim"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("page"))
    for name in built_on():
        if name != "annulus":
            shutil.rmtree(copy / "experiments" / name)
    for name, text in (("case", QUICK_CASE), ("sweep", SWEPT)):
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    shutil.copytree(PACKAGE.parent / "cases", tmp_path / "cases")
    answer = answer_of(tmp_path, ALONE)
    assert answer["package"] == str(copy)
    assert answer["refused"] == 2
    refusal = (
        r"section_3_1_2\.yaml:\d+: rows\.\d+\.evaluate: quantity \w+ of [\w.]+\.threshold needs tactsim\.experiments\.threshold"
    )
    assert re.search(refusal, (tmp_path / "refusal.txt").read_text(encoding="utf-8"))
    assert {command: code for command, code in answer["codes"].items() if code} == {}
    (counts, *_) = json.loads((tmp_path / "report" / "validation.json").read_text(encoding="utf-8"))["groups"]["thesis"]["counts"]
    assert (counts["table"], counts["rows"], counts["left"]) == ("equation_4_7_1", "7 of 7", 0)
    for name in ("first", "annuli"):
        assert (tmp_path / f"{name}.png").read_bytes()[:4] == b"\x89PNG"
