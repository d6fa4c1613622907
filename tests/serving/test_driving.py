"""The test drive over HTTP and WebSockets: a drive from its order to its report, and all that is refused."""

from __future__ import annotations

import json
import random
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from socket import create_connection

import pytest
from background import LIMIT
from small_drive import drive_workspace
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from dse.api import Drives, open as open_workspace
from dse.domain.drive import Drive
from dse.errors import fail
from dse.serving.application import application
from dse.serving.drives import LiveDrives
from dse.serving.driving import MOST_MISTAKES
from dse.serving.guard import Limits
from dse.serving.study_index import StudyIndex

TOKEN = "a-token-of-the-test"  # noqa: S105  # it is


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory):
    return open_workspace(drive_workspace(tmp_path_factory.mktemp("drives")))


@contextmanager
def drives_on(field, served, folder: Path, most: int = 2, **options):
    folder.mkdir(exist_ok=True)
    on = LiveDrives(field, Drives(folder, field.files), most)
    with on, served(application(StudyIndex(folder), drives=on, **options)) as client:
        yield client


@pytest.fixture
def client(field, served, tmp_path: Path) -> Iterator:
    with drives_on(field, served, tmp_path / "kept", limits=Limits(messages=1e6, rate=1000, burst=1000)) as found:
        yield found


def opened(client, **order: object) -> str:
    answer = client.post("/drive/start", {"bench": "field", "chosen": "", "driver": "Ada", **order})
    assert answer.status == 200, answer.text
    return json.loads(answer.text)["drive"]


def sits(client, drive: str, **options) -> ClientConnection:
    place = f"127.0.0.1:{client.port}"
    told = {"origin": f"http://{place}", "compression": None, **options}
    return connect(f"ws://{place}/drive/live?drive={drive}", **told)


def until(socket: ClientConnection, kind: str) -> dict:
    while True:
        told = socket.recv(timeout=LIMIT)
        if isinstance(told, str) and json.loads(told)["type"] == kind:
            return json.loads(told)


def frame(socket: ClientConnection) -> tuple[float, ...]:
    while isinstance(told := socket.recv(timeout=LIMIT), str):
        pass
    return struct.unpack(f"<{len(told) // 8}d", told)


@pytest.mark.thorough
def test_a_drive_from_its_start_to_its_report(client) -> None:
    with sits(client, opened(client)) as socket:
        scene = until(socket, "scene")
        assert scene["columns"][:4] == ["host.x", "host.y", "host.heading", "host.speed"]
        assert scene["start"]["cruise"] == 1.0
        assert [each["name"] for each in scene["tunables"]] == ["car.gain", "car.doomed"]
        assert len(frame(socket)) == 4 + len(scene["columns"])
        socket.send(json.dumps({"type": "control", "n": 3, "values": {"accelerator": 1.0}}))
        while frame(socket)[3] != 3.0:
            pass
        socket.send(json.dumps({"type": "finish"}))
        ended = until(socket, "ended")
    assert (ended["why"], ended["verdicts"][0]["verdict"]) == ("finished", "pass")
    link = result_of(client, ended["drive"])
    assert (link.status, link.headers["location"]) == (303, "/study/field/")
    assert "Ada" in client.get("/study/field/").text
    assert json.loads(client.get("/drive/boards").text)["boards"][0]["bench"] == "field"


def result_of(client, drive: str):
    while (link := client.get(f"/drive/results/{drive}")).status == 200:
        assert link.headers["refresh"] == "1"
        time.sleep(0.02)
    return link


def driven(client) -> str:
    with sits(client, opened(client)) as socket:
        while frame(socket)[0] < 0.05:
            pass
        socket.send(json.dumps({"type": "finish"}))
        return until(socket, "ended")["drive"]


@pytest.mark.thorough
def test_a_drive_that_could_not_be_kept_says_why_until_a_later_one_brings_it_along(field, served, tmp_path) -> None:
    class Full(Drives):
        is_full = True

        def add(self, drive: Drive, **options) -> str:
            if self.is_full:
                raise fail("the disk is full")
            return super().add(drive, **options)

    folder = tmp_path / "kept"
    folder.mkdir()
    kept = Full(folder, field.files)
    quick = Limits(rate=1000, burst=1000)
    with LiveDrives(field, kept, 2) as on, served(application(StudyIndex(folder), drives=on, limits=quick)) as client:
        first = driven(client)
        answer = result_of(client, first)
        assert (answer.status, json.loads(answer.text)["problems"][0]["what"]) == (409, "the disk is full")
        kept.is_full = False
        second = driven(client)
        assert [result_of(client, each).status for each in (second, first)] == [303, 303]
        found = json.loads(client.get("/drive/boards").text)["boards"][0]["scores"]
        assert {first, second} <= {score["drive"] for score in found}


@pytest.mark.thorough
def test_a_page_that_comes_back_finds_its_drive(client) -> None:
    drive = opened(client)
    with sits(client, drive) as socket:
        before = frame(socket)[0]
    with sits(client, drive) as socket:
        assert frame(socket)[0] >= before
        socket.send(json.dumps({"type": "finish"}))
        assert until(socket, "ended")["why"] == "finished"


@pytest.mark.thorough
def test_a_crash_is_told_by_name_and_the_server_goes_on(client) -> None:
    with sits(client, opened(client)) as socket:
        frame(socket)
        socket.send(json.dumps({"type": "tune", "n": 1, "values": {"car.doomed": 0}}))
        ended = until(socket, "ended")
    assert (ended["why"], ended["drive"]) == ("crashed", None)
    assert ended["text"].startswith("car: fmi2DoStep")
    assert opened(client)


@pytest.mark.thorough
def test_more_drives_than_there_may_be_are_refused_in_words(client) -> None:
    assert opened(client)
    assert opened(client)
    answer = client.post("/drive/start", {"bench": "field"})
    assert answer.status == 409
    assert "2 drives are already running" in answer.text


@pytest.mark.parametrize("bench", ["../field", "/etc/passwd", "field.yaml", "testbenches/field.yaml", "_x", ""])
def test_a_bench_is_taken_by_a_name_in_the_list_only(client, bench: str) -> None:
    answer = client.post("/drive/start", {"bench": bench})
    assert (answer.status, json.loads(answer.text)["problems"][0]["what"]) == (
        409,
        f"there is no test bench '{bench}' to drive",
    )
    assert client.get(f"/drive/offer?bench={bench}").status == 409


@pytest.mark.parametrize("order", [[], {}, {"bench": 1}, {"bench": "field", "driver": 3}, {"bench": "f" * 30_000}])
def test_what_is_no_order_is_refused(client, order: object) -> None:
    assert client.post("/drive/start", order).status == 409


@pytest.mark.parametrize("path", ["/drive/results/..%2F..%2Fsecret", "/drive/results/0123", "/drive/../../etc/passwd"])
def test_no_path_leads_out(client, path: str) -> None:
    assert client.get(path).status in (404, 409)


def test_a_drive_that_is_none_is_told_so(client) -> None:
    with sits(client, "nobody") as socket:
        assert "no such drive" in until(socket, "ended")["text"]


@pytest.mark.parametrize("origin", [None, "null", "http://evil.example", "https://127.0.0.1", "http://127.0.0.1:1"])
def test_a_page_of_another_place_gets_no_socket(client, origin: str | None) -> None:
    with pytest.raises(InvalidStatus) as refused:
        sits(client, "x", origin=origin)
    assert refused.value.response.status_code == 403


def test_a_stranger_s_name_for_us_gets_no_socket(client) -> None:
    place = f"evil.localtest:{client.port}"
    with create_connection(("127.0.0.1", client.port)) as line, pytest.raises(InvalidStatus) as refused:
        connect(f"ws://{place}/drive/live", sock=line, origin=f"http://{place}")
    assert refused.value.response.status_code == 421


def test_without_the_token_there_is_no_socket(field, served, tmp_path: Path) -> None:
    with drives_on(field, served, tmp_path / "kept", token=TOKEN) as client:
        with pytest.raises(InvalidStatus) as refused:
            sits(client, "x")
        assert refused.value.response.status_code == 401
        answer = client.get(f"/drive?token={TOKEN}")
        assert "url=/drive" in answer.text
        cookie = answer.headers["set-cookie"].partition(";")[0]
        with sits(client, "x", additional_headers={"Cookie": cookie}) as socket:
            assert "no such drive" in until(socket, "ended")["text"]


@pytest.mark.thorough
def test_too_many_sockets_are_refused(field, served, tmp_path: Path) -> None:
    with drives_on(field, served, tmp_path / "kept", limits=Limits(sockets=1)) as client:
        drive = opened(client)
        with sits(client, drive) as socket:
            frame(socket)
            with pytest.raises(InvalidStatus) as refused:
                sits(client, drive)
            assert refused.value.response.status_code == 503


@pytest.mark.thorough
def test_a_message_that_is_too_large_or_one_too_many_hangs_up(field, served, tmp_path: Path) -> None:
    with drives_on(field, served, tmp_path / "kept", limits=Limits(messages=5)) as client:
        drive = opened(client)
        with sits(client, drive) as socket:
            socket.send("x" * 5000)
            assert closing(socket) == 1009
        with sits(client, drive) as socket:
            with suppress(ConnectionClosed):
                for n in range(20):
                    socket.send(json.dumps({"type": "control", "n": n, "values": {}}))
            assert closing(socket) == 1008


def closing(socket: ClientConnection) -> int:
    for _ in range(2000):
        try:
            socket.recv(timeout=LIMIT)
        except ConnectionClosed:
            break
    return socket.close_code or 0


MISTAKES = [
    "", "{}", "[]", "nothing", "null", '{"type": "go"}', '{"type": "control"}', '{"type": "control", "values": []}',
    '{"type": "control", "n": -1, "values": {}}', '{"type": "control", "n": true, "values": {}}',
    '{"type": "control", "n": 1, "values": {"steering": NaN}}', '{"type": "tune", "n": 1, "values": {"car.gain": 1e9}}',
    '{"type": "control", "n": 1e400, "values": {}}', "[" * 3000, b"\x00\xff" * 10,
]  # fmt: skip


@pytest.mark.thorough
def test_who_is_not_understood_twenty_times_is_hung_up_on_and_has_changed_nothing(client) -> None:
    drive = opened(client)
    with sits(client, drive) as socket:
        frame(socket)
        for n in range(MOST_MISTAKES):
            socket.send(MISTAKES[n % len(MISTAKES)])
        assert closing(socket) == 1008
    with sits(client, drive) as socket:
        assert frame(socket)[3] == 0.0


@pytest.mark.thorough
def test_ten_thousand_messages_of_chance_change_nothing(client) -> None:
    chance, sent, drive = random.Random(19), 0, opened(client)  # noqa: S311  # can be repeated
    while sent < 10_000:
        with sits(client, drive) as socket:
            try:
                for _ in range(MOST_MISTAKES + 5):
                    socket.send(_of_chance(chance))
                    sent += 1
                closing(socket)
            except ConnectionClosed:
                pass
    with sits(client, drive) as socket:
        assert frame(socket)[3] == 0.0
        socket.send(json.dumps({"type": "finish"}))
        assert until(socket, "ended")["why"] == "finished"


def _of_chance(chance: random.Random) -> str | bytes:
    if chance.random() < 0.4:
        return chance.randbytes(chance.randrange(200))
    text = bytearray(chance.choice(MISTAKES[4:13]).encode())  # type: ignore[union-attr]
    for _ in range(chance.randrange(1, 4)):
        text[chance.randrange(len(text))] = chance.randrange(32, 127)
    told = text.decode()
    # By chance it may have become one that is understood.
    return "?" if '"finish"' in told or '"values": {}' in told else told
