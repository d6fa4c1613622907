"""The other side of a component of the kind udp, in Python: by docs/udp.md, slow and simple."""

from __future__ import annotations

import contextlib
import random
import select
import socket
import struct
import threading
from collections.abc import Callable, Sequence
from functools import partial
from time import monotonic, sleep
from types import TracebackType
from typing import Any

from background import LIMIT

START, END, LATE, BUSY, ANSWER = 1, 2, 4, 8, 16
MAGIC = 0x44534531


def packed(session: int, sequence: int, flags: int, time: float, values: Sequence[float]) -> bytes:
    head = struct.pack("<4id", MAGIC, session, sequence, flags, time)
    return head + struct.pack(f"<{len(values)}di", *values, sequence)


def unpacked(data: bytes) -> tuple[int, int, int, float, tuple[float, ...]]:
    """Session, sequence, flags, time, values of a packet in good order."""
    magic, session, sequence, flags, time = struct.unpack_from("<4id", data)
    *values, again = struct.unpack_from(f"<{(len(data) - 28) // 8}di", data, 24)
    assert (magic, again) == (MAGIC, sequence)
    return session, sequence, flags, time, tuple(values)


def bound_socket(port: int = 0) -> socket.socket:
    """A socket at *port*, or at a free one."""
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        opened.bind(("127.0.0.1", port))
    except BaseException:
        opened.close()
        raise
    return opened


Answer = Callable[[float, float, tuple[float, ...]], Sequence[float]]
"""The values at a time, after a step (0 at the start) and with what was asked."""


class Answerer:
    """Answers in lockstep, one session after another, in a thread; *step* is the client's. Answer *ends_at* ends it.

    Every datagram that came is in *heard*, who sent it in *senders*.
    """

    def __init__(self, answer: Answer, step: float = 0.01, ends_at: int = -1, port: int = 0) -> None:
        self.socket = bound_socket(port)
        self.port = self.socket.getsockname()[1]
        self.heard: list[bytes] = []
        self.senders: list[tuple[str, int]] = []
        self._answer, self._step, self._ends_at = answer, step, ends_at
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def __enter__(self) -> Answerer:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.socket.sendto(b"", ("127.0.0.1", self.port))
        self._thread.join()
        self.socket.close()

    def _serve(self) -> None:
        session, last, told, over = 0, -1, b"", set[int]()
        while True:
            data, sender = self.socket.recvfrom(65536)
            if not data:
                return
            self.heard.append(data)
            self.senders.append(sender)
            asked, sequence, flags, time, values = unpacked(data)
            if asked in over:
                continue
            if flags & END:
                over.add(asked)
                session = 0 if asked == session else session
            elif flags & START and session not in (0, asked):
                busy = [0.0] * ((len(told) - 28) // 8)
                self.socket.sendto(packed(asked, sequence, ANSWER | BUSY, time, busy), sender)
            else:
                if flags & START and not session:
                    session, last = asked, -1
                if asked == session and sequence == last + 1:
                    last, h = sequence, self._step * (sequence > 0)
                    kind = END if sequence == self._ends_at else START if not sequence else 0
                    told = packed(session, sequence, ANSWER | kind, time + h, self._answer(time + h, h, values))
                if asked == session and sequence == last:
                    self.socket.sendto(told, sender)


class Asker:
    """A client in lockstep, which sends a request again until it is answered."""

    def __init__(self, port: int, session: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.settimeout(0.05)
        self.session = session

    def __enter__(self) -> Asker:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.socket.close()

    def ask(
        self, sequence: int, values: Sequence[float], flags: int = 0, time: float = 0.0
    ) -> tuple[int, float, tuple[float, ...]]:
        """Flags, time and values of the answer."""
        until = monotonic() + LIMIT
        while monotonic() < until:
            try:
                self.socket.send(packed(self.session, sequence, flags, time, values))
                session, answered, told, at, found = unpacked(self.socket.recv(65536))
            except TimeoutError:
                continue
            except ConnectionRefusedError:
                sleep(0.05)
                continue
            if (session, answered) == (self.session, sequence):
                return told, at, found
        raise AssertionError("nobody answers")

    def end(self, sequence: int, count: int) -> None:
        self.socket.send(packed(self.session, sequence, END, 0.0, [0.0] * count))


class Proxy:
    """Between a client and a server at *port*: by a seed it loses, doubles and delays one in 20 packets each."""

    def __init__(self, port: int, seed: int) -> None:
        self.front, self.back = bound_socket(), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.back.connect(("127.0.0.1", port))
        self.port = self.front.getsockname()[1]
        self.lost = self.doubled = self.delayed = 0
        self._random = random.Random(seed)  # noqa: S311  # no secret
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._carry, daemon=True)

    def __enter__(self) -> Proxy:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._stop.set()
        self._thread.join()
        self.front.close()
        self.back.close()

    def _to(self, client: Any, packet: bytes) -> int:
        return self.front.sendto(packet, client)

    def _carry(self) -> None:
        client: Any = None
        late: dict[socket.socket, bytes] = {}
        while not self._stop.is_set():
            ready, _, _ = select.select([self.front, self.back], [], [], 0.02)
            for end in ready:
                try:
                    data, sender = end.recvfrom(65536, socket.MSG_DONTWAIT)
                except (ConnectionRefusedError, BlockingIOError):  # what was ready may have been told to a send
                    continue
                if end is self.front:
                    client = sender
                chance = self._random.random()
                send = self.back.send if end is self.front else partial(self._to, client)
                with contextlib.suppress(ConnectionRefusedError):
                    if chance < 0.05:
                        self.lost += 1
                        continue
                    if chance < 0.1 and end not in late:
                        self.delayed += 1
                        late[end] = data
                        continue
                    send(data)
                    if chance < 0.15:
                        self.doubled += 1
                        send(data)
                    if end in late:
                        send(late.pop(end))
