"""The client's side against a world that somebody wrote: does it answer as `dse docs udp` wants?"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field, replace

from dse.live.checks import Checked, Findings, Latencies
from dse.live.client import FIRST_PATIENCE, LONGEST_PATIENCE, PLAIN, ClientLine, Timings, new_session, request
from dse.live.packet import Flag, Packet, pack, unpack
from dse.live.packet_mistakes import explain

ANSWERS, BYTES, SESSION, SEQUENCE = "answers a START", "bytes of its packets", "session", "sequence"
FLAGS, TIME, REPEATS_START, STEPS = "flags", "time", "repeats the answer to START", "answers every step"
REPEATS, IGNORES = "repeats an answer", "ignores invalid packets"
BUSY, ENDS = "answers BUSY to a second client", "ends and restarts"
NAMES = (ANSWERS, BYTES, SESSION, SEQUENCE, FLAGS, TIME, REPEATS_START, STEPS, REPEATS, IGNORES, BUSY, ENDS)
_SILENCE = 0.05
"""Seconds in which a world has to say nothing, at least."""
_MOST_WRONG = 20
"""Answers that cannot be used, after which a request is given up."""


class _Silent(Exception):  # noqa: N818  # nothing can be asked any more
    """No answer came that can be used."""


@dataclass(frozen=True, slots=True)
class WorldTrial:
    """*out* and *back* values each way; steps of *step* s, *steps* of them; *patience* s for an answer."""

    out: int
    back: int
    step: float = 0.01
    steps: int = 100
    patience: float = 5.0
    wholes: frozenset[int] = frozenset()
    """Places of values that go out and are truth values, items, or integers."""


@dataclass(slots=True)
class _Client:
    line: ClientLine
    trial: WorldTrial
    findings: Findings
    session: int = field(default_factory=new_session)
    timings: Timings = field(default_factory=Timings)
    past: dict[int, bytes] = field(default_factory=dict)
    """Answers so far, by sequence; the last ones only."""
    late: frozenset[int] = frozenset()
    """Other sessions of this check: an answer to one of them is late, not wrong."""
    unheard: int = 0
    """How often the last request was sent again: so many answers may still come."""
    ignored: int = 0

    def packet(self, sequence: int, flags: Flag = PLAIN) -> Packet:
        seconds = max(sequence - 1, 0) * self.trial.step
        return request(self.session, sequence, seconds, self.trial.out, self.trial.wholes, flags)

    def ask(self, packet: Packet) -> bytes:
        """The answer to *packet*, which is sent until it comes. Raises _Silent."""
        data, patience, wrong, self.unheard = pack(packet), FIRST_PATIENCE, 0, 0
        began = self.line.now()
        deadline, is_again = began + self.trial.patience, False
        while self.line.now() < deadline and wrong < _MOST_WRONG:
            self.line.send(data)
            self.timings.resent += is_again
            self.unheard += is_again
            until = self.line.now() + patience
            while (left := min(until, deadline) - self.line.now()) > 0 and wrong < _MOST_WRONG:
                heard = self.line.hear(left)
                if heard is not None and self._takes(heard, packet):
                    took = self.line.now() - began
                    self.timings.quickest = min(self.timings.quickest, took)
                    if not is_again:
                        self.timings.seconds.append(took)
                    return self.past.setdefault(packet.sequence, heard)
                wrong += heard is not None and not self._is_late(heard)
            patience, is_again = min(2 * patience, LONGEST_PATIENCE), True
        raise _Silent

    def _takes(self, data: bytes, asked: Packet) -> bool:
        """Whether *data* answers *asked*, rightly or not in details. What is wrong is found."""
        if self._is_late(data) and data != self.past.get(asked.sequence):
            self.ignored += 1
            return False
        at = asked.sequence
        expected = Packet(asked.session, at, PLAIN, at * self.trial.step, ())
        said = explain(data, self.trial.back, expected)
        self.findings.judge(BYTES, said, at)
        if said:
            return False
        answer = unpack(data, self.trial.back)
        self.findings.judge(SESSION, _session(answer, asked), at)
        self.findings.judge(SEQUENCE, _sequence(answer, asked), at)
        if answer.session != asked.session or answer.sequence != at:
            return False
        self.findings.judge(FLAGS, _flags(answer, asked), at)
        self.findings.judge(TIME, _time(answer, expected.time, asked.time), at)
        if answer.flags & (Flag.BUSY | Flag.END):
            raise _Silent
        return True

    def _is_late(self, data: bytes) -> bool:
        """Whether *data* is an answer to something else, which was on its way while that was sent again."""
        if data in self.past.values():
            return True
        return bool(self.late) and not explain(data, self.trial.back) and _session_of(data, self.trial) in self.late

    @property
    def silence(self) -> float:
        """Seconds in which a world has to say nothing: four times as many as an answer takes."""
        return min(1.0, max(_SILENCE, 4 * self.timings.quickest))

    def heard_in_silence(self) -> bytes | None:
        """What is said although nothing was asked, unless it is late."""
        return self.hear(self.silence)

    def settle(self) -> None:
        """Wait for the answers to what was sent again: nothing is on its way afterwards."""
        while self.unheard and self.line.hear(self.trial.patience) is not None:
            self.unheard -= 1
            self.ignored += 1

    def hear(self, patience: float, awaited: bytes | None = None) -> bytes | None:
        """The next datagram within *patience* s that is *awaited* or not late."""
        until = self.line.now() + patience
        while (left := until - self.line.now()) > 0:
            heard = self.line.hear(left)
            if heard is None or heard == awaited or not self._is_late(heard):
                return heard
            self.ignored += 1
        return None


def check_world(line: ClientLine, trial: WorldTrial) -> Checked:
    """All checks of a lockstep world on *line*; they take some seconds."""
    client = _Client(line, trial, Findings(NAMES))
    measured = Latencies((), 0, 0.0)
    try:
        if _starts(client):
            measured = _steps(client)
            _repeats(client)
            _ignores(client)
            _is_busy(client)
            _ends(client)
    except _Silent:
        pass  # it has been found
    finally:
        line.send(pack(client.packet(trial.steps + 100, Flag.END)))
    return Checked(client.findings.listed(), measured, client.ignored)


def _starts(client: _Client) -> bool:
    start = client.packet(0, Flag.START)
    try:
        first = client.ask(start)
    except _Silent:
        nobody = "no process listens at this address and port (the system refuses the datagrams)"
        heard = "what was received is not a valid answer: see the other checks"
        waited = f"nothing was received in {client.trial.patience:g} s"
        is_told = any(check.is_right is False for check in client.findings.listed())
        client.findings.wrong(ANSWERS, heard if is_told else nobody if client.line.refused else waited, 0)
        return False
    client.findings.right(ANSWERS)
    _asks_again(client, start, first, REPEATS_START)
    return True


def _asks_again(client: _Client, packet: Packet, first: bytes, name: str) -> None:
    """The same request once more: the answer was lost on the way."""
    while client.line.hear(0.0001) is not None:  # what came twice because a request was sent twice
        client.ignored += 1
    client.line.send(pack(packet))
    again = client.hear(client.trial.patience, awaited=first)
    if again is None:
        said = "a repeated request was not answered: its first answer may be lost; keep the answer and send it again"
    elif again == first:
        said = ""
    else:
        said = "a repeated request got a different answer: keep the last answer and send it again, without a step"
        said = explain(again, client.trial.back) or said
    client.findings.judge(name, said, packet.sequence)


def _steps(client: _Client) -> Latencies:
    began = client.line.now()
    client.timings = Timings()
    for sequence in range(1, client.trial.steps + 1):
        _step(client, sequence, "no valid answer to the step's request arrived")
    client.findings.right(STEPS)
    spent, timings = client.line.now() - began, client.timings
    return Latencies(tuple(timings.seconds), timings.resent, spent)


def _step(client: _Client, sequence: int, said: str, name: str = STEPS) -> None:
    try:
        client.ask(client.packet(sequence))
    except _Silent:
        client.findings.wrong(name, said, sequence)
        raise
    client.past.pop(sequence - 3, None)


def _repeats(client: _Client) -> None:
    last = client.packet(client.trial.steps)
    _asks_again(client, last, client.past[last.sequence], REPEATS)


def _bad(client: _Client, right: Packet) -> list[tuple[str, bytes]]:
    """Packets that are all wrong in another way, made of the request that would be the next."""
    data, session, nan = pack(right), right.session % (2**31 - 1) + 1, struct.pack("<d", float("nan"))
    foreign = replace(right, session=session)
    return [
        ("an empty datagram", b""),
        ("a packet that is one byte short", data[:-1]),
        ("a packet that is one byte long", data + b"\0"),
        ("a packet without its end", data[: len(data) // 2]),
        ("a torn packet (its closing sequence differs)", data[:-4] + struct.pack("<i", right.sequence + 1)),
        ("a packet of another version", struct.pack("<i", 0x44534532) + data[4:]),
        ("a packet whose time is NaN", data[:16] + nan + data[24:]),
        *([("a packet with a value that is NaN", data[:24] + nan + data[32:])] if right.values else []),
        ("a request of another session", pack(foreign)),
        ("END of another session", pack(replace(foreign, flags=Flag.END))),
        ("a packet with the flag ANSWER", pack(client.packet(right.sequence, Flag.ANSWER))),
        ("an old request", pack(client.packet(right.sequence - 2))),
    ]


def _ignores(client: _Client) -> None:
    sequence = client.trial.steps + 1
    for place in range(len(_bad(client, client.packet(sequence)))):
        what, data = _bad(client, client.packet(sequence))[place]
        client.line.send(data)
        heard = client.heard_in_silence()
        if heard is not None:
            client.findings.wrong(IGNORES, f"{what} was answered", sequence)
        _step(client, sequence, f"after {what} no request was answered any more: it must be ignored", IGNORES)
        sequence += 1
    client.findings.right(IGNORES)


def _is_busy(client: _Client) -> None:
    sequence = max(client.past) + 1
    other = _Client(client.line, client.trial, client.findings)
    client.line.send(pack(other.packet(0, Flag.START)))
    heard = client.hear(client.trial.patience)
    client.findings.judge(BUSY, _busy(heard, client.trial.back, other.session), 0)
    _step(client, sequence, "after a START of a second client, requests of the first were no longer answered", BUSY)


def _busy(heard: bytes | None, count: int, session: int) -> str:
    if heard is None:
        return "a START of a second session was not answered: answer it with ANSWER and BUSY (24), with its session"
    said = explain(heard, count)
    if said:
        return said
    answer = unpack(heard, count)
    if not answer.flags & Flag.BUSY:
        return "a START of a second session was accepted: the first client has lost its world; answer with BUSY"
    return "" if answer.session == session else "BUSY does not have the session of the START it answers"


def _ends(client: _Client) -> None:
    last = max(client.past)
    client.settle()
    client.line.send(pack(client.packet(last + 1, Flag.END)))
    heard = client.line.hear(client.silence)
    if heard is not None:
        client.findings.wrong(ENDS, "END was answered: it has no answer", last + 1)
    client.line.send(pack(client.packet(last + 1)))
    heard = client.line.hear(client.silence)
    if heard is not None and not _is_end(heard, client.trial.back):
        client.findings.wrong(ENDS, "a request of the session that had ended was answered as before", last + 1)
    again = _Client(client.line, client.trial, client.findings, late=frozenset((client.session,)))
    try:
        again.ask(again.packet(0, Flag.START))
        again.ask(again.packet(1))
    except _Silent:
        client.findings.wrong(ENDS, "no second session could be started after END of the first", 0)
    else:
        client.findings.right(ENDS)
    client.line.send(pack(again.packet(2, Flag.END)))


def _session_of(data: bytes, trial: WorldTrial) -> int:
    return unpack(data, trial.back).session


def _is_end(data: bytes, count: int) -> bool:
    return not explain(data, count) and bool(unpack(data, count).flags & Flag.END)


def _session(answer: Packet, asked: Packet) -> str:
    if answer.session == asked.session:
        return ""
    return f"{answer.session} was returned where {asked.session} was sent: answer with the session of the request"


def _sequence(answer: Packet, asked: Packet) -> str:
    if answer.sequence == asked.sequence:
        return ""
    away = answer.sequence - asked.sequence
    return f"the answer's is {away:+d} off: answer with the sequence of the request, in the head and at the end"


def _flags(answer: Packet, asked: Packet) -> str:
    if answer.flags & Flag.BUSY:
        return "BUSY (8): another session is active; end it, or restart the world"
    if answer.flags & Flag.END:
        return "END (2): the world ended the session by itself"
    if not answer.flags & Flag.ANSWER:
        return "ANSWER (16) is missing: every packet of the answering side has it"
    is_start = bool(asked.flags & Flag.START)
    if is_start and not answer.flags & Flag.START:
        return "START (1) is missing in the answer to START: it has ANSWER and START (17)"
    if not is_start and answer.flags & Flag.START:
        return "START (1) is set in the answer to a step: only the answer to START has it"
    return ""


def _time(answer: Packet, expected: float, asked: float) -> str:
    if abs(answer.time - expected) <= 1e-6 * max(1.0, abs(expected)):
        return ""
    if answer.time == asked and asked != expected:
        return "the request's time was returned: an answer contains the state at the end of the step, with that time"
    return "the answer's time is not that of the end of the step (time of the request and a step; --step sets how long)"
