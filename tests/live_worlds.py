"""Worlds as people write them, each with a mistake that can be named; and clients."""

from __future__ import annotations

import math
import socket
import struct
import subprocess
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from dse.live import ClientLine

MAGIC, START, END, BUSY, ANSWER = 0x44534531, 1, 2, 8, 16
STEP = 0.01

Write = Callable[[int, int, int, float, tuple[float, ...]], bytes]


def right_bytes(session: int, sequence: int, flags: int, time: float, values: tuple[float, ...]) -> bytes:
    return struct.pack(f"<4id{len(values)}di", MAGIC, session, sequence, flags, time, *values, sequence)


@dataclass
class World:
    """Asked for one value it answers two; every part of it can be wrong."""

    write: Write = right_bytes
    session_off: int = 0
    sequence_off: int = 0
    flags: Callable[[bool], int] = lambda is_start: ANSWER | (START if is_start else 0)
    time_off: float = 0.0
    is_strict: bool = True
    """Whether it passes over what is none of its session's."""
    repeats: str = "same"
    says_busy: bool = True
    ends: bool = True
    dies_at: int = -1
    answers_end: bool = False
    copies: int = 1
    """How often each answer goes over a socket."""
    heard: list[bytes] = field(default_factory=list)
    said: list[bytes] = field(default_factory=list)
    """What came and what went over a socket."""

    def serve(self, line: socket.socket) -> None:
        talk = self.conversation()
        while (data := line.recvfrom(65536)) and data[0] != b"stop":
            said = talk(data[0])
            self.heard.append(data[0])
            for _ in range(self.copies if said is not None else 0):
                self.said.append(said)
                line.sendto(said, data[1])

    def conversation(self) -> Callable[[bytes], bytes | None]:
        """What it says to one packet after another, from the beginning."""
        begun = self._conversation()
        next(begun)
        return begun.send

    def _conversation(self) -> Generator[bytes | None, bytes, None]:
        session, last, told, steps, over = 0, -1, b"", 0, set()
        said: bytes | None = None
        while True:
            packet, said = (yield said), None
            if self.is_strict and not self.is_right(packet):
                continue
            if len(packet) < 24:
                said = told
                continue
            its, sequence, flags, time = struct.unpack_from("<3id", packet, 4)
            if flags & END:
                if (its == session or not self.is_strict) and self.ends:
                    over.add(session)
                    session = 0
                if self.answers_end:
                    said = told
                continue
            is_start = bool(flags & START)
            if is_start and not session and its not in over:
                session, last = its, -1
            if is_start and its != session:
                if self.says_busy:
                    said = self.write(its, sequence, ANSWER | BUSY, time, (0.0, 0.0))
                continue
            if its != session and self.is_strict:
                continue
            if sequence == last + 1 or not self.is_strict or (sequence == last and self.repeats == "anew"):
                last, steps = sequence, steps + 1
                if sequence == self.dies_at:
                    continue
                told = self.write(
                    session + self.session_off,
                    sequence + self.sequence_off,
                    self.flags(is_start),
                    time + (0.0 if is_start else STEP + self.time_off),
                    (0.5, float(steps)),
                )
                said = told
            elif sequence == last and self.repeats == "same":
                said = told

    @staticmethod
    def is_right(packet: bytes) -> bool:
        if len(packet) != 36:
            return False
        magic, _, sequence, flags, time, value, closing = struct.unpack("<4i2di", packet)
        return magic == MAGIC and closing == sequence and not flags & ANSWER and math.isfinite(time + value)


class DirectLine(ClientLine):
    """A line to *world* without a socket: an answer comes *latency* s after its request, of a clock of its own."""

    def __init__(self, world: World, latency: float = 0.0) -> None:
        self.refused = False
        self._latency, self._clock = latency, 0.0
        self._answers_to = world.conversation()
        self._coming: deque[tuple[float, bytes]] = deque()

    def now(self) -> float:
        return self._clock

    def send(self, data: bytes) -> None:
        answer = self._answers_to(data)
        if answer is not None:
            self._coming.append((self._clock + self._latency, answer))

    def hear(self, patience: float) -> bytes | None:
        if not self._coming or self._coming[0][0] > self._clock + patience:
            self._clock += patience
            return None
        at, answer = self._coming.popleft()
        self._clock = max(self._clock, at)
        return answer


@contextmanager
def served(world: World) -> Iterator[int]:
    """Its port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.bind(("127.0.0.1", 0))
        port = line.getsockname()[1]
        thread = threading.Thread(target=world.serve, args=(line,), daemon=True)
        thread.start()
        try:
            yield port
        finally:
            line.sendto(b"stop", ("127.0.0.1", port))
            thread.join()


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.bind(("127.0.0.1", 0))
        return int(line.getsockname()[1])


@contextmanager
def running(command: list[str]) -> Iterator[None]:
    """A program that prints its address and runs until the end of the block."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as world:
        assert world.stdout
        assert any("a world at" in line for line in world.stdout)
        try:
            yield
        finally:
            world.kill()
