"""`dse udp check` against worlds that are right, and against each mistake that it knows."""

from __future__ import annotations

import socket
import struct
from itertools import count

import pytest
from background import LIMIT
from hypothesis import given, strategies as st
from live_worlds import ANSWER, BUSY, END, MAGIC, START, DirectLine, World, right_bytes, served

from dse.live import Checked, ClientLine, Flag, Packet, WorldTrial, check_world, connected_line, explain, pack

TRIAL = WorldTrial(1, 2, steps=5, patience=5.0)
OVER_SOCKETS = WorldTrial(1, 2, steps=5, patience=LIMIT)


def checked(world: World, latency: float = 0.0) -> Checked:
    return check_world(DirectLine(world, latency), TRIAL)


def wrong(found: Checked) -> dict[str, str]:
    return {check.name: " / ".join(check.said) for check in found.checks if check.is_right is False}


def test_a_world_that_does_all_as_the_page_says_is_right():
    with served(World()) as port:
        line = connected_line("127.0.0.1", port)
        with line.socket:
            found = check_world(line, OVER_SOCKETS)
    assert wrong(found) == {}
    assert all(check.is_right for check in found.checks)
    assert found.is_right
    assert len(found.latencies.seconds) + found.latencies.resent >= 5


@pytest.mark.parametrize("latency", [0.0, 0.002, 0.02, 0.06, 0.3, 1.5, 4.0])
def test_a_right_world_on_a_busy_machine_is_right(latency):
    found = checked(World(), latency)
    assert wrong(found) == {}
    assert found.is_right


class CountedLine(ClientLine):
    """Its clock goes on whenever it is read, so that patience is a number of tries."""

    def __init__(self, opened: socket.socket) -> None:
        super().__init__(opened)
        self._clock = count(0.0, 0.05)

    def now(self) -> float:
        return next(self._clock)


def test_a_port_where_nobody_listens_is_told_as_such():
    with served(World()) as port:
        pass
    with connected_line("127.0.0.1", port).socket as opened:
        found = check_world(CountedLine(opened), TRIAL)
    assert "no process listens" in wrong(found)["answers a START"]
    assert not found.is_right


def layouts(layout: str):
    """Bytes that are written by *layout*."""

    def write(session, sequence, flags, time, values):
        return struct.pack(layout.format(n=len(values)), MAGIC, session, sequence, flags, time, *values, sequence)

    return write


BYTES = {
    ">4id{n}di": "big-endian (network order)",
    "<4id{n}di4x": "or the closing sequence is an int64",
    "<4i4xd{n}di": "there are 4 bytes of padding between the four int32 and the time",
    "<4i4xd{n}di4x": "8-byte alignment has put padding before the time and at the end",
    "<2iqid{n}di": "the sequence in the head is an int64",
    "<2iqid{n}dq": "the sequence is an int64: both are int32",
    "<2iqi4xd{n}dq": "the sequence is an int64, with padding",
    "<4id{n}dq": "4 bytes follow the closing sequence: padding (a struct",
    "<4qd{n}dq": "the integers are int64",
    "<4if{n}fi": "time and values are 4-byte floats",
    "<4id{n}fi": "the values are 4-byte floats",
    "<4id{n}dd": "the closing sequence is a double",
    "<4dd{n}dd": "the integers are doubles",
}


@pytest.mark.parametrize("layout", BYTES)
def test_bytes_written_in_another_way_are_recognised(layout):
    data = layouts(layout)(77, 3, ANSWER, 0.03, (0.5, 12.0, -3e-5))
    assert BYTES[layout] in explain(data, 3)
    assert BYTES[layout] in explain(data, 3, Packet(77, 3, Flag.ANSWER, 0.03, ()))


RIGHT = right_bytes(77, 3, ANSWER, 0.03, (0.5, 12.0))
SINGLE = {
    "the closing sequence is missing": RIGHT[:-4],
    "the head has three int32": struct.pack("<3i3di", MAGIC, 77, 3, 0.03, 0.5, 12.0, 3),
    "the doubles are big-endian, the integers are not": RIGHT[:16] + struct.pack(">3d", 0.03, 0.5, 12.0) + RIGHT[-4:],
    "the integers are big-endian": struct.pack(">4i", MAGIC, 77, 3, 16) + RIGHT[16:-4] + struct.pack(">i", 3),
    "4 bytes come before the magic number": struct.pack("<i", len(RIGHT)) + RIGHT,
    "3 packets arrived in one datagram": 3 * RIGHT,
    "text (JSON or XML) was sent": b'{"session": 77, "values": [0.5, 12.0]}',
    "the datagram is empty": b"",
    "1 value came where 2 are expected": right_bytes(77, 3, ANSWER, 0.03, (0.5,)),
    "5 values came where 2 are expected": right_bytes(77, 3, ANSWER, 0.03, (0.5,) * 5),
    "is it missing before the values?": RIGHT[:16] + RIGHT[24:],
    "begins with 0x44534532, not with the magic number": struct.pack("<i", MAGIC + 1) + RIGHT[4:],
    "sequence 3 at the beginning, 4 at the end": RIGHT[:-4] + struct.pack("<i", 4),
    "value 2 is nan": right_bytes(77, 3, ANSWER, 0.03, (0.5, float("nan"))),
}


@pytest.mark.parametrize("said", SINGLE)
def test_a_single_mistake_is_told_in_words(said):
    assert said in explain(SINGLE[said], 2, Packet(77, 3, Flag.ANSWER, 0.03, ()))


@pytest.mark.parametrize("values", [(0.0, 0.0), (1e-7, 2e9), (-1.0, 1e300), (float(2**52), 5e-324)])
def test_what_is_right_is_never_called_wrong(values):
    assert explain(right_bytes(1, 0, ANSWER, 0.0, values), 2) == ""


@given(st.binary(max_size=120), st.integers(0, 9), st.booleans())
def test_anything_can_be_explained(data, values, is_ours):
    data = RIGHT[:16] + data if is_ours else data
    said = explain(data, values, Packet(77, 3, Flag.ANSWER, 0.03, ()))
    if len(data) != 28 + 8 * values:
        assert said


MISTAKES = {
    "bytes": (World(write=layouts(">4id{n}di")), "bytes of its packets", "big-endian"),
    "session": (World(session_off=1), "session", "answer with the session of the request"),
    "sequence": (World(sequence_off=1), "sequence", "the answer's is +1 off"),
    "no ANSWER": (World(flags=lambda is_start: START if is_start else 0), "flags", "ANSWER (16) is missing"),
    "no START": (World(flags=lambda is_start: ANSWER), "flags", "START (1) is missing"),
    "START in all": (World(flags=lambda is_start: ANSWER | START), "flags", "START (1) is set in the answer to a step"),
    "busy": (World(flags=lambda is_start: ANSWER | BUSY), "flags", "another session is active"),
    "old time": (World(time_off=-0.01), "time", "the request's time was returned"),
    "odd time": (World(time_off=0.04), "time", "is not that of the end of the step"),
    "steps again": (World(repeats="anew"), "repeats an answer", "got a different answer"),
    "mute": (World(repeats="never"), "repeats an answer", "was not answered"),
    "dies": (World(dies_at=4), "answers every step", "no valid answer"),
    "takes all": (World(is_strict=False), "ignores invalid packets", "was answered"),
    "not busy": (World(says_busy=False), "answers BUSY to a second client", "was not answered"),
    "never ends": (World(ends=False), "ends and restarts", "no second session could be started"),
    "answers END": (World(answers_end=True), "ends and restarts", "END was answered"),
    "ends": (World(flags=lambda is_start: ANSWER | (START if is_start else END)), "flags", "ended the session by"),
}


@pytest.mark.parametrize("latency", [0.0, 0.02, 0.2])
@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_world_with_a_mistake_is_told_which(mistake, latency):
    world, check, said = MISTAKES[mistake]
    found = wrong(checked(world, latency))
    assert said in found[check]


def test_a_packet_of_the_product_is_never_explained_away():
    assert explain(pack(Packet(9, 2, Flag.ANSWER, 0.02, (1.0,))), 1) == ""
