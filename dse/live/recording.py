"""Datagrams with their times in a file: a line of JSON each, so that what came before a crash stays readable."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from dse.errors import Location, fail
from dse.formats import shown
from dse.json_data import read_json

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
