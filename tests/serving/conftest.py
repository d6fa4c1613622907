"""Two stored studies, and a server of them on loopback."""

from __future__ import annotations

import http.client
import json
import math
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from served_studies import store_study

from dse.serving.application import application
from dse.serving.guard import Application, Limits
from dse.serving.server import server_of
from dse.serving.study_index import StudyIndex


@pytest.fixture
def workshop(tmp_path: Path) -> Path:
    """A folder with two studies that differ in one verdict, a damaged one, and what is none."""
    root = tmp_path / "work"
    store_study(root / "out" / "first", [0.5, 1.5, math.nan])
    store_study(root / "out" / "second", [0.5, 0.75, math.nan])
    (root / "out" / "torn").mkdir()
    (root / "out" / "torn" / "study.sqlite").write_bytes(b"no database")
    (root / "secret.txt").write_text("secret", encoding="utf-8")
    return root


@dataclass(frozen=True)
class Answer:
    status: int
    headers: dict[str, str]
    text: str


@dataclass(frozen=True)
class Client:
    """Asks the server at *port* as a browser would; *cookie* goes along."""

    port: int
    cookie: str = ""
    headers: dict[str, str] = field(default_factory=dict)

    def ask(self, method: str, path: str, body: bytes | None = None, **headers: str) -> Answer:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        told = {"Host": f"127.0.0.1:{self.port}", **({"Cookie": self.cookie} if self.cookie else {})}
        told |= {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, body, {name: value for name, value in told.items() if value})
        answer = connection.getresponse()
        found = Answer(
            answer.status, {k.lower(): v for k, v in answer.getheaders()}, answer.read().decode("utf-8", "replace")
        )
        connection.close()
        return found

    def get(self, path: str, **headers: str) -> Answer:
        return self.ask("GET", path, **headers)

    def post(self, path: str, data: object = None, **headers: str) -> Answer:
        ours = {"Origin": f"http://127.0.0.1:{self.port}", "Content_Type": "application/json"}
        return self.ask("POST", path, json.dumps(data).encode(), **{**ours, **headers})


@contextmanager
def serving(guarded: Application, limits: Limits | None = None) -> Iterator[Client]:
    server = server_of(guarded, limits or Limits())
    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield Client(listener.getsockname()[1])
        finally:
            server.should_exit = True
            thread.join()


@pytest.fixture
def served() -> Callable[..., object]:
    return serving


@pytest.fixture
def client(workshop: Path) -> Iterator[Client]:
    """A server of the workshop, without a token."""
    with serving(application(StudyIndex(workshop))) as found:
        yield found
