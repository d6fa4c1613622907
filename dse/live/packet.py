"""The datagram of `dse docs udp`: a head, the time, values, and the sequence once more."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntFlag
from math import isfinite

MAGIC_VERSION = 0x44534531
"""``DSE`` and version 1, as one number."""
MOST_VALUES = 8000
_HEAD = struct.Struct("<4id")
_TAIL = struct.Struct("<i")
_LARGEST = 2**31 - 1


class Flag(IntFlag):
    """What a packet is for."""

    START = 1
    END = 2
    LATE = 4
    BUSY = 8
    ANSWER = 16


_KNOWN = int(Flag.START | Flag.END | Flag.LATE | Flag.BUSY | Flag.ANSWER)


class PacketError(ValueError):
    """Why bytes are no packet that can be used, or numbers are none that can be sent."""


@dataclass(frozen=True, slots=True)
class Packet:
    """*session* is positive, *sequence* not negative, *time* in s; *values* are in the order of the layout."""

    session: int
    sequence: int
    flags: Flag
    time: float
    values: tuple[float, ...]


def size_of(count: int) -> int:
    """Of a packet with *count* values, in bytes. Raises PacketError: no datagram holds so many."""
    if not 0 <= count <= MOST_VALUES:
        raise PacketError(f"{count} values: a packet has 0 to {MOST_VALUES}")
    return _HEAD.size + 8 * count + _TAIL.size


def pack(packet: Packet) -> bytes:
    """The bytes that go over the wire. Raises PacketError for what `unpack` would refuse."""
    size_of(len(packet.values))
    _check(packet.session, packet.sequence, packet.flags, packet.time, packet.values)
    head = _HEAD.pack(MAGIC_VERSION, packet.session, packet.sequence, packet.flags, packet.time)
    return head + struct.pack(f"<{len(packet.values)}d", *packet.values) + _TAIL.pack(packet.sequence)


def unpack(data: bytes, count: int) -> Packet:
    """The packet of *count* values in *data*. Raises PacketError that says what is wrong with it."""
    if len(data) != size_of(count):
        raise PacketError(f"{len(data)} bytes: a packet of {count} values has {size_of(count)}")
    version, session, sequence, flags, time = _HEAD.unpack_from(data)
    if version != MAGIC_VERSION:
        raise PacketError(f"begins with {version & 0xFFFFFFFF:#010x}, not with {MAGIC_VERSION:#010x}")
    closing = _TAIL.unpack_from(data, len(data) - _TAIL.size)[0]
    if closing != sequence:
        raise PacketError(f"sequence {sequence} at the beginning, {closing} at the end: the packet is torn")
    values = struct.unpack_from(f"<{count}d", data, _HEAD.size)
    _check(session, sequence, flags, time, values)
    return Packet(session, sequence, Flag(flags), time, values)


def _check(session: int, sequence: int, flags: int, time: float, values: Sequence[float]) -> None:
    if not 0 < session <= _LARGEST:
        raise PacketError(f"session {session}: sessions are positive int32")
    if not 0 <= sequence <= _LARGEST:
        raise PacketError(f"sequence {sequence}: sequences are int32 that count from 0")
    if flags & ~_KNOWN:
        raise PacketError(f"flags {flags & 0xFFFFFFFF:#x}: not defined by the protocol")
    if not isfinite(time):
        raise PacketError(f"the time is {time}")
    wrong = next((place for place, value in enumerate(values, 1) if not isfinite(value)), 0)
    if wrong:
        raise PacketError(f"value {wrong} is {values[wrong - 1]}")
