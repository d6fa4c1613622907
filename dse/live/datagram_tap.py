"""A place between the two sides, or instead of one, at which every datagram is seen."""

from __future__ import annotations

import json
import select
import socket
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from dse.errors import Location, fail
from dse.formats import shown
from dse.json_data import read_json

# Datagrams with their times in a file: a line of JSON each, so that what came before a crash stays readable.


_FORMAT = "dse udp recording 1"
_LONGEST_LINE = 300_000


@dataclass(frozen=True, slots=True)
class Datagram:
    """*time* in s since the recording began; *is_answer* if it came from the answering side."""

    time: float
    is_answer: bool
    sender: str
    data: bytes


def write_head(file: TextIO) -> None:
    """The first line."""
    file.write(json.dumps({"format": _FORMAT}) + "\n")


def write_datagram(file: TextIO, datagram: Datagram) -> None:
    """One line more."""
    way = "back" if datagram.is_answer else "out"
    told = {"time": round(datagram.time, 6), "way": way, "from": datagram.sender, "data": datagram.data.hex()}
    file.write(json.dumps(told) + "\n")


def read_recording(path: Path) -> Iterator[Datagram]:
    """The datagrams in *path*, in order; a last line that is not whole was being written. Raises DseError."""
    with path.open(encoding="utf-8", errors="replace") as file:
        _check_head(file.readline(_LONGEST_LINE), path)
        for number, line in enumerate(iter(lambda: file.readline(_LONGEST_LINE), ""), 2):
            if line.endswith("\n"):
                yield _datagram(line, Location(shown(path), number))


def _check_head(line: str, path: Path) -> None:
    try:
        told = read_json(line)
    except ValueError:
        told = None
    if not isinstance(told, dict) or told.get("format") != _FORMAT:
        raise fail("this is not a recording", Location(shown(path), 1), "'dse udp record' writes one")


def _datagram(line: str, where: Location) -> Datagram:
    try:
        told = read_json(line)
        way, time = told["way"], float(told["time"])
        made = Datagram(time, {"out": False, "back": True}[way], str(told["from"]), bytes.fromhex(told["data"]))
    except (ValueError, KeyError, TypeError) as error:
        raise fail("this is not a datagram of a recording", where) from error
    return made


_LARGEST_DATAGRAM = 65_536
_MOST_CLIENTS = 32
_GLANCE = 0.25
"""Seconds after which it is looked whether it is over."""
Keep = Callable[[Datagram], None]


def listen_at(host: str, port: int) -> socket.socket:
    """A socket that is bound to *host* and *port*. Raises OSError."""
    family, kind, protocol, _, address = socket.getaddrinfo(
        host, port, type=socket.SOCK_DGRAM, flags=socket.AI_PASSIVE
    )[0]
    opened = socket.socket(family, kind, protocol)
    try:
        opened.bind(address)
    except BaseException:
        opened.close()
        raise
    return opened


def tap(
    line: socket.socket,
    onward: tuple[str, int] | None,
    keep: Keep,
    *,
    most: int,
    seconds: float,
    answers: tuple[str, int] | None = None,
) -> int:
    """Keep what comes to *line*, pass it on and its answers back; until *most* datagrams or *seconds*. Their count.

    Every sender gets a socket of its own towards the other side, so that answers find it; the last 32 of them. Or
    all answers go to *answers*: for clients that send from one port and listen at another.
    """
    clients: OrderedDict[Any, socket.socket] = OrderedDict()
    address = _address(*onward) if onward else None
    fixed = _address(*answers)[1] if answers else None
    began, count = time.monotonic(), 0
    try:
        while count < most and (left := began + seconds - time.monotonic()) > 0:
            for ready in select.select([line, *clients.values()], [], [], min(left, _GLANCE))[0]:
                got = _received(ready)
                if got is None or count >= most:
                    continue
                data, sender = got
                sender = sender if ready is line else _of(ready, clients)
                count += 1
                keep(Datagram(time.monotonic() - began, ready is not line, _name(sender, ready, line), data))
                if ready is not line:
                    _send(line, data, fixed or sender)
                elif address is not None:
                    _send(_towards(sender, clients, address), data, None)
    finally:
        for each in clients.values():
            each.close()
    return count


def _address(host: str, port: int) -> tuple[Any, Any]:
    family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
    return family, address


def _towards(sender: Any, clients: OrderedDict[Any, socket.socket], address: tuple[Any, Any]) -> socket.socket:
    if sender not in clients:
        if len(clients) >= _MOST_CLIENTS:
            clients.popitem(last=False)[1].close()
        clients[sender] = socket.socket(address[0], socket.SOCK_DGRAM)
        clients[sender].connect(address[1])
    clients.move_to_end(sender)
    return clients[sender]


def _of(ready: socket.socket, clients: OrderedDict[Any, socket.socket]) -> Any:
    return next((sender for sender, its in clients.items() if its is ready), None)


def _received(ready: socket.socket) -> tuple[bytes, Any] | None:
    try:
        return ready.recvfrom(_LARGEST_DATAGRAM)
    except OSError:  # a report about a datagram before, or a socket that was given up in this round
        return None


def _send(line: socket.socket, data: bytes, to: Any) -> None:
    try:
        line.send(data) if to is None else line.sendto(data, to)
    except OSError:  # nobody listens: as lost as any
        return


def _name(sender: Any, ready: socket.socket, line: socket.socket) -> str:
    host, port, *_ = sender if ready is line else ready.getpeername()
    return f"{host}:{port}"
