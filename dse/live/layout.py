"""Which numbers go each way, by name and in order."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dse.domain.component import Component, Kind, Type
from dse.domain.udp import LinkRole, UdpSource, heard, sent
from dse.errors import closest, fail
from dse.formats import Entry, read_yaml, write_text
from dse.live.packet import MOST_VALUES

_FIRST = 24
"""Bytes before the first value."""
_SIGNAL = re.compile(r"(?P<name>\S+)(?: \[(?P<unit>[^\[\]]*)\])?")
_ITEMS = re.compile(r"0 [A-Za-z_]")
_TRUTH, _INTEGER = "0 or 1", "whole number"
_HINT = "write 'out: [torque, \"speed [m/s]\"]' and 'back: […]'; 'dse udp layout COMPONENT -o FILE' writes one"


@dataclass(frozen=True, slots=True)
class Signal:
    """A value of a packet: its name, and the unit of its number or what the numbers stand for."""

    name: str
    unit: str = ""

    def __str__(self) -> str:
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def is_whole(self) -> bool:
        """Whether its numbers are truth values, items, or integers."""
        return self.unit in (_TRUTH, _INTEGER) or _ITEMS.match(self.unit) is not None


@dataclass(frozen=True, slots=True)
class Layout:
    """*out* is what a client sends, *back* what it is answered."""

    out: tuple[Signal, ...]
    back: tuple[Signal, ...]

    def __post_init__(self) -> None:
        most = max(len(self.out), len(self.back))
        if most > MOST_VALUES:
            raise fail(f"{most} values: a packet has {MOST_VALUES} at most")


def wholes_of(signals: tuple[Signal, ...]) -> frozenset[int]:
    """Places of those whose numbers are whole."""
    return frozenset(place for place, signal in enumerate(signals) if signal.is_whole)


def offset_of(place: int) -> int:
    """Of the value number *place*, counted from 0, in bytes from the start of the packet."""
    return _FIRST + 8 * place


def unnamed_layout(out: int, back: int) -> Layout:
    """Of so many values each way. Raises DseError: too many."""
    return Layout(*(tuple(Signal(f"value_{place + 1}") for place in range(count)) for count in (out, back)))


def component_layout(component: Component) -> Layout:
    """What the datagrams of *component* hold, or would if it were of the kind udp.

    Raises DseError: a port or parameter that is no number.
    """
    ways = (sent(component), heard(component))
    if isinstance(component.source, UdpSource) and component.source.role is LinkRole.SERVER:
        ways = ways[::-1]
    wrong = next((f"'{name}' is a {type_}" for way in ways for name, type_ in way if not type_.kind.is_number), "")
    if wrong:
        raise fail(f"component '{component.name}': {wrong}; packets have numbers only", component.where)
    return Layout(*(tuple(Signal(name, _unit(type_)) for name, type_ in way) for way in ways))


def read_layout(path: Path) -> Layout:
    """The layout in a YAML file. Raises DseError."""
    top = read_yaml(path).top
    unknown = next((key for key in top.data if key not in ("out", "back")), None)
    if unknown is not None:
        raise fail(f"unknown key '{unknown}'", top[unknown].key, closest(unknown, ("out", "back")))
    return Layout(*(tuple(_signals(top[way])) for way in ("out", "back")))


def written_layout(layout: Layout) -> str:
    """*layout* as a file that `read_layout` reads."""
    lines = []
    for way, signals in (("out", layout.out), ("back", layout.back)):
        lines += [f"{way}:{'' if signals else ' []'}", *(f"  - {write_text(str(signal))}" for signal in signals)]
    return "\n".join(lines) + "\n"


def _signals(entry: Entry) -> list[Signal]:
    listed: Any = entry.data if entry.is_there else None
    if not isinstance(listed, list):
        raise fail(f"'{entry.name}' must be a list of signals", entry.where, _HINT)
    return [_signal(text, entry[place]) for place, text in enumerate(listed)]


def _signal(text: object, entry: Entry) -> Signal:
    matched = _SIGNAL.fullmatch(text) if isinstance(text, str) else None
    if matched is None:
        raise fail(f"'{text}' is not the name of a signal", entry.where, _HINT)
    return Signal(matched["name"], matched["unit"] or "")


def _unit(type_: Type) -> str:
    if type_.kind is Kind.REAL:
        return str(type_.unit)
    if type_.kind is Kind.ENUMERATION:
        return ", ".join(f"{number} {item}" for number, item in enumerate(type_.items))
    return _TRUTH if type_.kind is Kind.BOOLEAN else _INTEGER
