"""The live page in a real headless Chromium: numbers, the view in space, playing, estimators, the live feed, its speed."""

from __future__ import annotations

import asyncio
import json
import re
import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from aiohttp import web
from fork_server import forked_command
from live_pages import (
    TITLE,
    description,
    frame_line,
    grasp_folder,
    line,
    localized_folder,
    made_up_grasp,
    made_up_store,
    resized,
    taxel_forces,
)
from matplotlib.image import imread
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from slow_estimator import slow_content

from tactsim.interfaces.taxel_layout import JAWS
from tactsim.live.server import application
from tactsim.live.session.content import Content, opened_content
from tactsim.live.sources import feed as feeds
from tactsim.live.sources.feed import Feed
from tactsim.results import write_result

PACKAGES = {"chromium": "chromium", "chromedriver": "chromium-driver"}
FLAGS = """--headless=new --no-sandbox --disable-gpu --use-angle=swiftshader --enable-unsafe-swiftshader --disable-quic
--no-first-run --disable-background-networking --disable-component-update --disable-sync --window-size=1024,640"""
PATIENCE = 60.0
"""Time in s for what takes a second on an idle machine."""
COLOURED = """
const canvas = document.querySelector('#top canvas'), pen = canvas.getContext('2d');
const { width, height } = canvas, data = pen.getImageData(0, 0, width, height).data, columns = new Set();
for (let k = 0; k < data.length; k += 4) {
  const bluish = data[k + 3] === 255 && data[k + 2] > data[k] + 40;
  if (bluish && k / 4 / width < 0.7 * height) columns.add((k / 4) % width);
}
return [columns.size && Math.max(...columns) - Math.min(...columns), Number(canvas.dataset.scale)];"""
"""Width in pixels over which the top view is coloured, and pixels per mm."""
OPAQUE = """
const canvas = document.querySelector('#top canvas'), pen = canvas.getContext('2d');
const { width, height } = canvas, data = pen.getImageData(0, 0, width, height).data;
let count = 0;
for (let k = 3; k < data.length; k += 4) count += data[k] === 255;
return count;"""
"""Pixels of the top view that nothing shows through, as through the hatching."""
RECORD_WORDS = """
window.wordsDrawn = null;
const words = {}, write = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
  const kind = this.canvas.closest('section')?.id;
  (words[kind] ??= []).push([text, x, y, this.textAlign]);
  if (['top', 'front', 'left'].every((name) => words[name]?.length > 8)) window.wordsDrawn = words;
  return write.call(this, text, x, y, ...rest);
};"""
"""Keeps the words that the views draw, with their places and how they are aligned."""
LABELS = """return [...document.querySelectorAll('#space-labels span')].map((one) => {
  const box = one.getBoundingClientRect();
  return [box.left, box.top, box.right, box.bottom];
});"""
"""Borders of the labels in space: left, top, right and bottom."""
SCRIPT = "<script>document.title = 'taken over'</script>"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[webdriver.Chrome]:
    missing = [package for program, package in PACKAGES.items() if shutil.which(program) is None]
    if missing:
        pytest.fail(f"the tests of the page need the system packages {', '.join(missing)}: apt-get install {' '.join(missing)}")
    options = webdriver.ChromeOptions()
    options.binary_location = str(shutil.which("chromium"))
    for flag in [*FLAGS.split(), f"--user-data-dir={tmp_path_factory.mktemp('profile')}"]:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    found = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
    yield found
    found.quit()


def overlap(one: list[float], other: list[float]) -> bool:
    """Whether two boxes of left, top, right and bottom have more than a border in common."""
    return min(one[2], other[2]) - max(one[0], other[0]) > 1 and min(one[3], other[3]) - max(one[1], other[1]) > 1


@contextmanager
def shown(browser: webdriver.Chrome, *arguments: str) -> Iterator[None]:
    """The page of a command, which must say nothing to the console but warnings of the graphics driver."""
    command = [*forked_command(), "show", *arguments, "--web", "--no-browser"]
    with subprocess.Popen(command, text=True, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            with silent(browser, process.stdout.readline().strip()):
                yield
        finally:
            process.terminate()


@contextmanager
def silent(browser: webdriver.Chrome, address: str) -> Iterator[None]:
    """The page at an address, which must say nothing to the console but warnings of the graphics driver."""
    browser.get("about:blank")
    browser.get_log("browser")  # what a page before this one asked of a server that had ended
    browser.get(address)
    yield
    told = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert told == []


@contextmanager
def shown_here(browser: webdriver.Chrome, place: Path) -> Iterator[None]:
    """As ``shown``, of a server in this process: a command begins within a second."""
    with served(opened_content(place)) as address, silent(browser, address):
        yield


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set that no test changes."""
    return made_up_store(tmp_path_factory.mktemp("store"))


@contextmanager
def served(content: Content) -> Iterator[str]:
    """The address of a page of this process; at the end the server has gone."""
    loop, ended = asyncio.new_event_loop(), threading.Event()
    runner = web.AppRunner(application(content, "token"), shutdown_timeout=0.5)

    async def begin() -> int:
        await runner.setup()
        await web.TCPSite(runner, "127.0.0.1", 0).start()
        return int(runner.addresses[0][1])

    def run() -> None:
        loop.run_forever()
        loop.close()
        ended.set()

    threading.Thread(target=run, daemon=True).start()
    port = asyncio.run_coroutine_threadsafe(begin(), loop).result(PATIENCE)
    try:
        yield f"http://127.0.0.1:{port}/token/"
    finally:
        asyncio.run_coroutine_threadsafe(runner.cleanup(), loop).result(PATIENCE)
        loop.call_soon_threadsafe(loop.stop)
        ended.wait(PATIENCE)


def marked(browser: webdriver.Chrome) -> int:
    """How many pixels of the top view have the colour of an estimate."""
    script = """
    const canvas = document.querySelector('#top canvas'), pen = canvas.getContext('2d');
    const data = pen.getImageData(0, 0, canvas.width, canvas.height).data;
    let count = 0;
    for (let k = 0; k < data.length; k += 4) count += data[k] > 190 && data[k + 1] < 60 && data[k + 2] < 70;
    return count;"""
    return int(browser.execute_script(script))


def greyed(browser: webdriver.Chrome) -> bool:
    """Whether the whole picture is grey."""
    script = "return getComputedStyle(document.querySelector('#top canvas')).filter"
    return "grayscale" in str(browser.execute_script(script))


def shows_element(browser: webdriver.Chrome, name: str) -> bool:
    """Whether an element is there to be seen."""
    return bool(browser.find_element(By.ID, name).is_displayed())


def until(condition: Callable[[], Any]) -> Any:
    """What a condition gives when it holds at last."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError("it did not happen in time")


def words(browser: webdriver.Chrome, name: str) -> str:
    """The text of an element."""
    return str(browser.execute_script("return document.getElementById(arguments[0]).textContent", name))


def table(browser: webdriver.Chrome) -> dict[str, float]:
    """Taxel -> the force of its cell in N, or the pressure in kPa."""
    factor = 1e-3 if words(browser, "taxel-unit") == "force in mN" else 1.0
    script = "return [...document.querySelectorAll('[data-taxel]')].map((cell) => [cell.dataset.taxel, cell.textContent])"
    return {name: factor * float(text.replace("–", "nan")) for name, text in browser.execute_script(script)}


def expected(forces: np.ndarray) -> dict[str, float]:
    """Taxel -> force, for forces (jaw, row, column)."""
    return {f"{'UL'[jaw]}{row + 1},{column + 1}": float(force) for (jaw, row, column), force in np.ndenumerate(forces)}


def shows(browser: webdriver.Chrome, forces: np.ndarray) -> bool:
    """Whether the table shows these forces with as many decimals as give the largest four digits."""
    return bool(table(browser) == pytest.approx(expected(forces), rel=0, abs=6e-4 * np.nanmax(np.abs(forces))))


def drawn(browser: webdriver.Chrome) -> int:
    """How many frames the page has drawn."""
    return int(browser.execute_script("return document.documentElement.dataset.drawn || 0"))


def camera(browser: webdriver.Chrome) -> str:
    """Where the eye of the view in space is."""
    return str(browser.execute_script("return document.getElementById('space-canvas').dataset.camera || ''"))


def test_a_result_shows_its_numbers_turns_plays_and_changes_estimators(browser: webdriver.Chrome, tmp_path: Path) -> None:
    folder = grasp_folder(tmp_path / "a")
    plain = grasp_folder(tmp_path / "b", taxel_forces(4, lump=0.0), lump=False)
    with shown(browser, str(folder), "--reference", str(plain)):
        quantities = json.loads((folder / "result.json").read_text())["quantities"]
        forces = np.array([quantities[f"taxel_force_{side}"]["value"] for side in JAWS])
        until(lambda: shows(browser, forces))
        assert not shows(browser, 1.003 * forces), "the comparison can fail"
        assert words(browser, "title") == TITLE
        until(lambda: "Off by" in words(browser, "estimate"))
        before = words(browser, "estimate")

        start = until(lambda: camera(browser))
        canvas = browser.find_element(By.ID, "space-canvas")
        ActionChains(browser).drag_and_drop_by_offset(canvas, 90, 20).perform()
        until(lambda: camera(browser) != start)
        browser.find_element(By.CSS_SELECTOR, "[data-turn=reset]").click()
        until(lambda: camera(browser) == start)

        body = browser.find_element(By.TAG_NAME, "body")
        assert "the reference" in before, "the reference that was given is taken off"
        body.send_keys("1")
        until(lambda: "the median of all" in words(browser, "estimate") and words(browser, "estimate") != before)
        body.send_keys("2")
        until(lambda: words(browser, "estimate") == before)

        body.send_keys(Keys.ARROW_LEFT)
        until(lambda: shows(browser, 0.75 * forces))
        body.send_keys(Keys.HOME)
        until(lambda: shows(browser, 0.25 * forces))
        body.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)  # the last quarter plays in a second
        until(lambda: shows(browser, 0.75 * forces))
        count = drawn(browser)
        body.send_keys(Keys.SPACE)
        until(lambda: shows(browser, forces) and words(browser, "play") == "Play")
        assert drawn(browser) > count + 2, "steps between were drawn, too"
        browser.find_element(By.CSS_SELECTOR, "[name=unit][value=kPa]").click()
        until(lambda: shows(browser, forces / 9e-3**2 / 1e3))


def test_the_page_says_that_it_waits_until_the_server_has_sent_something(browser: webdriver.Chrome, tmp_path: Path) -> None:
    silent = "window.WebSocket = class extends EventTarget { static CLOSED = 3; readyState = 0; };"
    script = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": silent})
    with served(opened_content(grasp_folder(tmp_path / "a"))) as address:
        try:
            browser.get(address)
            assert shows_element(browser, "waiting")
        finally:
            browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)
        browser.get(address)
        assert until(lambda: words(browser, "title") == TITLE)
        assert not shows_element(browser, "waiting")


@pytest.mark.parametrize("factors", [(0.01, 0.01, 0.01), (3.0, 3.0, 0.3), (0.5, 0.5, 3.0)])
def test_blocks_of_any_shape_have_ticks_that_are_apart_and_a_view_that_shows_all(
    factors: tuple[float, float, float], browser: webdriver.Chrome, tmp_path: Path
) -> None:
    """Ticks were 5 mm apart at least, none but 0 in a block of 0.4 mm; bars on the jaws of a tall block were cut off."""
    folder = write_result(resized(made_up_grasp(), factors), tmp_path / "a", case_id="abc", provenance={})
    with shown_here(browser, folder):
        until(lambda: browser.find_element(By.ID, "space-canvas").get_attribute("data-drawn"))
        browser.execute_script(RECORD_WORDS)
        browser.find_element(By.CSS_SELECTOR, "[name=unit][value=kPa]").click()
        drawn_words = until(lambda: browser.execute_script("return window.wordsDrawn"))
        for name in ("top", "front", "left"):
            numbers = [one for one in drawn_words[name] if re.fullmatch(r"[\d.]+", one[0])]
            across = sorted({x: words for words, x, y, align in numbers if align == "center" and y < numbers[-1][2]}.items())
            assert len({words for _, words in across}) == len(across) >= 2, name
            assert min(later[0] - one[0] for one, later in pairwise(across)) > 20, name
        places = browser.execute_script(LABELS)
        assert [pair for pair in combinations(places, 2) if overlap(*pair)] == []
        picture = imread(BytesIO(browser.find_element(By.ID, "space-canvas").screenshot_as_png))[..., :3]
        coloured = np.flatnonzero((np.ptp(picture, axis=2) > 0.3).any(axis=1))
        assert len(coloured) > 20
        assert 0 < coloured[0] <= coloured[-1] < len(picture) - 1, "bars reach beyond the picture in space"


def test_no_estimate_is_past_and_a_slow_one_is_cancelled(browser: webdriver.Chrome, tmp_path: Path) -> None:
    content, slow = slow_content(tmp_path / "a")
    with served(content) as address:
        browser.get(address)
        body = browser.find_element(By.TAG_NAME, "body")
        until(lambda: marked(browser) > 20 and "At (" in words(browser, "estimate"))
        until(lambda: "Of step 4 of 4, 1.000 s, computed" in words(browser, "age"))
        assert words(browser, "estimate-of") == "Thesis"
        assert "s ago" in until(lambda: "ago" in words(browser, "age") and words(browser, "age"))
        body.send_keys(str(len(content.choices)))
        until(lambda: shows_element(browser, "busy"))
        until(lambda: marked(browser) == 0)  # the cross of the other estimator
        assert words(browser, "estimate") == ""
        assert "estimated" not in words(browser, "legend")
        until(lambda: "parts done" in words(browser, "busy-words"))
        assert re.match(r"Computing the estimate of step 4 of 4, 1\.000 s: \d+ s so far, ", words(browser, "busy-words"))
        browser.find_element(By.ID, "cancel").click()
        until(lambda: "No estimate: cancelled" in words(browser, "estimate"))
        assert not shows_element(browser, "busy")
        slow.free = True
        browser.find_element(By.ID, "again").click()
        until(lambda: "Found slowly" in words(browser, "estimate") and marked(browser) > 20)
        slow.free = False
        body.send_keys(Keys.HOME)
        until(lambda: shows_element(browser, "busy") and marked(browser) == 0)
        assert not greyed(browser)
    until(lambda: greyed(browser))
    assert not shows_element(browser, "busy"), "nothing is computed any more"
    assert "The server has ended" in words(browser, "past")
    assert "the server has ended" in words(browser, "estimate")
    chosen = browser.find_element(By.CSS_SELECTOR, "input[name=estimator]:checked").get_attribute("value")
    body.send_keys("1")
    assert browser.find_element(By.CSS_SELECTOR, "input[name=estimator]:checked").get_attribute("value") == chosen
    asking = browser.find_elements(By.CSS_SELECTOR, "input[name=estimator], #slider, #play, #again")
    assert not any(one.is_enabled() for one in asking), "nobody is there to answer"
    assert all(one.is_enabled() for one in browser.find_elements(By.CSS_SELECTOR, "input[name=unit]"))


def test_the_estimate_stands_first_and_everything_fits_a_small_screen(browser: webdriver.Chrome, tmp_path: Path) -> None:
    folder, plain = grasp_folder(tmp_path / "a"), grasp_folder(tmp_path / "b", taxel_forces(4, lump=0.0), lump=False)
    size = {"width": 1024, "height": 640, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        with served(opened_content(folder, reference=[str(plain)])) as address:
            browser.get(address)
            until(lambda: "Off by" in words(browser, "estimate"))
            sections = "[...document.querySelectorAll('main section')]"
            bottoms = dict(browser.execute_script(f"return {sections}.map((s) => [s.id, s.getBoundingClientRect().bottom])"))
            assert next(iter(bottoms)) == "words"
            assert max(bottoms.values()) <= 640
            bottom = "return document.getElementById(arguments[0]).getBoundingClientRect().bottom"
            assert browser.execute_script(bottom, "estimate") < browser.execute_script(bottom, "words"), "without scrolling"
            top = "return document.getElementById('estimate').getBoundingClientRect().top"
            assert browser.execute_script(bottom, "age") <= browser.execute_script(top), "a long answer does not hide it"
            marks = "return [...document.querySelectorAll('#space-labels span')].map((one) => one.textContent)"
            until(lambda: browser.execute_script(marks) == ["x, 40 mm", "y, 40 mm", "z, 20 mm", "front"])
            assert "to 0.5" in browser.find_element(By.ID, "space-ramp").get_attribute("aria-label")
            now = words(browser, "space-words")
            browser.find_element(By.TAG_NAME, "body").send_keys(Keys.HOME)
            until(lambda: words(browser, "space-words") not in ("", now))
            assert "longest bar now 0.1" in words(browser, "space-words"), "of this step, not of the whole history"
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_small_forces_have_one_unit_and_both_tables_in_sight(browser: webdriver.Chrome, tmp_path: Path) -> None:
    forces = 0.08 * taxel_forces(1, 5)
    size = {"width": 1024, "height": 640, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        with served(opened_content(grasp_folder(tmp_path / "a", forces))) as address:
            browser.get(address)
            until(lambda: "Off by" in words(browser, "estimate") and shows(browser, forces[-1]))
            assert words(browser, "taxel-unit") == "force in mN"
            labels = [part.get_attribute("aria-label") for part in browser.find_elements(By.CSS_SELECTOR, "canvas")]
            scales = [label for label in labels if "scale to" in label or "of a bar, from" in label]
            assert len(scales) == 4, "of three views and the bars"
            assert all(label.endswith(" mN") for label in [*scales, words(browser, "space-words")])
            last = "return [...document.querySelectorAll('#tables td')].at(-1).getBoundingClientRect().bottom"
            place = "return document.getElementById('tables').getBoundingClientRect().bottom"
            assert browser.execute_script(last) <= browser.execute_script(place) + 0.6, "without scrolling"
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_a_map_covers_the_block_and_shades_what_no_taxel_reads(browser: webdriver.Chrome, tmp_path: Path) -> None:
    with served(opened_content(grasp_folder(tmp_path / "a"))) as address:
        browser.get(address)
        until(lambda: "Off by" in words(browser, "estimate"))
        assert "hatched: no taxel there" in words(browser, "legend")
        assert "2, 3, 4 greyed: no grasp without a lump to compare with" in words(browser, "missing")
        coloured, scale = browser.execute_script(COLOURED)
        # three taxels of 9 mm at a pitch of 10 mm reach over 29 mm; from centre to centre of the outer ones it is 20 mm
        assert coloured / scale == pytest.approx(29, abs=1)


def test_a_map_without_a_reference_at_its_closing_is_unknown_and_not_zero(browser: webdriver.Chrome, tmp_path: Path) -> None:
    folder, plain = grasp_folder(tmp_path / "a"), grasp_folder(tmp_path / "b", taxel_forces(1, lump=0.0), lump=False)
    with served(opened_content(folder, reference=[str(plain)])) as address:
        browser.get(address)
        until(lambda: "Off by" in words(browser, "estimate"))
        before = browser.execute_script(OPAQUE)
        browser.find_element(By.TAG_NAME, "body").send_keys(Keys.HOME)
        until(lambda: "known at a closing of 1 mm only" in words(browser, "estimate"))
        until(lambda: browser.execute_script(OPAQUE) < before / 3)  # the outlines and words are left
        label = browser.find_element(By.CSS_SELECTOR, "#top canvas").get_attribute("aria-label")
        assert label == "top view: unknown, see the estimate"


@pytest.mark.parametrize(
    ("width", "height", "jaw", "high"), [(390, 800, 0.05, 0.02), (1024, 640, 0.02, 0.02), (1024, 497, 0.05, 0.027)]
)
def test_the_labels_in_space_stay_whole(
    browser: webdriver.Chrome,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    *,
    width: int,
    height: int,
    jaw: float,
    high: float,
) -> None:
    """On a telephone, of a block twice as wide as the jaws, and in a low window, where one label pushed another out."""
    monkeypatch.setattr("live_pages.SIZE", np.array([0.04, 0.04, high]))
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        with served(opened_content(grasp_folder(tmp_path / "a", width=jaw, depth=jaw))) as address:
            browser.get(address)
            until(lambda: camera(browser) and "Off by" in words(browser, "estimate"))
            sides = """
            const within = document.getElementById('space-labels').getBoundingClientRect();
            return [...document.querySelectorAll('#space-labels span')].map((one) => {
              const { left, right, top, bottom } = one.getBoundingClientRect();
              return Math.min(left - within.left, within.right - right, top - within.top, within.bottom - bottom);
            });"""
            rooms = browser.execute_script(sides)
            assert len(rooms) == 4
            assert min(rooms) > -0.6, "in pixels, of which a place has tenths"
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_a_localization_shows_its_estimate_first_and_draws_its_tube(browser: webdriver.Chrome, tmp_path: Path) -> None:
    with shown_here(browser, localized_folder(tmp_path / "a")):
        until(lambda: "Tube at (20.0, 20.0, 10.0) mm, radius 3.0 mm" in words(browser, "estimate"))
        assert "A ball and a tube" in words(browser, "estimate")
        assert "As stored: hypotheses" in words(browser, "estimators")
        assert words(browser, "age") == "Computed with the result, not now"
        assert words(browser, "estimate-of") == "As stored: hypotheses"
        regions = "return document.getElementById('space-canvas').dataset.regions"
        until(lambda: browser.execute_script(regions) == "3")  # of the ball, by its standard deviations, in three planes
        assert "its centre lies in here with 90 %" in words(browser, "legend")
        browser.find_element(By.TAG_NAME, "body").send_keys("2")
        until(lambda: "Tube" not in words(browser, "estimate"))


def test_a_sample_is_picked(browser: webdriver.Chrome, store: Path) -> None:
    forces = taxel_forces(1)[0]
    with shown_here(browser, store):
        until(lambda: shows(browser, forces))
        browser.find_element(By.ID, "next").click()
        until(lambda: shows(browser, 1.1 * forces))
        number = browser.find_element(By.ID, "number")
        for refused in ("-3", "1.5", "10000", ""):  # the browser says why, and the picture stays
            number.send_keys(Keys.CONTROL + "a", Keys.DELETE)
            number.send_keys(refused, Keys.ENTER)
            assert not browser.execute_script("return arguments[0].checkValidity()", number)
            assert words(browser, "sample-words").endswith("is no sample; shown is 1, the last is 5")
        assert shows(browser, 1.1 * forces)
        browser.execute_script("arguments[0].blur()", number)
        assert number.get_property("value") == "1"  # the one that is shown, not the one that was refused
        number.send_keys(Keys.CONTROL + "a")
        number.send_keys("4", Keys.ENTER)
        until(lambda: "sample 4 is failed: ConvergenceError: residual <i>1</i>" in words(browser, "alerts"))
        assert all(np.isnan(value) for value in table(browser).values())


def test_nothing_of_the_last_sample_stays_where_none_is_chosen(browser: webdriver.Chrome, store: Path) -> None:
    with shown_here(browser, store):
        until(lambda: "longest bar now" in words(browser, "space-words") and "true" in words(browser, "legend"))
        until(lambda: _coloured(browser))
        browser.find_element(By.CSS_SELECTOR, "#split option[value='test']").click()  # the failed sample is another part's
        browser.find_element(By.CSS_SELECTOR, "#status option[value='failed']").click()
        until(lambda: "no sample has this split and status" in words(browser, "alerts"))
        assert words(browser, "title") == "tactsim"
        assert words(browser, "space-words") == ""
        assert "true" not in words(browser, "legend")
        assert not _coloured(browser)


def _coloured(browser: webdriver.Chrome) -> bool:
    """Whether bars are drawn in space: nothing else there is green or yellow."""
    picture = imread(BytesIO(browser.find_element(By.ID, "space-canvas").screenshot_as_png))[..., :3]
    return bool((picture[..., 1] - picture[..., 2] > 0.25).any())


@contextmanager
def sender(port: int, count: int, rate: float = 20.0) -> Iterator[None]:
    """A sensor of ``count`` x ``count`` taxels that sends frames, now and then a malformed one."""
    stop = threading.Event()

    def send() -> None:
        with socket.create_connection(("127.0.0.1", port)) as connection:
            connection.sendall(line(description(count, title=SCRIPT)))
            begin, number = time.monotonic(), 0
            while not stop.is_set():
                content = line(frame_line(number / rate, count))
                connection.sendall(content if number % 100 else b'{"time": "<b>"}\n')
                number += 1
                time.sleep(max(0.0, begin + number / rate - time.monotonic()))

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


@pytest.mark.parametrize("count", [3, pytest.param(16, marks=pytest.mark.slow)])
def test_a_live_feed_is_drawn_and_its_title_stays_text(browser: webdriver.Chrome, tmp_path: Path, count: int) -> None:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    with shown(browser, "--live", f"tcp://127.0.0.1:{port}"), sender(port, count):
        until(lambda: drawn(browser) > 5)
        assert words(browser, "title") == SCRIPT
        assert browser.title == f"{SCRIPT} – tactsim"
        if count == 3:
            until(lambda: shows(browser, taxel_forces(1, count)[0]))
        else:
            force = taxel_forces(1, count)[0, 0, 7, 8]
            canvas = browser.find_elements(By.CSS_SELECTOR, "#tables canvas")[0]
            ActionChains(browser).move_to_element_with_offset(canvas, -4, -4).perform()
            until(lambda: words(browser, "taxel-words").startswith("U"))
            canvas.send_keys(*[Keys.ARROW_LEFT] * count, *[Keys.ARROW_DOWN] * count)
            canvas.send_keys(*[Keys.ARROW_RIGHT] * 8, *[Keys.ARROW_UP] * 7)
            until(lambda: words(browser, "taxel-words") == f"U8,9 (row 8, column 9): {force:.4f} N")
            assert table(browser) == {}, "no columns of digits"
        until(lambda: "malformed in the stream, the last one: line" in words(browser, "alerts"))
        assert "'<b>'; needed: a finite number" in words(browser, "alerts")
        before = drawn(browser)
        until(lambda: drawn(browser) > before + 5)
        assert not greyed(browser)
    if count == 3:
        until(lambda: greyed(browser))


def test_an_ended_stream_greys_the_picture_and_a_malformed_line_is_forgotten(
    browser: webdriver.Chrome, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(feeds, "RECENT", 3.0)
    monkeypatch.setattr(feeds, "STANDS", 1.5)
    feed = Feed("hand")
    stream = feed.stream()
    stream.take(line(description()) + line(frame_line(1.0)) + b"?\n")
    with served(Content({}, feed=feed)) as address:
        browser.get(address)
        until(lambda: "1 malformed in the stream" in words(browser, "alerts"))
        until(lambda: greyed(browser))  # no frame for some seconds
        assert "no frame for" in words(browser, "past")
        stream.take(line(frame_line(2.0)))
        until(lambda: not greyed(browser))
        feed.end("the sender has gone; the last frame stays")
        until(lambda: greyed(browser) and "the sender has gone" in words(browser, "past"))
        until(lambda: words(browser, "alerts") == "")
        assert "1 malformed" in words(browser, "source-line")
