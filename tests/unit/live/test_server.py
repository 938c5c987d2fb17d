"""The server: token, host, origin, headers, and what a page receives."""

from __future__ import annotations

import asyncio
import socket
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from aiohttp import WSServerHandshakeError
from live_pages import TITLE, description, frame_line, grasp_folder, line, made_up_store, taxel_forces
from open_pages import TOKEN, Client, opened_page, with_client

from tactsim.errors import InputError, StorageError
from tactsim.live.server import Serving, serve
from tactsim.live.session import selection, session
from tactsim.live.session.content import Content, opened_content
from tactsim.live.sources.feed import Feed


@pytest.fixture
def grasp(tmp_path: Path) -> Content:
    return opened_content(grasp_folder(tmp_path / "grasp"))


def test_without_the_token_everything_is_refused(grasp: Content) -> None:
    async def act(client: Client) -> None:
        for path in ("/", "/page.js", "/ws", "/a-token_/", f"/x/{TOKEN}/", "/%20/", "//", f"/{TOKEN}x/"):
            assert (await client.get(path)).status == 403, path
        assert (await client.post("/")).status == 403
        assert (await client.post(f"/{TOKEN}/")).status == 405
        assert (await client.get(f"/{TOKEN}/")).status == 200

    with_client(grasp, act)


@pytest.mark.parametrize(
    ("host", "given", "status"),
    [
        ("127.0.0.1", "127.0.0.1:8000", 200),
        ("127.0.0.1", "localhost:8000", 200),
        ("127.0.0.1", "[::1]:8000", 200),
        ("127.0.0.1", "evil.example:8000", 403),
        ("127.0.0.1", "127.0.0.1.evil.example", 403),
        ("127.0.0.1", "192.168.0.7:8000", 403),
        ("127.0.0.1", "[", 403),
        ("0.0.0.0", "192.168.0.7:8000", 200),
        ("0.0.0.0", "evil.example:8000", 403),
        ("lab.example", "lab.example:8000", 200),
    ],
)
def test_only_known_names_of_the_host_are_answered(grasp: Content, host: str, given: str, status: int) -> None:
    async def act(client: Client) -> None:
        assert (await client.get(f"/{TOKEN}/", headers={"Host": given})).status == status

    with_client(grasp, act, host)


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null", "https://127.0.0.1"])
def test_a_socket_from_another_page_is_refused(grasp: Content, origin: str | None) -> None:
    async def act(client: Client) -> None:
        with pytest.raises(WSServerHandshakeError) as caught:
            await client.ws_connect(f"/{TOKEN}/ws", headers={"Origin": origin} if origin else {})
        assert caught.value.status == 403

    with_client(grasp, act)


def test_the_page_loads_nothing_from_elsewhere(grasp: Content) -> None:
    names = ("", "page.js", "answer.js", "controls.js", "space.js", "taxels.js", "views.js", "wire.js", "page.css", "icon.svg")
    vendored = tuple(
        f"vendor/three/{name}" for name in ("three.module.min.js", "three.core.min.js", "OrbitControls.js", "LICENSE")
    )

    async def act(client: Client) -> None:
        for name in names + vendored:
            answer = await client.get(f"/{TOKEN}/{name}")
            text = await answer.text()
            assert answer.status == 200, name
            policy = answer.headers["Content-Security-Policy"]
            assert "default-src 'none'" in policy
            assert "script-src 'self';" in policy
            assert "http" not in policy
            assert answer.headers["Referrer-Policy"] == "no-referrer"
            if name in names:
                assert "http://" not in text.replace("http://www.w3.org/2000/svg", ""), name
                assert "https://" not in text, name
                assert "innerHTML" not in text, name

    with_client(grasp, act)


@pytest.mark.parametrize(
    "name", ["none.js", "../server.py", "%2e%2e/server.py", "..%2fserver.py", "vendor", "a%00.js", "server.py"]
)
def test_other_files_are_not_served(grasp: Content, name: str) -> None:
    async def act(client: Client) -> None:
        assert (await client.get(f"/{TOKEN}/{name}")).status in (403, 404)

    with_client(grasp, act)


def test_a_result_arrives_with_its_numbers_pictures_and_estimate(grasp: Content) -> None:
    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: {"scene", "frame", "shapes", "estimate"} <= page.last.keys())
        scene, frame = page.last["scene"], page.last["frame"]
        assert scene["title"] == TITLE
        assert len(scene["times"]) == 4
        np.testing.assert_allclose(frame["forces"], taxel_forces()[-1], rtol=1e-6)
        assert (frame["time"], frame["closing"], frame["step"]) == (1.0, 1.0, 3)
        assert frame["pictures"].max() >= 254, "the brightest place lies between the pixels"
        assert page.last["shapes"]["inclusions"][0]["name"] == "sphere 1"
        assert page.last["estimate"]["fault"] == ""
        assert page.last["estimate"]["errors"][0].startswith("Off by")
        await page.do("show", step=0)
        await page.until(lambda: page.last["frame"]["step"] == 0)
        np.testing.assert_allclose(page.last["frame"]["forces"], taxel_forces()[0], rtol=1e-6)
        assert page.last["frame"]["pictures"].max() < 100, "one scale for all steps"

    with_client(grasp, act)


def test_playing_begins_anew_at_the_end_and_stops_there(grasp: Content, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(selection, "SHORTEST", 1.0)

    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: "frame" in page.last)
        await page.do("play")
        times: list[float] = []
        while not times or page.last["frame"]["playing"]:
            before = page.frames
            await page.until(lambda: page.frames > before)  # noqa: B023
            times.append(page.last["frame"]["time"])
        assert times == sorted(times)
        assert (times[0] < 0.6, times[-1]) == (True, 1.0)
        assert len(times) > 4, "frames between the steps"

    with_client(grasp, act)


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("nonsense", "could not be read"),
        ("[]", "does not know"),
        ('{"do": "__init__"}', "does not know"),
        ('{"do": ["show"]}', "does not know"),
        ('{"do": "show"}', "could not be read"),
        ('{"do": "show", "step": "x"}', "could not be read"),
        ('{"do": "estimator", "name": "guess"}', "unknown estimator 'guess'"),
        ('{"do": "source", "name": "live"}', "unknown source of forces"),
        ('{"do": "sample", "number": 1}', "no samples"),
    ],
)
def test_a_bad_command_is_told_and_the_page_goes_on(grasp: Content, command: str, words: str) -> None:
    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.socket.send_str(command)
        await page.until(lambda: "fault" in page.last)
        assert words in page.last["fault"]["words"]
        await page.do("show", step=1)
        await page.until(lambda: page.last.get("frame", {}).get("step") == 1)

    with_client(grasp, act)


def test_samples_are_picked_by_number_and_filter(tmp_path: Path) -> None:
    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: "frame" in page.last)
        assert page.last["offer"]["samples"]["count"] == 6
        assert page.last["scene"]["sample"]["number"] == 0
        await page.do("sample", number=2)
        await page.until(lambda: page.last["scene"]["sample"]["number"] == 2)
        await page.until(lambda: abs(page.last["frame"]["forces"].max() / (1.2 * taxel_forces(1).max()) - 1) < 1e-6)
        await page.do("sample", number=4)
        await page.until(lambda: page.last["scene"]["sample"]["number"] == 4)
        split = page.last["scene"]["sample"]["state"]["split"]
        assert page.last["scene"]["notes"] == ["sample 4 is failed: ConvergenceError: residual <i>1</i>"]
        await page.do("sample", number=6)
        await page.until(lambda: "fault" in page.last)
        assert page.last["fault"]["words"] == "there is no sample 6; allowed: 0 to 5"
        await page.do("filter", status="done")
        await page.until(lambda: page.last["scene"]["sample"]["status"] == "done")
        assert (page.last["scene"]["sample"]["number"], page.last["scene"]["sample"]["chosen"]) == (3, 4)
        await page.do("sample", move=1)
        await page.until(lambda: page.last["scene"]["sample"]["number"] == 0)
        other = next(name for name in page.last["offer"]["samples"]["splits"] if name != split)
        await page.do("filter", split=other, status="failed")
        await page.until(lambda: "state" in page.last)
        assert page.last["state"]["selection_fault"] == "no sample has this split and status; choose others"

    with_client(opened_content(made_up_store(tmp_path)), act)


def test_a_slow_page_skips_frames_and_gets_the_latest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "MOST_WAITING", 1000.0)
    feed = Feed("test")
    stream = feed.stream()
    stream.take(line(description(title="<script>alert(1)</script>")))

    async def act(client: Client) -> None:
        page = await opened_page(client, draws=False)
        for k in range(400):
            stream.take(line(frame_line(float(k))))
            await asyncio.sleep(0.0005)
        with suppress(TimeoutError):
            async with asyncio.timeout(0.3):
                await page.until(lambda: page.frames > 2)
        assert page.frames == 2, "no more are sent than the page can draw"
        await page.do("drawn")
        await page.until(lambda: page.last["frame"]["time"] == 399.0)
        assert page.last["scene"]["title"] == "<script>alert(1)</script>"
        assert page.frames <= 4

    with_client(Content({}, feed=feed), act)


def test_a_dead_jaw_and_a_malformed_line_are_told_and_the_next_frame_is_drawn() -> None:
    feed = Feed("test")
    stream = feed.stream()
    stream.take(line(description()) + line({**frame_line(1.0), "taxel_force_upper": [[None] * 3] * 3}) + b"?\n")

    async def act(client: Client) -> None:
        page = await opened_page(client)
        await page.until(lambda: {"frame", "feed", "estimate"} <= page.last.keys())
        assert "no taxel of a jaw gives a number" in page.last["frame"]["notes"][0]
        assert page.last["frame"]["pictures"].max() == 0
        assert "all taxels of the upper jaw" in page.last["estimate"]["fault"]
        assert page.last["feed"]["malformed"] == 1
        assert page.last["feed"]["fault"].startswith("line 3: not JSON")
        stream.take(line(frame_line(2.0)))
        await page.until(lambda: page.last["frame"]["time"] == 2.0 and page.last["estimate"]["fault"] == "")
        assert page.last["frame"]["pictures"].max() == 255

    with_client(Content({}, feed=feed), act)


def test_a_taken_port_is_told(grasp: Content) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(StorageError, match=f"cannot serve on 127.0.0.1 port {port}"):
            serve(grasp, Serving(ready=lambda address: None, report=lambda line: None, port=port))


def test_nothing_to_show_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing to show"):
        opened_content(None)
    with pytest.raises(StorageError, match="holds no result"):
        opened_content(tmp_path)
    with pytest.raises(InputError, match="none of its 6 samples is done"):
        opened_content(made_up_store(tmp_path, done=0))
