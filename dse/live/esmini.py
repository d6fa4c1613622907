"""Messages to esmini's UDPDriverController, version 1 (its ControllerUDPDriver.hpp): they drive one of its objects.

Little-endian, aligned as C aligns; the flag for dead reckoning is the last byte, padding behind it need not be sent.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from enum import IntEnum
from math import isfinite

from dse.live.packet import PacketError

VERSION = 1
DEFAULT_PORT = 49950
"""Of object 0; each object listens at this and its id, unless the scenario says otherwise."""
_HEAD = struct.Struct("<4I")
_OSI_HEAD = struct.Struct("<iI")
_MOST_PARTS = 4096


class InputMode(IntEnum):
    """What a message holds."""

    NO_INPUT = 0
    DRIVER_INPUT = 1
    STATE_XYZHPR = 2
    STATE_XYH = 3
    STATE_H = 4


@dataclass(frozen=True, slots=True)
class DriverInput:
    """*throttle* and *brake* 0 to 1, *steering* in rad at the wheels: esmini's own vehicle is driven."""

    throttle: float
    brake: float
    steering: float


@dataclass(frozen=True, slots=True)
class StateXyzhpr:
    """Place in m, heading, pitch and roll in rad, speed in m/s; between messages it moves on if it *reckons*."""

    x: float
    y: float
    z: float
    heading: float
    pitch: float
    roll: float
    speed: float
    wheel_angle: float
    reckons: bool = False


@dataclass(frozen=True, slots=True)
class StateXyh:
    """As above; height, pitch and roll are those of the road."""

    x: float
    y: float
    heading: float
    speed: float
    wheel_angle: float
    reckons: bool = False


@dataclass(frozen=True, slots=True)
class StateH:
    """Heading and speed; esmini moves the object if it *reckons*."""

    heading: float
    speed: float
    wheel_angle: float
    reckons: bool = False


Payload = DriverInput | StateXyzhpr | StateXyh | StateH | None
_PAYLOADS: dict[InputMode, tuple[type[DriverInput | StateXyzhpr | StateXyh | StateH], struct.Struct]] = {
    InputMode.DRIVER_INPUT: (DriverInput, struct.Struct("<3d")),
    InputMode.STATE_XYZHPR: (StateXyzhpr, struct.Struct("<8d?")),
    InputMode.STATE_XYH: (StateXyh, struct.Struct("<5d?")),
    InputMode.STATE_H: (StateH, struct.Struct("<3d?")),
}


@dataclass(frozen=True, slots=True)
class DriverMessage:
    """*frame* counts messages; without *payload* nothing is told."""

    object_id: int
    frame: int
    payload: Payload = None


def pack_message(message: DriverMessage) -> bytes:
    """The bytes that esmini takes. Raises PacketError: a number that is none, or does not fit."""
    mode, body = InputMode.NO_INPUT, b""
    if message.payload is not None:
        mode = next(mode for mode, (kind, _) in _PAYLOADS.items() if isinstance(message.payload, kind))
        values = astuple(message.payload)
        if not all(map(isfinite, values)):
            raise PacketError(f"a number of {message.payload} is invalid")
        body = _PAYLOADS[mode][1].pack(*values)
    for name, number in (("object", message.object_id), ("frame", message.frame)):
        if not 0 <= number < 2**32:
            raise PacketError(f"{name} {number} is not a uint32")
    return _HEAD.pack(VERSION, mode, message.object_id, message.frame) + body


def unpack_message(data: bytes) -> DriverMessage:
    """The message in *data*, with or without padding. Raises PacketError that says what is wrong."""
    if len(data) < _HEAD.size:
        raise PacketError(f"{len(data)} bytes: the head of a message has {_HEAD.size}")
    version, mode, object_id, frame = _HEAD.unpack_from(data)
    if version != VERSION:
        raise PacketError(f"version {version} of esmini's driver messages, not {VERSION}")
    if mode not in list(InputMode):
        raise PacketError(f"input mode {mode}: esmini has 0 to {max(InputMode)}")
    if mode == InputMode.NO_INPUT:
        return DriverMessage(object_id, frame)
    kind, layout = _PAYLOADS[InputMode(mode)]
    if len(data) < _HEAD.size + layout.size:
        name = InputMode(mode).name
        raise PacketError(f"{len(data)} bytes: a message of {name} has {_HEAD.size + layout.size}")
    values = layout.unpack_from(data, _HEAD.size)
    if not all(map(isfinite, values)):
        raise PacketError("a number of the message is invalid")
    return DriverMessage(object_id, frame, kind(*values))


class OsiParts:
    """Puts together what esmini sends as OSI over UDP (port 48198): a GroundTruth may come in several datagrams.

    Each has its number, from 1, negative if it is the last, and the size of what follows. Parts of a message of which
    one is missing are dropped and counted in *dropped*.
    """

    def __init__(self) -> None:
        self.dropped = 0
        self._parts: list[bytes] = []

    def take(self, data: bytes) -> Iterator[bytes]:
        """The serialised GroundTruth that *data* completes, if it does."""
        number, size = _OSI_HEAD.unpack_from(data) if len(data) >= _OSI_HEAD.size else (0, -1)
        place = abs(number)
        if size != len(data) - _OSI_HEAD.size or not 0 < place <= _MOST_PARTS:
            self._drop(1)
            return
        if place == 1:
            self._drop(0)
        if place != len(self._parts) + 1:
            self._drop(1)
            return
        self._parts.append(data[_OSI_HEAD.size :])
        if number < 0:
            yield b"".join(self._parts)
            self._parts = []

    def _drop(self, more: int) -> None:
        self.dropped += more + len(self._parts)
        self._parts = []
