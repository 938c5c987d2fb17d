"""Kinds are listed by the text of their modules, in which stand exactly those that loading them registers."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Literal

import pytest

from tactsim import interfaces, registry
from tactsim.errors import IncompleteKind
from tactsim.kinds_in_source import kinds_in_source
from tactsim.registry import kind_names, kinds

POINTS = [
    interfaces.Material,
    interfaces.RigidBody,
    interfaces.ContactLaw,
    interfaces.Inclusion,
    interfaces.SensorFilm,
    interfaces.Experiment,
    interfaces.Estimator,
]

MODULES = {
    "plain": 'class Base:\n    pass\n\nclass Ball(Base):\n    """A kind."""\n\n    kind: Literal["ball"] = "ball"\n',
    "further": 'class Hard(Ball):\n    kind: Literal["hard"] = "hard"\n',
    "other": 'class Other(Model):\n    kind: Literal["other"] = "other"\n',
    "abstract": 'class Round(Base):\n    size: float\n\n\nkind: Literal["none"] = "none"\n',
}


@pytest.mark.parametrize("point", POINTS, ids=lambda point: point.__name__)
def test_the_source_names_what_is_registered(point):
    assert kind_names(point) == list(kinds(point))


def test_only_classes_that_extend_the_base_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for name, text in MODULES.items():
        (tmp_path / f"source_of_{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    names = tuple(f"source_of_{name}" for name in MODULES)
    assert kinds_in_source(names, "Base") == {"ball": names[:1], "hard": names[1:2]}
    assert kinds_in_source(names, "Model") == {"other": names[2:3]}
    assert kinds_in_source(names[:1], "Base") == {"ball": names[:1]}
    assert not {f"source_of_{name}" for name in MODULES} & set(sys.modules)


def test_a_class_in_the_package_that_lacks_methods_is_named_with_them(monkeypatch: pytest.MonkeyPatch):
    class HalfMade(interfaces.ContactLaw):
        kind: Literal["half_made"] = "half_made"

    monkeypatch.setattr(registry, "kinds_in_source", lambda *_: {"half_made": ()})
    with pytest.raises(
        IncompleteKind, match=r"'half_made': its class .*HalfMade lacks example, traction_limit, traction_limit_slope"
    ):
        registry.kind_class(interfaces.ContactLaw, "half_made")


def test_a_misspelt_kind_loads_no_other(tmp_path: Path):
    case = tmp_path / "case.yaml"
    case.write_text("schema: tactsim/case/1\ntitle: misspelt\nexperiment:\n  kind: film_tset\n", encoding="utf-8")
    code = f"import sys, tactsim\ntry:\n    tactsim.load_case({str(case)!r})\nexcept Exception as e:\n    print(e)\n"
    code += "print('numba' in sys.modules, 'tactsim.experiments.grasp.grasp' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (
        "case.yaml:4: experiment.kind: unknown kind 'film_tset' (did you mean 'film_test'?); choices: annulus_design"
        in done.stdout
    )
    assert done.stdout.endswith("False False\n")
