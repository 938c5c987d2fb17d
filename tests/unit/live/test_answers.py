"""What the page receives of an estimate: never one that is past, how far a slow one is, its cancelling, and what it is of."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from live_pages import description, frame_line, grasp_folder, line, localized_folder, made_up_store, taxel_forces
from open_pages import Client, Page, opened_page, with_client
from slow_estimator import slow_content

from tactsim.interfaces.taxel_layout import JAWS
from tactsim.live.session import session
from tactsim.live.session.choices import stored_choice
from tactsim.live.session.content import opened_content
from tactsim.live.session.estimating import frame_readings, shown_signal
from tactsim.live.sources import feed as feeds
from tactsim.live.sources.feed import Feed
from tactsim.live.sources.samples import Samples
from tactsim.live.sources.scene import PageScene


def answered(page: Page, name: str) -> bool:
    """Whether the last message of an estimate is an answer of this estimator."""
    last = page.last.get("estimate", {})
    return last.get("estimator") == name and not last["busy"]


def test_the_old_estimate_goes_as_soon_as_another_is_chosen(tmp_path: Path) -> None:
    content, slow = slow_content(tmp_path)

    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: answered(page, "thesis"))
        assert page.last["estimate"]["inclusions"]
        assert page.last["estimate"]["label"] == "Thesis"
        assert page.last["estimate"]["moment"] == {"step": 4, "steps": 4, "time": 1.0, "closing": 1.0}
        await page.do("estimator", name="slow")
        await page.until(lambda: page.last["estimate"]["estimator"] == "slow")
        assert page.last["estimate"]["busy"], "the first word of another estimator is that there is no answer yet"
        assert "inclusions" not in page.last["estimate"]
        await page.until(lambda: page.last["estimate"]["seconds"] > 0.2)
        before = page.last["estimate"]
        assert before["moment"]["step"] == 4
        await page.until(lambda: page.last["estimate"]["seconds"] > before["seconds"])
        assert page.last["estimate"]["systems"] > before["systems"] > 0, "it shows how far it is"
        slow.free = True
        await page.until(lambda: answered(page, "slow"))
        assert page.last["estimate"]["words"][0] == "Found slowly"
        slow.free = False
        await page.do("show", step=0)
        await page.until(lambda: page.last["estimate"]["busy"])
        await page.until(lambda: page.last["estimate"]["moment"].get("step") == 1)

    with_client(content, act)


def test_an_estimate_is_cancelled_and_computed_again(tmp_path: Path) -> None:
    content, slow = slow_content(tmp_path)

    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.do("estimator", name="slow")
        await page.until(lambda: page.last.get("estimate", {}).get("seconds", 0) > 0.2)
        await page.do("cancel")
        await page.until(lambda: page.last["estimate"].get("cancelled", False))
        assert page.last["estimate"]["inclusions"] == []
        await page.do("estimate")
        await page.until(lambda: page.last["estimate"]["busy"])
        await page.until(lambda: slow.ended == ["was stopped"])  # the thread does not go on for nobody
        slow.free = True
        await page.until(lambda: answered(page, "slow"))
        assert slow.ended == ["was stopped", "done"]

    with_client(content, act)


def test_a_quick_estimator_does_not_wait_for_a_slow_one(tmp_path: Path) -> None:
    content, slow = slow_content(tmp_path)

    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.do("estimator", name="slow")
        await page.until(lambda: page.last.get("estimate", {}).get("seconds", 0) > 0.2)
        begun = time.monotonic()
        await page.do("estimator", name="thesis")
        await page.until(lambda: answered(page, "thesis"))
        assert not slow.free
        assert time.monotonic() - begun < 15.0, "the slow one takes twenty seconds"

    with_client(content, act)


def test_a_stream_that_stands_or_has_ended_is_of_the_past(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(feeds.time, "monotonic", lambda: now[0])
    feed = Feed("test")
    stream = feed.stream()
    assert not feed.state_now()["over"], "nothing has come yet"
    stream.take(line(description()) + line(frame_line(1.0)) + b"?\n")
    state = feed.state_now()
    assert (state["over"], state["recent"], state["malformed"]) == (False, True, 1)
    now[0] += feeds.STANDS + 2
    assert feed.state_now()["over"]
    assert feed.state_now()["state"] == "no frame for 5 s"
    now[0] += feeds.RECENT
    assert not feed.state_now()["recent"]
    assert feed.state_now()["malformed"] == 1, "it stays counted"
    stream.take(line(frame_line(2.0)))
    assert not feed.state_now()["over"]
    feed.end("the sender has gone; the last frame stays")
    assert feed.state_now()["over"]


def test_the_estimator_at_the_beginning_takes_off_the_reference_that_was_given(tmp_path: Path) -> None:
    plain = grasp_folder(tmp_path / "plain", taxel_forces(4, lump=0.0), lump=False)
    content = opened_content(grasp_folder(tmp_path / "a"), reference=[str(plain)])

    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: "offer" in page.last)
        assert page.last["offer"]["estimator"] == "thesis with reference"

    with_client(content, act)


@pytest.mark.filterwarnings("ignore:.*result.json was changed since tactsim wrote it")
def test_a_stored_estimate_has_its_region_and_the_readings_it_was_made_of(tmp_path: Path) -> None:
    folder = localized_folder(tmp_path / "a")
    path = folder / "result.json"
    content = json.loads(path.read_text())
    outline = [[0.02, 0.01], [0.03, 0.01], [0.03, 0.02], [0.02, 0.02], [0.02, 0.01]]
    content["scene"]["estimates"][1]["region"] = {"top": [outline], "front": [], "left": []}
    for side in JAWS:
        taxels = content["quantities"][f"taxel_force_{side}"]
        taxels_less = [[value - 0.1 for value in row] for row in taxels["value"]]
        content["quantities"][f"taxel_difference_{side}"] = {**taxels, "value": taxels_less}
    path.write_text(json.dumps(content))
    choice = stored_choice(folder)
    assert choice is not None
    recording = opened_content(folder).recordings["taxel_force"]
    readings = frame_readings(recording.scene, recording.frame(0), choice, None)
    signal, meaning = shown_signal(readings)
    assert meaning == "force above that of the reference"
    np.testing.assert_allclose(signal, taxel_forces(1)[0] - 0.1)
    ball, tube = choice.estimator.estimate(readings).inclusions
    assert tube.region is not None
    np.testing.assert_allclose(tube.region.shadow(2), [outline])
    np.testing.assert_allclose(tube.region.sizes()[0], 2 * np.sqrt(1e-4 / np.pi))
    assert ball.region is not None, "of its standard deviations, if no region was kept"
    # along x, from above: the root of the 90 % quantile of chi-squared with three degrees of freedom, 2.5, times 1 mm
    np.testing.assert_allclose(np.ptp(ball.region.shadow(2)[0][:, 0]), 2 * 2.5e-3, rtol=0.01)


def test_true_inclusions_of_a_sample_never_stand_in_the_next_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An artery takes a second or two to draw; chosen away, it stood in the next sample for as long again."""
    go_on, of_first = threading.Event(), threading.Event()

    def shapes(scene: PageScene) -> str:
        first = "sample 0" in scene.title
        if first:
            of_first.set()
            go_on.wait(10.0)
        return json.dumps({"is": "shapes", "of": scene.title, "inclusions": []})

    monkeypatch.setattr(session, "shapes_message", shapes)

    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: "frame" in page.last)
        await asyncio.to_thread(of_first.wait, 10.0)
        await page.do("sample", number=1)
        await page.until(lambda: "sample 1" in page.last["scene"]["title"])
        go_on.set()
        await page.until(lambda: "shapes" in page.last)
        assert "sample 1" in page.last["shapes"]["of"]

    async def none(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: "frame" in page.last)
        await asyncio.to_thread(of_first.wait, 10.0)
        await page.do("filter", split=others, status="failed")
        await page.until(lambda: "state" in page.last)
        assert page.last["state"]["selection_fault"].startswith("no sample has this split and status")
        go_on.set()
        await asyncio.sleep(0.3)
        await page.do("sample", number=6)
        await page.until(lambda: "fault" in page.last)
        assert "shapes" not in page.last, "they stand on a page that shows no sample"

    store = made_up_store(tmp_path)
    samples = Samples.open(store)
    others = next(name for name in samples.splits if name != samples.status_of(4)["split"])
    with_client(opened_content(store), act)
    go_on.clear()
    of_first.clear()
    with_client(opened_content(store), none)
