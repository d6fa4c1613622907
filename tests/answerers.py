"""The other side of a component of the kind udp, in Python: by docs/udp.md, slow and simple."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Callable, Sequence
from types import TracebackType

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


Answer = Callable[[float, float, tuple[float, ...]], Sequence[float]]
"""The values at a time, after a step (0 at the start) and with what was asked."""


class Answerer:
    """Answers in lockstep, one session after another, in a thread. *step* is the client's, *ends_at* an answer's number.

    Every datagram that came is in *heard*.
    """

    def __init__(self, answer: Answer, step: float = 0.01, ends_at: int = -1) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        self.heard: list[bytes] = []
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
        session, told, over = 0, b"", set[int]()
        while True:
            data, sender = self.socket.recvfrom(65536)
            if not data:
                return
            self.heard.append(data)
            asked, sequence, flags, time, values = unpacked(data)
            if asked in over:
                continue
            if flags & END:
                over.add(asked)
                session = 0 if asked == session else session
            elif flags & START and session not in (0, asked):
                self.socket.sendto(packed(asked, sequence, ANSWER | BUSY, time, [0.0] * len(told)), sender)
            else:
                if flags & START and not session:
                    session, last = asked, -1
                if asked == session and sequence == last + 1:
                    last, h = sequence, self._step * (sequence > 0)
                    kind = END if sequence == self._ends_at else START if not sequence else 0
                    told = packed(session, sequence, ANSWER | kind, time + h, self._answer(time + h, h, values))
                if asked == session and sequence == last:
                    self.socket.sendto(told, sender)
