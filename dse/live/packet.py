"""The datagram of docs/udp.md: a head, the time, values, and the sequence once more."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntFlag
from math import isfinite

MAGIC_VERSION = 0x44534531
"""``DSE`` and version 1, as one number."""
MOST_VALUES = 8000
_HEAD = struct.Struct("<4id")
_TAIL = struct.Struct("<i")
_SIGNED = 1 << 31


class Flag(IntFlag):
    """What a packet is for."""

    START = 1
    END = 2
    LATE = 4
    BUSY = 8
    ANSWER = 16


class PacketError(ValueError):
    """Why bytes are no packet that can be used."""


@dataclass(frozen=True, slots=True)
class Packet:
    """*time* in s; the *values* are SI numbers in the order of the layout."""

    session: int
    sequence: int
    flags: Flag
    time: float
    values: tuple[float, ...]


def size_of(count: int) -> int:
    """Of a packet with *count* values, in bytes."""
    return _HEAD.size + 8 * count + _TAIL.size


def pack(packet: Packet) -> bytes:
    """The bytes that go over the wire."""
    head = _HEAD.pack(MAGIC_VERSION, packet.session, packet.sequence, packet.flags, packet.time)
    return head + struct.pack(f"<{len(packet.values)}d", *packet.values) + _TAIL.pack(packet.sequence)


def unpack(data: bytes, count: int) -> Packet:
    """The packet of *count* values in *data*. Raises PacketError: size, version, sequence, or a value is wrong."""
    if len(data) != size_of(count):
        raise PacketError(f"{len(data)} bytes: a packet of {count} values has {size_of(count)}")
    version, session, sequence, flags, time = _HEAD.unpack_from(data)
    if version != MAGIC_VERSION:
        raise PacketError(f"begins with {version & (2 * _SIGNED - 1):#010x}, not with {MAGIC_VERSION:#010x}")
    if _TAIL.unpack_from(data, len(data) - _TAIL.size)[0] != sequence:
        raise PacketError(f"sequence {sequence} at the beginning is another at the end: the packet is torn")
    if flags & ~sum(Flag):
        raise PacketError(f"flags {flags:#x}: nobody knows what these are for")
    values = struct.unpack_from(f"<{count}d", data, _HEAD.size)
    if not isfinite(time):
        raise PacketError("the time is no number")
    wrong = next((place for place, value in enumerate(values, 1) if not isfinite(value)), 0)
    if wrong:
        raise PacketError(f"value {wrong} is no number")
    return Packet(session, sequence, Flag(flags), time, values)
