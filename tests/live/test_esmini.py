"""Messages to esmini against C structs of the same members, laid out by the C compiler's rules (ctypes)."""

from __future__ import annotations

import ctypes
from dataclasses import astuple

import pytest
from hypothesis import given, strategies as st

from dse.live import (
    DriverInput,
    DriverMessage,
    OsiParts,
    PacketError,
    StateH,
    StateXyh,
    StateXyzhpr,
    pack_message,
    unpack_message,
)

HEAD = [(name, ctypes.c_uint) for name in ("version", "mode", "object", "frame")]
MEMBERS = {
    DriverInput: (1, ["throttle", "brake", "steering"], False),
    StateXyzhpr: (2, ["x", "y", "z", "h", "p", "r", "speed", "wheel"], True),
    StateXyh: (3, ["x", "y", "h", "speed", "wheel"], True),
    StateH: (4, ["h", "speed", "wheel"], True),
}
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


def structure(kind: type) -> type[ctypes.LittleEndianStructure]:
    _, names, has_flag = MEMBERS[kind]
    fields = [*HEAD, *((name, ctypes.c_double) for name in names)]
    return type(
        "Message", (ctypes.LittleEndianStructure,), {"_fields_": fields + [("dead", ctypes.c_ubyte)] * has_flag}
    )


@pytest.mark.parametrize("kind", MEMBERS)
@given(st.data())
def test_every_message_has_the_bytes_of_the_struct(kind, data):
    mode, names, has_flag = MEMBERS[kind]
    values = [data.draw(NUMBERS) for _ in names] + [data.draw(st.booleans())] * has_flag
    message = DriverMessage(data.draw(st.integers(0, 2**32 - 1)), data.draw(st.integers(0, 2**32 - 1)), kind(*values))
    expected = bytes(structure(kind)(1, mode, message.object_id, message.frame, *values))
    packed = pack_message(message)
    padding = 7 * has_flag
    assert packed == expected[: len(expected) - padding]
    assert unpack_message(packed) == unpack_message(expected) == message
    assert [*astuple(message)[2]] == values


def test_a_message_without_input_is_a_head():
    assert pack_message(DriverMessage(3, 9)) == bytes([1, 0, 0, 0] + [0] * 4 + [3, 0, 0, 0] + [9, 0, 0, 0])
    assert unpack_message(pack_message(DriverMessage(3, 9))) == DriverMessage(3, 9)


@given(st.binary(max_size=90))
def test_bytes_of_any_kind_are_a_message_or_refused(data):
    try:
        message = unpack_message(data)
    except PacketError:
        return
    assert unpack_message(pack_message(message)) == message


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"\1", "1 bytes: the head of a message has 16"),
        (bytes([2]) + bytes(15), "version 2"),
        (bytes([1, 0, 0, 0, 5]) + bytes(11), "input mode 5: esmini has 0 to 4"),
        (bytes([1, 0, 0, 0, 3]) + bytes(11 + 40), "56 bytes: a message of STATE_XYH has 57"),
        (
            pack_message(DriverMessage(0, 0, DriverInput(1, 0, 0)))[:-2] + b"\xff\x7f",
            "a number of the message is invalid",
        ),
    ],
)
def test_what_is_wrong_with_a_message_is_told(data, said):
    with pytest.raises(PacketError, match=said):
        unpack_message(data)


@pytest.mark.parametrize(
    "message", [DriverMessage(-1, 0), DriverMessage(0, 2**32), DriverMessage(0, 0, StateH(float("nan"), 0, 0))]
)
def test_what_esmini_could_not_read_is_not_written(message):
    with pytest.raises(PacketError):
        pack_message(message)


def part(number: int, content: bytes) -> bytes:
    return number.to_bytes(4, "little", signed=True) + len(content).to_bytes(4, "little") + content


def test_parts_of_a_ground_truth_are_joined():
    parts = OsiParts()
    whole = [
        done for data in (part(1, b"ab"), part(2, b"cd"), part(-3, b"e"), part(-1, b"f")) for done in parts.take(data)
    ]
    assert whole == [b"abcde", b"f"]
    assert parts.dropped == 0


def test_parts_without_the_others_are_dropped_and_counted():
    parts = OsiParts()
    given_parts = (
        part(1, b"ab"),
        part(-3, b"e"),
        part(2, b"x"),
        b"",
        part(1, b"a")[:-1],
        part(1, b"g"),
        part(-2, b"h"),
    )
    assert [done for data in given_parts for done in parts.take(data)] == [b"gh"]
    assert parts.dropped == 5
