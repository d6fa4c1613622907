"""Worlds as people write them, each with a mistake that can be named; and clients."""

from __future__ import annotations

import math
import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

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

    def serve(self, line: socket.socket) -> None:
        session, last, told, steps, over = 0, -1, b"", 0, set()
        while (data := line.recvfrom(65536)) and data[0] != b"stop":
            packet, sender = data
            if self.is_strict and not self.is_right(packet):
                continue
            if len(packet) < 24:
                line.sendto(told, sender)
                continue
            its, sequence, flags, time = struct.unpack_from("<3id", packet, 4)
            if flags & END:
                if (its == session or not self.is_strict) and self.ends:
                    over.add(session)
                    session = 0
                if self.answers_end:
                    line.sendto(told, sender)
                continue
            is_start = bool(flags & START)
            if is_start and not session and its not in over:
                session, last = its, -1
            if is_start and its != session:
                if self.says_busy:
                    line.sendto(self.write(its, sequence, ANSWER | BUSY, time, (0.0, 0.0)), sender)
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
                line.sendto(told, sender)
            elif sequence == last and self.repeats == "same":
                line.sendto(told, sender)

    @staticmethod
    def is_right(packet: bytes) -> bool:
        if len(packet) != 36:
            return False
        magic, _, sequence, flags, time, value, closing = struct.unpack("<4i2di", packet)
        return magic == MAGIC and closing == sequence and not flags & ANSWER and math.isfinite(time + value)


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
