"""What an author of the other side did to get bytes that are no packet: the usual mistakes are tried one by one."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

from dse.live.packet import MAGIC_VERSION, Packet, PacketError, size_of, unpack

_MAGIC = struct.pack("<i", MAGIC_VERSION)
_SMALL, _LARGE = 1e-12, 1e12
"""Magnitudes of SI numbers that are sent; doubles that were read in a wrong way seldom fall between them."""


@dataclass(frozen=True, slots=True)
class _Mistake:
    """*layout* of the wrong packet: integers before the time, time, values, integers behind; *said* to the author."""

    layout: str
    said: str
    closing: int = -1
    """Place of the closing sequence among the items; 0: there is none."""


# Of two that can be the same bytes the first is told: a padded struct is an int64 sequence where flags are 0.
_MISTAKES = (
    _Mistake(
        ">4id{n}di",
        "all numbers are big-endian (network order): write them little-endian (C#: BinaryWriter, without "
        "HostToNetworkOrder; Java: ByteBuffer.order(LITTLE_ENDIAN); Python: struct '<')",
    ),
    _Mistake("<4id{n}d", "the closing sequence is missing: append the sequence once more, as int32", closing=0),
    _Mistake(
        "<4id{n}di4x",
        "4 bytes follow the closing sequence: padding (a struct's sizeof is rounded up to 8: pack it, or send 4 bytes "
        "less), or the closing sequence is an int64 (it is an int32; C#: int, not long)",
    ),
    _Mistake("<2iqid{n}di", "the sequence in the head is an int64: it is an int32 (C#: int, not long)"),
    _Mistake("<2iqid{n}dq", "the sequence is an int64: both are int32 (C#: int, not long)"),
    _Mistake("<2iqi4xd{n}dq", "the sequence is an int64, with padding behind the flags: both sequences are int32"),
    _Mistake("<4i4xd{n}di", "there are 4 bytes of padding between the four int32 and the time: pack the struct"),
    _Mistake("<4i4xd{n}di4x", "8-byte alignment has put padding before the time and at the end: pack the struct"),
    _Mistake("<4qd{n}dq", "the integers are int64: all five are int32 (C#: int, not long)"),
    _Mistake("<4id{n}dd", "the closing sequence is a double: it is an int32"),
    _Mistake("<4dd{n}dd", "the integers are doubles: the head is four int32, and the closing sequence one"),
    _Mistake("<3id{n}di", "the head has three int32: it is four (magic-and-version, session, sequence, flags)"),
)
_FLOATS = (
    _Mistake("<4if{n}fi", "time and values are 4-byte floats: they are 8-byte doubles (C#: double, not float)"),
    _Mistake("<4id{n}fi", "the values are 4-byte floats: they are 8-byte doubles (C#: double, not float)"),
)


def explain(data: bytes, count: int, wanted: Packet | None = None) -> str:
    """What is wrong with *data* as a packet of *count* values, in words for whoever wrote it; "" if nothing is.

    *wanted* has the session, sequence and time that are expected, if they are known: it decides doubtful cases.
    """
    try:
        packet = unpack(data, count)
    except PacketError as error:
        return next(_causes(data, count, wanted), str(error))
    return _swapped(packet, wanted)


def _causes(data: bytes, count: int, wanted: Packet | None) -> Iterator[str]:
    if not data:
        yield "the datagram is empty"
    if data[:1] in b"{[<" and data.isascii():
        yield "text (JSON or XML) was sent: the packet is binary"
    yield from (mistake.said for mistake in _MISTAKES if _is(mistake, data, count, wanted))
    size = size_of(count)
    if len(data) > size and len(data) % size == 0 and data[size : size + 4] == _MAGIC:
        yield f"{len(data) // size} packets arrived in one datagram: send each one separately"
    counted = _other_count(data, count, wanted)
    floats = next((mistake.said for mistake in _FLOATS if _is(mistake, data, count, wanted)), "")
    if floats or counted:
        yield ", or ".join(said for said in (floats, counted) if said)
    yield from _first_bytes(data)


def _first_bytes(data: bytes) -> Iterator[str]:
    """What the first bytes tell."""
    place = data.find(_MAGIC)
    if place > 0:
        yield f"{place} bytes come before the magic number: a length or a type of a serialiser? Send the packet alone"
    if data[:4] == _MAGIC[::-1]:
        yield "the integers are big-endian (network order): write them little-endian"
    if place < 0:
        version = int.from_bytes(data[:4], "little")
        yield (
            f"begins with {version:#010x}, not with the magic number {MAGIC_VERSION:#010x} "
            f"(bytes {_MAGIC.hex(' ')}): not a packet of this protocol, or of another version of it"
        )


def _other_count(data: bytes, count: int, wanted: Packet | None) -> str:
    """What is wrong if everything but the number of values is right, or ""."""
    other, rest = divmod(len(data) - size_of(0), 8)
    if rest or other < 0 or other == count or not data.startswith(_MAGIC) or data[8:12] != data[-4:]:
        return ""
    time = struct.unpack_from("<d", data, 16)[0]
    if other == count - 1 and wanted is not None and time != wanted.time:
        return f"{other} of {count} values came, and the first double is not the time: is it missing before the values?"
    numbers = f"{other} value{'s' * (other != 1)} came where {count} {'is' if count == 1 else 'are'} expected"
    return f"{numbers}: compare the layout ('dse udp layout')"


def _is(mistake: _Mistake, data: bytes, count: int, wanted: Packet | None) -> bool:
    layout = struct.Struct(mistake.layout.format(n=count))
    if layout.size != len(data):
        return False
    items = layout.unpack(data)
    head = len(items) - count - 1 - bool(mistake.closing)
    numbers, doubles = items[:head], items[head : head + 1 + count]
    if numbers[0] != MAGIC_VERSION or (mistake.closing and items[mistake.closing] not in numbers[1:]):
        return False
    if wanted is not None and wanted.session not in numbers[1:]:
        return False
    return all(map(_is_usual, doubles))


def _is_usual(value: float) -> bool:
    return value == 0.0 or _SMALL < abs(value) < _LARGE


def _swapped(packet: Packet, wanted: Packet | None) -> str:
    """Doubles whose bytes stand in the other order: then, and only then, they are usual numbers."""
    doubles = (packet.time, *packet.values)
    turned = struct.unpack(f">{len(doubles)}d", struct.pack(f"<{len(doubles)}d", *doubles))
    odd = [not _is_usual(value) for value in doubles]
    # A time of 0 is the same either way, and so are values: one that is odd as it stands decides.
    if any(odd) and all(isfinite(value) and _is_usual(value) for value in turned):
        return "the doubles are big-endian, the integers are not: write both little-endian"
    if wanted is not None and doubles[0] != wanted.time and turned[0] == wanted.time:
        return "the time is a big-endian double: write it little-endian"
    return ""
