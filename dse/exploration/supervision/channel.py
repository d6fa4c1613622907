"""The channel between a supervisor and a worker: messages arrive whole and unharmed, or not at all.

An FMU can write into any file its process has open, and a process can be stopped in the middle of a message. So the
supervisor never waits for the rest of one, and what is not a message is told from one before it is taken for it. What
comes from a worker is never unpickled: bytes that an FMU has made up must not be able to call anything.
"""

from __future__ import annotations

import pickle
import socket
import struct
import zlib
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from dse.plain_messages import packed, unpacked

_MARK = b"dse line"
_HEAD = struct.Struct("=8sQI")
_LONGEST = 1 << 32
_PIECE = 1 << 16


class GarbledError(Exception):
    """What came is not a message."""


class Channel:
    """The supervisor's end; nothing here waits. What arrives may hold dataclasses of *classes*."""

    def __init__(self, end: socket.socket, *classes: type) -> None:
        end.setblocking(False)
        self._classes = classes
        self.end = end
        self._unread = bytearray()
        self._unsent = bytearray()

    def send(self, message: object) -> None:
        """Send *message*, as far as there is room; `flush` sends the rest. Nothing is said if nobody is there."""
        self._unsent += _framed(pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL))
        self.flush()

    def flush(self) -> None:
        """Send what is waiting, as far as there is room."""
        with suppress(OSError):  # no room, or the worker is dead, as `arrived` will tell
            while self._unsent:
                del self._unsent[: self.end.send(self._unsent)]

    def arrived(self) -> Iterator[Any]:
        """The messages that are there, each taken from the channel only when it is asked for.

        Raises EOFError or OSError if the worker is dead, GarbledError where something else was sent.
        """
        while True:
            yield from self._whole()
            try:
                piece = self.end.recv(_PIECE)
            except BlockingIOError:
                return
            if not piece:
                raise EOFError
            self._unread += piece

    def close(self) -> None:
        """Close it."""
        self.end.close()

    def _whole(self) -> Iterator[Any]:
        while self._unread:
            if not _MARK.startswith(self._unread[: len(_MARK)]):
                raise GarbledError
            if len(self._unread) < _HEAD.size:
                return
            _, length, checksum = _HEAD.unpack_from(self._unread)
            if length > _LONGEST:
                raise GarbledError
            end = _HEAD.size + length
            if len(self._unread) < end:
                return
            body = bytes(self._unread[_HEAD.size : end])
            del self._unread[:end]
            if zlib.crc32(body) != checksum:
                raise GarbledError
            try:
                message = unpacked(body, *self._classes)
            except ValueError as error:
                raise GarbledError from error
            yield message


def send(end: socket.socket, message: object) -> None:
    """Send *message* from a worker. OSError if the supervisor is gone."""
    end.sendall(_framed(packed(message)))


def receive(end: socket.socket) -> Any:
    """Wait in a worker for the next message. Raises EOFError or OSError if the supervisor is gone."""
    _, length, _ = _HEAD.unpack(_exactly(end, _HEAD.size))
    return pickle.loads(_exactly(end, length))  # noqa: S301  # our supervisor has sent it


def _framed(body: bytes) -> bytes:
    return _HEAD.pack(_MARK, len(body), zlib.crc32(body)) + body


def _exactly(end: socket.socket, length: int) -> bytes:
    content = bytearray()
    while len(content) < length:
        piece = end.recv(min(length - len(content), _PIECE))
        if not piece:
            raise EOFError
        content += piece
    return bytes(content)
