"""Results that somebody edited, shown in words, as a picture and on the page: refused or shown, never an internal error."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from live_pages import grasp_folder, localized_folder

from tactsim.cli import main
from tactsim.errors import TactsimError
from tactsim.live.session.choices import stored_choice
from tactsim.live.session.content import opened_content
from tactsim.live.session.estimating import frame_readings
from tactsim.live.session.messages import Scales, frame_message, scene_message, shapes_message
from tactsim.live.session.session import readings_or_fault
from tactsim.live.session.thinking import estimate_message, message_or_fault
from tactsim.outside import json_text
from tactsim.results.reading import read_result

pytestmark = pytest.mark.filterwarnings("ignore:.*result.json was changed since tactsim wrote it")

HUGE = 10**39
BAD_DOCUMENTS: dict[str, tuple[str, str]] = {
    "a word for a number": ('"value": 0.001', '"value": "one"'),
    "a mapping for a number": ('"value": 0.001', '"value": {"a": 1}'),
    "a list for a title": ('"title": "', '"title": ["x"], "other": "'),
    "lists that do not fit": ('"value": 0.001', '"value": [[1, 2], [3]]'),
    "a list beside a number": ('"value": 0.001', '"value": [1, [2]]'),
    "a word in a list": ('"value": 0.001', '"value": [1, "2"]'),
    "a number beyond all numbers": ('"value": 0.001', '"value": 1e400'),
    "a number of 5000 digits": ('"value": 0.001', '"value": ' + "9" * 5000),
    "no number": ('"value": 0.001', '"value": NaN'),
    "an unknown unit": ('"unit": "m"', '"unit": "evil"'),
    "a unit of control characters": ('"unit": "m"', '"unit": "\\u001b[31m"'),
    "a number for a unit": ('"unit": "m"', '"unit": 7'),
    "an unknown unit of the steps": ('"displacement": "m"', '"displacement": "__import__"'),
    "a word for a step": ('"step": 1', '"step": "1"'),
    "true for a step": ('"step": 1', '"step": true'),
    "half a step": ('"step": 1', '"step": 1.5'),
    "a word for a residual": ('"residual": 0.0', '"residual": "small"'),
    "a word for a history value": ('"values": {\n    "displacement": 0.001', '"values": {\n    "displacement": "far"'),
    "an unknown status": ('"status": "converged"', '"status": "fine"'),
    "a name without end": ('"time": {', f'"{"x" * 1000}": {{'),
    "steps that are no list": ('"steps": [', '"steps": 1, "other": ['),
    "a version of another kind": ('"schema_version": 2', '"schema_version": "2"'),
    "true for a version": ('"schema_version": 2', '"schema_version": true'),
    "lists without end": ('"scene": {', '"scene": {"deep": ' + "[" * 500 + "]" * 500 + ","),
    "lists beyond recursion": ('"scene": {', '"scene": {"deep": ' + "[" * 100_000 + "]" * 100_000 + ","),
}
Path_ = tuple[str, ...]
THIN = {"kind": "ellipsoid", "center": [0.02, 0.02, 0.01], "semi_axes": [1e-9, 5e-3, 5e-3]}
BAD_SCENES: list[tuple[Path_, Any]] = [
    (("scene", "matrix"), []),
    (("scene", "matrix", "rows"), 10**9),
    (("scene", "matrix", "pitch"), True),
    (("scene", "block_size"), ["40 mm", True, 0.02]),
    (("scene", "matrix", "pitch"), 1e300),
    (("scene", "matrix", "size"), "9 mm"),
    (("scene", "block_size"), [1e300, 1e300, 1e300]),
    (("scene", "block_size"), [0, -1, None]),
    (("scene", "block_size"), HUGE),
    (("scene", "jaws"), "x"),
    (("scene", "jaws", "upper"), None),
    (("scene", "jaw_places"), {"upper": [[1], 2, 3], "lower": {}}),
    (("scene", "jaw_places"), {"upper": [1e300, 0, 0], "lower": [0, 0, 0]}),
    (("scene", "inclusions"), {"a": 1}),
    (("scene", "inclusions"), [{"shape": {"kind": "sphere", "center": [1e300] * 3, "radius": 1e300}, "unlike_tissue": True}]),
    (("scene", "inclusions"), [{"shape": THIN, "unlike_tissue": True}]),
    (("scene", "noise"), "x"),
    (("scene", "solver"), {"unknowns": "many"}),
    (("scene",), {}),
    (("scene",), None),
    (("kind",), "film_test"),
    (("quantities", "time_history", "value"), [1e300, 1e301, 1e302, 1e303]),
    (("quantities", "taxel_force_upper_history", "value"), 3),
    (("quantities", "taxel_force_upper", "value"), [[1e300] * 3] * 3),
    (("quantities", "displacement", "value"), None),
    (("quantities", "displacement", "value"), [[1.0]]),
]


def edited(folder: Path, change: Callable[[str], str]) -> Path:
    """The folder with another text of its result."""
    file = folder / "result.json"
    before = file.read_text(encoding="utf-8")
    after = change(before)
    assert after != before
    file.write_text(after, encoding="utf-8")
    return folder


def with_value(folder: Path, place: Path_, value: Any) -> Path:
    """The folder with another value in one place of its result."""

    def change(text: str) -> str:
        content = json.loads(text)
        inner = content
        for key in place[:-1]:
            inner = inner[key]
        inner[place[-1]] = value
        return json.dumps(content)

    return edited(folder, change)


def shown_on_the_page(folder: Path) -> None:
    """Makes all messages of the page about a result, or sees it refused in words."""
    codes = {2, 5}
    try:
        content = opened_content(folder)
    except TactsimError as error:
        codes &= {error.exit_code}
        assert codes
        return
    for recording in content.recordings.values():
        frame = recording.frame(0)
        choice = content.choices[0]
        scene_message(recording.scene)
        assert "internal error" not in message_or_fault(partial(shapes_message, recording.scene))
        readings = readings_or_fault(partial(frame_readings, recording.scene, frame, choice, None))
        frame_message(recording.scene, frame, readings, Scales())
        estimate = json.loads(message_or_fault(partial(estimate_message, recording.scene, readings, choice, None)))
        assert "internal error" not in estimate.get("fault", estimate.get("words"))


@pytest.mark.parametrize("name", BAD_DOCUMENTS)
def test_a_result_that_no_run_writes_is_refused_in_words(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    old, new = BAD_DOCUMENTS[name]
    folder = edited(grasp_folder(tmp_path / "a"), lambda text: text.replace(old, new, 1))
    picture = tmp_path / "a.png"
    for arguments in ([], ["--save", str(picture)], ["--web", "--no-browser"]):
        assert main(["show", str(folder), *arguments]) == 5
        printed = capsys.readouterr()
        assert printed.err.startswith("error: ")
        assert "internal error" not in printed.err
        assert "Traceback" not in printed.err
        assert "\x1b" not in printed.err
        assert len(printed.err) < 1000
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


@pytest.mark.parametrize(("place", "value"), BAD_SCENES)
def test_scenes_that_do_not_fit_are_reported_and_no_half_picture_is_left(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], place: Path_, value: Any
) -> None:
    folder = with_value(grasp_folder(tmp_path / "a"), place, value)
    assert main(["show", str(folder)]) == 0
    capsys.readouterr()
    code = main(["show", str(folder), "--save", str(tmp_path / "a.png")])
    printed = capsys.readouterr().err
    assert code in (0, 2, 5)
    assert code == 0 or "warning: " in printed
    assert "internal error" not in printed
    assert sorted(path.name for path in tmp_path.iterdir()) == (["a"] if code else ["a", "a.png"])
    shown_on_the_page(folder)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("center", [1, 2]),
        ("center", [None, 1, 1]),
        ("center", "xyz"),
        ("radius", []),
        ("radius", -1),
        ("line", [[1]]),
        ("kind", {}),
    ],
)
def test_a_stored_estimate_that_does_not_fit_is_reported(tmp_path: Path, key: str, value: Any) -> None:
    folder = localized_folder(tmp_path / "a")

    def change(text: str) -> str:
        content = json.loads(text)
        content["scene"]["estimates"][0][key] = value
        return json.dumps(content)

    try:
        choice = stored_choice(edited(folder, change))
    except TactsimError as error:
        assert error.exit_code == 5  # noqa: PT017  either it can be shown or it says why not
    else:
        assert choice is not None


def test_a_result_of_millions_of_values_is_refused_before_it_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(json_text, "MOST_VALUES", 1000)
    folder = edited(
        grasp_folder(tmp_path / "a"), lambda text: text.replace('"scene": {', '"scene": {"x": [' + "[]," * 1000 + "0],")
    )
    with pytest.raises(TactsimError, match="more than 1000 values"):
        read_result(folder, fields=False)


def test_provenance_is_checked_likewise(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = grasp_folder(tmp_path / "a")
    deep = '{"case": ' + "[" * 50 + "]" * 50 + "}"
    for text in ("[" * 10_000, '{"case": 1e999}', "[]", deep, '{"case": null}', '{"case": [1]}', '{"case": {"experiment": 3}}'):
        (folder / "provenance.json").write_text(text, encoding="utf-8")
        for command in (["show", str(folder)], ["compare", str(folder), str(folder)]):
            assert main(command) == 5
            assert "provenance.json is damaged" in capsys.readouterr().err
    (folder / "provenance.json").write_text('{"case": {"title": "a\\u001b[31m\\nconverged"}}', encoding="utf-8")
    assert main(["show", str(folder)]) == 0
    assert capsys.readouterr().out.startswith("a\\x1b[31m\\nconverged\n")


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["kind", "rows", "value", "x"]), inner, max_size=3)
    ),
    max_leaves=6,
)
PLACES = [place for place, _ in BAD_SCENES] + [
    ("quantities", "displacement"),
    ("quantities", "taxel_force_lower", "value"),
    ("steps",),
    ("units",),
    ("timing",),
    ("warnings",),
    ("reason",),
    ("kind",),
    ("scene",),
    ("quantities",),
]


@settings(derandomize=True, deadline=None, max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(PLACES), VALUES)
def test_any_value_in_any_place_is_shown_or_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], place: Path_, value: Any
) -> None:
    folder = tmp_path / "a"
    text = (folder / "result.json").read_text(encoding="utf-8") if folder.exists() else None
    if text is None:
        grasp_folder(folder)
        text = (folder / "result.json").read_text(encoding="utf-8")
    try:
        content = json.loads(text)
        inner = content
        for key in place[:-1]:
            inner = inner[key]
        inner[place[-1]] = value
        (folder / "result.json").write_text(json.dumps(content), encoding="utf-8")
        assert main(["show", str(folder)]) in (0, 5)
        shown_on_the_page(folder)
    finally:
        (folder / "result.json").write_text(text, encoding="utf-8")
