"""The live page in a real headless Chromium: numbers, the view in space, playing, estimators, the live feed, its speed."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fork_server import forked_command
from live_pages import TITLE, description, frame_line, grasp_folder, line, localized_folder, made_up_store, taxel_forces
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

PACKAGES = {"chromium": "chromium", "chromedriver": "chromium-driver"}
FLAGS = """--headless=new --no-sandbox --disable-gpu --use-angle=swiftshader --enable-unsafe-swiftshader --disable-quic
--no-first-run --disable-background-networking --disable-component-update --disable-sync --window-size=1280,800"""
PATIENCE = 60.0
"""Time in s for what takes a second on an idle machine."""
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


@contextmanager
def shown(browser: webdriver.Chrome, *arguments: str) -> Iterator[None]:
    """The page of a command, which must say nothing to the console but warnings of the graphics driver."""
    command = [*forked_command(), "show", *arguments, "--web", "--no-browser"]
    with subprocess.Popen(command, text=True, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            browser.get(process.stdout.readline().strip())
            yield
            told = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
            assert told == []
        finally:
            process.terminate()


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
    """Taxel -> the number in its cell."""
    script = "return [...document.querySelectorAll('[data-taxel]')].map((cell) => [cell.dataset.taxel, cell.textContent])"
    return {name: float(text.replace("–", "nan")) for name, text in browser.execute_script(script)}


def expected(forces: np.ndarray) -> dict[str, float]:
    """Taxel -> force, for forces (jaw, row, column)."""
    return {f"{'UL'[jaw]}{row + 1},{column + 1}": float(force) for (jaw, row, column), force in np.ndenumerate(forces)}


def shows(browser: webdriver.Chrome, forces: np.ndarray, relative: float = 1e-3) -> bool:
    """Whether the table shows these forces, to the digits that it prints."""
    return bool(table(browser) == pytest.approx(expected(forces), rel=relative))


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
        forces = np.array([quantities[f"taxel_force_{side}"]["value"] for side in ("upper", "lower")])
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
        body.send_keys("2")
        until(lambda: "the reference" in words(browser, "estimate") and words(browser, "estimate") != before)
        body.send_keys("1")
        until(lambda: words(browser, "estimate") == before)

        body.send_keys(Keys.ARROW_LEFT)
        until(lambda: shows(browser, 0.75 * forces))
        body.send_keys(Keys.HOME)
        until(lambda: shows(browser, 0.25 * forces))
        count = drawn(browser)
        body.send_keys(Keys.SPACE)
        until(lambda: shows(browser, forces) and words(browser, "play") == "Play")
        assert drawn(browser) > count + 2, "steps between were drawn, too"
        browser.find_element(By.CSS_SELECTOR, "[name=unit][value=kPa]").click()
        until(lambda: shows(browser, forces / 9e-3**2 / 1e3))
        browser.save_screenshot(str(tmp_path / "result.png"))


def test_a_localization_shows_its_estimate_first_and_draws_its_tube(browser: webdriver.Chrome, tmp_path: Path) -> None:
    with shown(browser, str(localized_folder(tmp_path / "a"))):
        until(lambda: "Tube at (20.0, 20.0, 10.0) mm, radius 3.0 mm" in words(browser, "estimate"))
        assert "A ball and a tube" in words(browser, "estimate")
        assert "As stored: hypotheses" in words(browser, "estimators")
        browser.save_screenshot(str(tmp_path / "localized.png"))
        browser.find_element(By.TAG_NAME, "body").send_keys("2")
        until(lambda: "Tube" not in words(browser, "estimate"))


def test_a_sample_is_picked(browser: webdriver.Chrome, tmp_path: Path) -> None:
    forces = taxel_forces(1)[0]
    with shown(browser, str(made_up_store(tmp_path))):
        until(lambda: shows(browser, forces))
        browser.find_element(By.ID, "next").click()
        until(lambda: shows(browser, 1.1 * forces))
        number = browser.find_element(By.ID, "number")
        number.send_keys(Keys.CONTROL + "a")
        number.send_keys("4", Keys.ENTER)
        until(lambda: "sample 4 is failed: ConvergenceError: residual <i>1</i>" in words(browser, "alerts"))
        assert all(np.isnan(value) for value in table(browser).values())
        browser.save_screenshot(str(tmp_path / "sample.png"))


@contextmanager
def sender(port: int, count: int, rate: float = 60.0) -> Iterator[None]:
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


@pytest.mark.parametrize("count", [3, 16])
def test_a_live_feed_is_drawn_and_its_title_stays_text(browser: webdriver.Chrome, tmp_path: Path, count: int) -> None:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    with shown(browser, "--live", f"tcp://127.0.0.1:{port}"), sender(port, count):
        until(lambda: drawn(browser) > 5)
        assert words(browser, "title") == SCRIPT
        assert browser.title == f"{SCRIPT} – tactsim"
        until(lambda: shows(browser, taxel_forces(1, count)[0], 1e-3 if count == 3 else 5.1e-2))
        until(lambda: "malformed in the stream, the last one: line" in words(browser, "alerts"))
        assert "'<b>'; needed: a finite number" in words(browser, "alerts")
        before = drawn(browser)
        until(lambda: drawn(browser) > before + 5)
        browser.save_screenshot(str(tmp_path / f"live{count}.png"))
