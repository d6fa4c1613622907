"""A shared world over HTTP and WebSockets: seats, watchers, and clients that want to disturb the others."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
from background import LIMIT
from chromium import started_chromium
from shared_field import shared_workspace
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from dse.api import Drives, open as open_workspace
from dse.domain.drive import Drive
from dse.serving.application import application
from dse.serving.drives import LiveDrives
from dse.serving.guard import Limits
from dse.serving.shared_drives import SharedDrives
from dse.serving.study_index import StudyIndex

MARKUP = '<img src="x" onerror="document.title=1">'


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory):
    return open_workspace(shared_workspace(tmp_path_factory.mktemp("shared"), "300 s"))


@contextmanager
def world_on(field, served, folder: Path, **options) -> Iterator:
    folder.mkdir()
    shared = SharedDrives(field.benches["field"].noun, 3, grace=LIMIT, **options)
    on = LiveDrives(field, Drives(folder, field.files), 3, shared)
    limits = Limits(rate=1000, burst=1000, sockets=40)
    with on, served(application(StudyIndex(folder), drives=on, limits=limits)) as client:
        yield client


@pytest.fixture
def client(field, served, tmp_path: Path) -> Iterator:
    with world_on(field, served, tmp_path / "kept") as found:
        yield found


def browser_of(client) -> dict[str, str]:
    """What another browser sends along."""
    return {"Cookie": client.get("/drive/world").headers["set-cookie"].partition(";")[0]}


def taken(client, driver: str, **browser: str) -> str:
    order = {"bench": "field", "driver": driver}
    answer = client.post("/drive/start", order, **(browser or browser_of(client)))
    assert answer.status == 200, answer.text
    return json.loads(answer.text)["drive"]


def sits(client, query: str) -> ClientConnection:
    place = f"127.0.0.1:{client.port}"
    return connect(f"ws://{place}/drive/live?{query}", origin=f"http://{place}", compression=None)


def until(socket: ClientConnection, kind: str) -> dict:
    while True:
        told = socket.recv(timeout=LIMIT)
        if isinstance(told, str) and json.loads(told)["type"] == kind:
            return json.loads(told)


def frame(socket: ClientConnection) -> tuple[float, ...]:
    while isinstance(told := socket.recv(timeout=LIMIT), str):
        pass
    return struct.unpack(f"<{len(told) // 8}d", told)


def goes_on(socket: ClientConnection) -> bool:
    before = frame(socket)[0]
    while frame(socket)[0] < before + 0.1:
        pass
    return True


@pytest.mark.thorough
def test_seats_are_listed_and_watched_and_a_watcher_changes_nothing(client) -> None:
    world = json.loads(client.get("/drive/world").text)
    assert (world["seats"], world["note"].partition(":")[0]) == ([], "without the traffic of the bench (flow)")
    with sits(client, f"drive={taken(client, 'Ada')}") as ada, sits(client, f"drive={taken(client, MARKUP)}") as bea:
        assert [until(each, "scene")["seat"] for each in (ada, bea)] == [1, 2]
        assert goes_on(ada)
        assert goes_on(bea)
        seats = json.loads(client.get("/drive/world").text)["seats"]
        assert [(each["number"], each["driver"]) for each in seats] == [(1, "Ada"), (2, MARKUP)]
        with sits(client, "watch=1") as watcher:
            scene = until(watcher, "scene")
            assert (scene["watched"], "token" in scene) == ("Ada", False)
            for said in ('{"type": "finish"}', '{"type": "control", "n": 9, "values": {"brake": 1}}', "", "[" * 999):
                watcher.send(said)
            assert goes_on(watcher)
        assert frame(ada)[3] == 0.0
        ada.send('{"type": "finish"}')
        assert until(ada, "ended")["why"] == "finished"
        while len(until(bea, "world")["seats"]) > 1:
            pass
        assert goes_on(bea)
        for gone in ("1", "99", "", "../1"):
            with sits(client, f"watch={gone}") as watcher:
                assert until(watcher, "ended")["text"] == "this seat has no driver"


@pytest.mark.thorough
def test_a_browser_has_one_seat_and_leaves_it_for_another_one_when_its_page_is_gone(client) -> None:
    bea = browser_of(client)
    with sits(client, f"drive={taken(client, 'Bea', **bea)}") as first:
        until(first, "scene")
        answer = client.post("/drive/start", {"bench": "field", "driver": "Bea again"}, **bea)
        assert (answer.status, "already has a seat" in answer.text) == (409, True)
        assert goes_on(first)
        nameless = [client.post("/drive/start", {"bench": "field", "driver": "x"}) for _ in range(2)]
        assert [each.status for each in nameless] == [200, 200]  # the second closes what the first never began
    second = taken(client, "Bea again", **bea)
    with sits(client, f"drive={second}") as back:
        until(back, "scene")
        assert goes_on(back)
        seats = json.loads(client.get("/drive/world").text)["seats"]
        assert [each["driver"] for each in seats if each["time"] is not None] == ["Bea again"]


@pytest.mark.thorough
def test_a_client_that_floods_or_sends_no_messages_or_reads_nothing_stops_nobody(client) -> None:
    with sits(client, f"drive={taken(client, 'Ada')}") as ada:
        token = taken(client, "Mallory")
        for sent in (["{}"] * 400, ["x" * 5000], [b"\xff" * 100] * 30, ['{"type": "control", "n": 1e999}'] * 30):
            with sits(client, f"drive={token}") as mallory:
                with suppress(ConnectionClosed):
                    for text in sent:
                        mallory.send(text)
                    while True:
                        mallory.recv(timeout=LIMIT)
                assert mallory.close_code in (1007, 1008, 1009)
            assert goes_on(ada)
        with sits(client, f"drive={token}"):  # takes nothing of what it is sent
            assert goes_on(ada)
        seats = json.loads(client.get("/drive/world").text)["seats"]
        assert [each["stopped"] for each in seats] == [False, False]
        answer = client.post("/drive/start", {"bench": "drive_following"})
        assert answer.status == 409


@pytest.mark.thorough
def test_simulated_drivers_begin_with_the_first_person_and_leave_with_the_last(field, served, tmp_path: Path) -> None:
    script = tmp_path / "brakes.csv"
    script.write_text("time,brake\n0,1\n", "utf-8")
    with world_on(field, served, tmp_path / "kept", simulated=1, scripts=[script]) as client:
        assert json.loads(client.get("/drive/world").text)["seats"] == []
        with sits(client, f"drive={taken(client, 'Ada')}") as ada:
            while len(seats := until(ada, "world")["seats"]) < 3 or any(each["speed"] is None for each in seats):
                pass
            assert {each["driver"]: each["simulated"] for each in seats} == {
                "Ada": False,
                "simulated 1": True,
                "script brakes": True,
            }
            ada.send('{"type": "finish"}')
            until(ada, "ended")
        while json.loads(client.get("/drive/world").text)["seats"]:
            pass


@pytest.mark.browser
@pytest.mark.thorough
def test_two_browsers_see_each_other_brake_one_leaves_and_the_other_can_be_repeated(
    field, served, tmp_path: Path
) -> None:
    folder = tmp_path / "kept"
    with world_on(field, served, folder) as client, started_chromium() as browser:
        pages = [browser.new_page(viewport={"width": 900, "height": 520}) for _ in range(3)]
        problems: list[str] = []
        for page, name in zip(pages, (MARKUP, "Bea", ""), strict=True):
            page.set_default_timeout(1000 * LIMIT)
            page.on("pageerror", lambda error: problems.append(str(error)))
            page.goto(f"http://127.0.0.1:{client.port}/drive")
            if not name:
                continue
            page.fill("#driver", name)
            page.click("button.go:not([disabled])")
            page.wait_for_function("() => document.documentElement.dataset.frames > 2")
        ada, bea, watcher = pages
        for page in (ada, bea):
            page.wait_for_function("() => document.querySelectorAll('.roster li').length === 2")
        assert MARKUP in bea.text_content(".roster")
        watcher.click("[data-seat='1']:not([disabled])")
        watcher.wait_for_function("() => document.documentElement.dataset.frames > 2")
        assert "(watched)" in watcher.text_content(".roster .me")
        watcher.screenshot(path=str(tmp_path / "watcher.png"))
        for page in pages:
            assert page.evaluate("() => [document.querySelectorAll('img').length, document.title]") == [0, "Test drive"]
        for page in (ada, bea):  # one after the other: each sees the other one
            page.bring_to_front()
            page.keyboard.down("Space")
            page.wait_for_function("() => Number(document.querySelector('.digits b').textContent) < 30")
            page.keyboard.up("Space")
        bea.bring_to_front()
        ada.bring_to_front()
        ada.keyboard.press("End")
        ada.wait_for_selector(".verdicts .badge")
        bea.wait_for_function("() => document.querySelectorAll('.roster li').length === 1")
        bea.bring_to_front()
        bea.keyboard.press("End")
        bea.wait_for_selector(".verdicts .badge")
        assert problems == []
    kept = Drives(folder, field.files)
    drives = {drive.driver: drive for drive in kept.recorded().values()}
    assert 0 <= delay(kept, drives[MARKUP], drives["Bea"]) <= 0.1
    checked = list(kept.check())
    assert [(each.is_same, each.was_noted) for each in checked] == [(True, True)] * 2, checked
    (board,) = kept.boards()
    assert {score.driver for score in board.scores} == {MARKUP, "Bea"}


def delay(kept: Drives, ada: Drive, bea: Drive) -> float:
    """Simulated seconds from the step in which Ada's brake is pressed to that in which Bea's scene has her slower."""
    from dse.storage import drive_id

    runs = [kept.run(drive_id(drive)).noun.waveforms for drive in (ada, bea)]
    began = int(np.flatnonzero(ada.inputs["brake"] > 0)[0])
    scene = runs[1].values["road.actors[1].speed"]
    slower = int(np.flatnonzero((scene > 0) & (scene < 9.99))[0])
    # Until then Ada drives at 10 m/s: the same moment is where she is at the same place in both.
    same = int(np.flatnonzero(bea.inputs["other1.station"] > runs[0].values["car.motion.x"][began] + 0.05 - 1e-6)[0])
    return float(bea.time[slower] - bea.time[same])
