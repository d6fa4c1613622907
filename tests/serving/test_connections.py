"""Many at once: silent connections, slow ones, a class behind one address, and more drives than there were places."""

from __future__ import annotations

import asyncio
import json
import socket
import threading
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from background import LIMIT
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from dse.serving.application import application
from dse.serving.connections import Waiting
from dse.serving.drives import LiveDrives
from dse.serving.guard import Guard, Limits
from dse.serving.study_index import StudyIndex

HALF_A_HEAD = b"GET / HTTP/1.1\r\nHost: localhost\r\nX-Slow: "
HALF_A_BODY = (
    b"POST /stop?study=a HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nContent-Type: application/json\r\n"
    b"Content-Length: 9\r\n\r\n{"
)


class Drives:
    """As many drives as there are pages, which see no frame and end when they are told to."""

    def __init__(self, most: int) -> None:
        self.most = most
        self.ended: dict[str, Any] = {"type": "ended"}

    def enter(self, token: str) -> Any:
        live = SimpleNamespace(ended=None, scene=dict, frame=token.encode)
        live.finish = lambda: setattr(live, "ended", self.ended)
        return SimpleNamespace(token=token, live=live)

    def leave(self, held: Any) -> None:
        held.live.finish()

    def told(self, _: Any) -> Any:
        return self.ended

    shared = None
    boards = list
    __enter__ = __exit__ = lambda *_: None


def page_of(drive: str, client) -> Any:
    place = f"127.0.0.1:{client.port}"
    headers = {"Cookie": client.cookie} if client.cookie else {}
    where = f"ws://{place}/drive/live?drive={drive}"
    return connect(where, origin=f"http://{place}", compression=None, additional_headers=headers, open_timeout=LIMIT)


def fresh(client) -> Any:
    """Another browser at the same address, with the cookie that its first page has brought."""
    answer = client.get("/")
    assert answer.status == 200
    return type(client)(client.port, answer.headers["set-cookie"].partition(";")[0])


@pytest.mark.parametrize("begun", [b"", HALF_A_HEAD, HALF_A_BODY], ids=["silent", "half a head", "half a body"])
def test_held_connections_lock_nobody_out(tmp_path: Path, served, begun: bytes) -> None:
    with served(application(StudyIndex(tmp_path))) as client, ExitStack() as held:
        for _ in range(100):
            line = held.enter_context(socket.create_connection(("127.0.0.1", client.port)))
            line.sendall(begun)
        assert client.get("/").status == 200


def test_of_too_many_held_connections_the_oldest_are_closed(tmp_path: Path, served) -> None:
    with served(application(StudyIndex(tmp_path)), Limits(waiting=4)) as client, ExitStack() as held:
        lines = [
            held.enter_context(socket.create_connection(("127.0.0.1", client.port), timeout=LIMIT)) for _ in range(7)
        ]
        for line in lines[:3]:
            assert ends(line)
        assert client.get("/").status == 200
        lines[-1].sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert lines[-1].recv(100).split()[1] == b"200"


def ends(line: socket.socket) -> bool:
    """Whether the other side closes it, at last."""
    with suppress(ConnectionError):
        return line.recv(100) == b""
    return True


@pytest.mark.parametrize("begun", [b"", HALF_A_HEAD, b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n" + HALF_A_HEAD])
def test_a_head_that_never_ends_is_not_waited_for(tmp_path: Path, served, begun: bytes) -> None:
    with (
        served(application(StudyIndex(tmp_path)), Limits(seconds=0.3)) as client,
        socket.create_connection(("127.0.0.1", client.port), timeout=LIMIT) as line,
    ):
        line.sendall(begun)
        with suppress(ConnectionError):
            while line.recv(1 << 16):
                pass


def test_an_open_socket_and_a_long_answer_outlast_the_deadline_of_heads(tmp_path: Path, served) -> None:
    async def slow(scope: Any, _: Any, send: Any) -> None:
        await asyncio.sleep(0.5)
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": scope["path"].encode()})

    with served(Guard(slow), Limits(seconds=0.1)) as client:
        assert client.get("/slow").text == "/slow"
    on = cast(LiveDrives, Drives(1))
    with (
        served(application(StudyIndex(tmp_path), drives=on), Limits(seconds=0.1)) as client,
        page_of("a", client) as page,
    ):
        threading.Event().wait(0.5)
        page.send('{"type": "finish"}')
        assert json.loads([*page][-1])["type"] == "ended"


def test_a_page_is_hung_up_on_if_its_drive_cannot_be_shown(tmp_path: Path, served) -> None:
    class Broken(Drives):
        def enter(self, token: str) -> Any:
            held = super().enter(token)
            held.live.scene = {}.popitem
            return held

    on = cast(LiveDrives, Broken(1))
    with served(application(StudyIndex(tmp_path), drives=on)) as client, page_of("a", client) as page:
        with pytest.raises(ConnectionClosed):
            page.recv(timeout=LIMIT)
        assert page.close_code == 1011


class Line(SimpleNamespace):
    """A connection from an address."""

    def __hash__(self) -> int:
        return id(self)


def test_the_address_with_the_most_connections_loses_one() -> None:
    closed: list[str] = []

    def line(address: str, name: str) -> Any:
        return Line(client=(address, 1), transport=SimpleNamespace(abort=lambda: closed.append(name)))

    waiting = Waiting(3)
    first, *others = line("good", "g"), line("bad", "b1"), line("bad", "b2"), line("bad", "b3")
    for each in (first, *others):
        waiting.add(each)
    assert closed == ["b1"]
    waiting.add(first)
    waiting.remove(first)
    waiting.remove(first)
    assert (waiting.count, [*waiting.by_address]) == (2, ["bad"])


def test_sessions_at_one_address_have_an_allowance_each(tmp_path: Path, served) -> None:
    with served(application(StudyIndex(tmp_path), limits=Limits(burst=5, rate=1e-9, crowd=4))) as client:
        one, other = fresh(client), fresh(client)
        assert one.cookie != other.cookie
        assert [one.get("/nothing").status for _ in range(6)] == [404] * 5 + [429]
        assert [other.get("/nothing").status for _ in range(5)] == [404] * 5
        assert [client.get("/nothing").status for _ in range(4)] == [404] * 3 + [429]  # two were for the cookies
        forged = type(client)(client.port, one.cookie[:-1] + ("0" if one.cookie[-1] != "0" else "1"))
        assert forged.get("/nothing").status == 429


def test_all_sessions_of_an_address_together_have_an_allowance(tmp_path: Path, served) -> None:
    with served(application(StudyIndex(tmp_path), limits=Limits(burst=3, rate=1e-9, crowd=2))) as client:
        one, other = fresh(client), fresh(client)
        assert [one.get("/nothing").status for _ in range(3)] == [404] * 3
        assert [other.get("/nothing").status for _ in range(2)] == [404, 429]


def test_a_full_server_says_so_in_words_and_others_still_have_the_other_half(served) -> None:
    here, go_on = threading.Semaphore(0), threading.Event()

    async def slow(_: Any, __: Any, send: Any) -> None:
        here.release()
        while not go_on.is_set():
            await asyncio.sleep(0.01)
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"done"})

    with served(Guard(slow, limits=Limits(requests=4))) as client, ThreadPoolExecutor(8) as pool:
        anonymous = [pool.submit(client.get, "/") for _ in range(2)]
        for _ in anonymous:
            assert here.acquire(timeout=LIMIT)
        full = client.get("/")
        go_on.set()
        browsers = [
            type(client)(client.port, each.result().headers["set-cookie"].partition(";")[0]) for each in anonymous
        ]
        go_on.clear()
        others = [pool.submit(browsers[0].get, "/") for _ in range(2)] + [pool.submit(browsers[1].get, "/")]
        for _ in others:
            assert here.acquire(timeout=LIMIT)
        assert browsers[0].get("/").status == 503
        last = pool.submit(client.get, "/")
        assert here.acquire(timeout=LIMIT)
        assert browsers[1].get("/").status == 503
        go_on.set()
        assert [each.result().status for each in (*others, last)] == [200] * 4
    assert full.status == 503
    assert "<h1>The server is busy</h1>" in full.text
    assert full.headers["retry-after"] == "5"
    assert "frame-ancestors 'none'" in full.headers["content-security-policy"]


def test_fifty_clients_and_sixteen_drives_at_once(tmp_path: Path, served) -> None:
    on = cast(LiveDrives, Drives(16))
    statuses: defaultdict[int, int] = defaultdict(int)
    with served(application(StudyIndex(tmp_path), drives=on)) as client, ExitStack() as open_pages:
        pages = [open_pages.enter_context(page_of(f"d{number}", client)) for number in range(16)]

        def look(_: int) -> list[int]:
            browser = fresh(client)
            return [browser.get(path).status for path in ("/", "/drive/boards", "/nothing", "/") * 3]

        with ThreadPoolExecutor(50) as pool:
            for found in pool.map(look, range(50)):
                for status in found:
                    statuses[status] += 1
        for page in pages:
            page.send('{"type": "finish"}')
        assert [json.loads([*page][-1])["type"] for page in pages] == ["ended"] * 16
    assert statuses == {200: 450, 404: 150}


def test_there_are_as_many_sockets_as_the_drives_need(tmp_path: Path, served) -> None:
    with served(application(StudyIndex(tmp_path), drives=cast(LiveDrives, Drives(64)))) as client, ExitStack() as pages:
        for number in range(64 + 8):
            pages.enter_context(page_of(f"d{number}", client))
        with pytest.raises(InvalidStatus) as refused:
            page_of("more", client)
        assert refused.value.response.status_code == 503
        assert pages.enter_context(page_of("another", fresh(client)))


def test_bytes_that_are_no_text_leave_no_traceback(tmp_path: Path, served, caplog) -> None:
    on = cast(LiveDrives, Drives(1))
    with served(application(StudyIndex(tmp_path), drives=on)) as client:
        with page_of("a", client) as page:
            page.send(b"\xff\xfe", text=True)
            with suppress(ConnectionClosed):
                while True:
                    page.recv(timeout=LIMIT)
            assert page.close_code == 1007
        assert client.get("/").status == 200
    assert [record.exc_info for record in caplog.records if record.exc_info] == []
