"""The world's side against a client that somebody wrote: does it ask as `dse docs udp` wants, and mend what is lost?"""

from __future__ import annotations

import select
import socket
import struct
import time
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from dse.live.checks import Checked, Findings, Latencies
from dse.live.client import trial_values
from dse.live.packet import Flag, Packet, pack, unpack
from dse.live.packet_mistakes import explain

STARTS, BYTES, FLAGS, COUNTS = "sends START", "bytes of its packets", "flags", "sequence counts"
TIME, RESENDS, SAME, ENDS = "time advances", "repeats unanswered requests", "repeats the same bytes", "sends END"
NAMES = (STARTS, BYTES, FLAGS, COUNTS, TIME, RESENDS, SAME, ENDS)
_EVERY = 10
"""Of so many requests the first try of one is left without an answer, and before that of another comes rubbish."""
_LARGEST_DATAGRAM = 65_536


@dataclass(slots=True)
class _World:
    line: socket.socket
    out: int
    back: int
    step: float
    wholes: frozenset[int]
    findings: Findings = field(default_factory=lambda: Findings(NAMES))
    session: int = 0
    sender: Any = None
    last: bytes = b""
    request: bytes = b""
    sequence: int = -1
    time: float = 0.0
    has_ended: bool = False
    is_withheld: bool = False
    """The newest request was left without an answer, to see whether it comes again."""
    ignored: Counter[str] = field(default_factory=Counter)
    steps: int = 0

    def take(self, data: bytes, sender: object) -> None:
        """One datagram that came."""
        said = explain(data, self.out)
        if said:
            self.ignored[said] += 1
            self.findings.wrong(BYTES, said, max(self.sequence, 0))
            return
        packet = unpack(data, self.out)
        if not self.session and packet.flags & Flag.START and packet.sequence == 0:
            self.session, self.sender = packet.session, sender
            self.findings.right(STARTS)
            self._next(packet, data)
        elif packet.session != self.session or sender != self.sender:
            self._foreign(packet, sender)
        elif packet.flags & Flag.END and self.sequence == 0:
            self.session, self.sequence = 0, -1  # the initialization goes on with other values, in another session
        elif packet.flags & Flag.END:
            self.has_ended = True
            self.findings.right(ENDS)
        elif packet.sequence == self.sequence:
            self._again(data)
        elif packet.sequence == self.sequence + 1:
            self._next(packet, data)
        else:
            said = f"{packet.sequence - self.sequence:+d} after the last one: each request has the next sequence"
            self.findings.wrong(COUNTS, said, packet.sequence)

    def _foreign(self, packet: Packet, sender: object) -> None:
        self.ignored["of another session"] += 1
        if self.session and packet.flags & Flag.START:
            busy = Packet(packet.session, packet.sequence, Flag.ANSWER | Flag.BUSY, 0.0, (0.0,) * self.back)
            self._send(pack(busy), sender)
        elif not self.session and not packet.flags & Flag.END:
            self.findings.wrong(STARTS, "a request arrived before any START", packet.sequence)

    def _next(self, packet: Packet, data: bytes) -> None:
        is_start = packet.sequence == 0
        self.findings.right(BYTES)
        self.findings.right(COUNTS)
        self.findings.judge(FLAGS, _flags(packet, is_start=is_start), packet.sequence)
        if self.is_withheld:
            self.findings.wrong(
                RESENDS, "the next request arrived although the last one was not answered", packet.sequence
            )
            self.is_withheld = False
        # The first step begins where START stood; each other one goes on.
        said = (
            ""
            if packet.sequence < 2 or packet.time > self.time
            else "the time of a request is not later than that of the one before"
        )
        self.findings.judge(TIME, said, packet.sequence)
        self.sequence, self.time, self.request = packet.sequence, packet.time, data
        flags = Flag.ANSWER | (Flag.START if is_start else Flag(0))
        reached = packet.time + (0.0 if is_start else self.step)
        self.last = pack(
            Packet(self.session, self.sequence, flags, reached, trial_values(self.back, self.sequence, self.wholes))
        )
        self.steps += not is_start
        match self.sequence % _EVERY:
            case 3:
                self.is_withheld = True
                return
            case 6:
                for rubbish in self._rubbish():
                    self._send(rubbish, self.sender)
            case 9:
                self._send(self.last, self.sender)
        self._send(self.last, self.sender)

    def _again(self, data: bytes) -> None:
        if self.is_withheld:
            self.findings.right(RESENDS)
            self.is_withheld = False
        said = "" if data == self.request else "a request that was sent again has other bytes than before"
        self.findings.judge(SAME, said, self.sequence)
        self._send(self.last, self.sender)

    def _rubbish(self) -> list[bytes]:
        """Answers that a client must not take; one that breaks at them asks no more."""
        torn = self.last[:-4] + struct.pack("<i", self.sequence + 1)
        foreign = self.last[:4] + struct.pack("<i", self.session % (2**31 - 1) + 1) + self.last[8:]
        return [self.last[:-1], torn, foreign, b""]

    def _send(self, data: bytes, to: Any) -> None:
        try:
            self.line.sendto(data, to)
        except OSError:  # whoever sent has gone, or cannot be answered
            self.ignored["could not be answered"] += 1


def _flags(packet: Packet, *, is_start: bool) -> str:
    if packet.flags & Flag.ANSWER:
        return "ANSWER (16) is set: only the answering side has it"
    if bool(packet.flags & Flag.START) is not is_start:
        return "START (1) belongs to the packet of sequence 0, and to no other"
    return ""


def check_client(
    line: socket.socket,
    out: int,
    back: int,
    *,
    step: float,
    wait: float,
    patience: float,
    wholes: frozenset[int] = frozenset(),
) -> Checked:
    """Answer on *line* until END, or *patience* s without a packet; *wait* s for the first.

    Some answers are withheld, doubled, or come after rubbish. Values at the places *wholes* are whole.
    """
    world = _World(line, out, back, step, wholes)
    heard_at, began = time.monotonic(), 0.0
    while not world.has_ended:
        left = heard_at + (patience if world.session else wait) - time.monotonic()
        if left <= 0 or not select.select([line], [], [], left)[0]:
            break
        try:
            data, sender = line.recvfrom(_LARGEST_DATAGRAM)
        except ConnectionError:  # a report about an answer: whoever asked has gone
            continue
        began = began or time.perf_counter()
        world.take(data, sender)
        if world.session and sender == world.sender:
            heard_at = time.monotonic()
    if not world.session:
        world.findings.wrong(STARTS, f"no valid START arrived in {wait:g} s", 0)
    elif not world.has_ended:
        said = f"no END arrived: nothing was received for {patience:g} s (send END when the run is over)"
        world.findings.wrong(ENDS, said, world.sequence)
        if world.is_withheld:
            world.findings.wrong(RESENDS, "an unanswered request was not repeated", world.sequence)
    elif world.sequence < _EVERY:
        world.findings.wrong(COUNTS, f"only {world.sequence} steps: at least {_EVERY} are needed", world.sequence)
    spent = time.perf_counter() - began if began else 0.0
    return Checked(world.findings.listed(), Latencies((), 0, spent), sum(world.ignored.values()), world.steps)
