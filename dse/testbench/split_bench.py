"""A bench in two halves that are simulated in two places: the car here, the world there (`dse docs two_machines`).

Each half has one generated component of the kind ``udp`` in the place of the other half.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from hashlib import sha256
from itertools import groupby

from dse.domain.bench import Simulation
from dse.domain.component import Causality, Component, Interface, Kind, Parameter, Port, Type
from dse.domain.design import Connection
from dse.domain.method import Algorithm
from dse.domain.system import Wire
from dse.domain.udp import UdpSource
from dse.errors import Problem, closest, fail, raise_if_any, some_of
from dse.system import along_the_flow
from dse.testbench.wired_bench import WiredBench

NEAR, FAR = "car", "world"
"""What the halves are called, and in each half the component that stands for the other one."""
LAYOUT = "layout"
"""The last value of every packet: a number that stands for what crosses the border, and for what the world is."""
_DIGITS = re.compile(r"(\d+)")


@dataclass(frozen=True, slots=True)
class WorldPlace:
    """Where the other half is, or listens, and which *parts* of the bench are in the world; None for the usual ones."""

    source: UdpSource
    parts: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True)
class Halves:
    """What stands on either side of the border, and what crosses it.

    *far* are the parts of the world's half. *border* is seen from the car: its inputs go to the world, its outputs come
    back, both in the order of the packets, called as the signals behind them, ``part.port``. *order* are the elements
    in stepping order, with `FAR` in the place of the world's; *number* is what both sides must have the same.
    """

    wired: WiredBench
    far: frozenset[str]
    border: Interface
    order: tuple[str, ...]
    number: int

    @property
    def near_name(self) -> str:
        """The element of the near half that stands for the world."""
        return _free(FAR, (part for part in self.wired.parts if part not in self.far))

    @property
    def far_name(self) -> str:
        """The element of the far half that stands for the car."""
        return _free(NEAR, self.far)


def split_in_two(
    wired: WiredBench, simulation: Simulation, parts: Iterable[str] | None, columns: Iterable[str]
) -> Halves:
    """*wired* in two halves: the world's has *parts*, or what `default_parts` names.

    *columns* are the signals that the near half records, ``part.port``, wherever they are. Raises DseError for parts
    that there are not, halves without parts, and what cannot be simulated in two places.
    """
    far = _chosen(wired, parts) if parts is not None else default_parts(wired, simulation)
    if not far or len(far) == len(wired.parts):
        what = (
            "all parts of the bench are in the world's half" if far else "no part of the bench is in the world's half"
        )
        raise fail(what, wired.where, "name the parts of the world: --parts chassis,road")
    problems = [*_method_problems(wired, simulation, far)]
    border = _border(wired, far, columns, problems)
    raise_if_any(problems)
    order = _order(wired, simulation, far)
    return Halves(wired, far, border, order, _number(wired, simulation, far, border))


def default_parts(wired: WiredBench, simulation: Simulation) -> frozenset[str]:
    """The bench's test components: with Gauss-Seidel those of them that step after all parts of the design."""
    tests = {part.name for part in wired.bench.test_components}
    if simulation.method.algorithm is not Algorithm.GAUSS_SEIDEL:
        return frozenset(tests)
    order = _stepping(wired)
    last = max((place for place, part in enumerate(order) if part not in tests), default=-1)
    return frozenset(order[last + 1 :])


def near_half(halves: Halves, source: UdpSource) -> WiredBench:
    """The car with the world in the place of the far parts; *source* tells where the world is."""
    return _half(halves, source, is_near=True)


def far_half(halves: Halves, source: UdpSource) -> WiredBench:
    """The world with the car in the place of the near parts."""
    return _half(halves, source, is_near=False)


def in_world(halves: Halves, name: str) -> bool:
    """Whether the port or parameter *name*, ``part.port``, is of a part of the world."""
    return _part_of(halves.wired, name) in halves.far


def signal_in_near(halves: Halves, name: str) -> str:
    """The signal *name*, ``part.port``, as the near half has it."""
    return f"{halves.near_name}.{name}" if in_world(halves, name) else name


def _half(halves: Halves, source: UdpSource, *, is_near: bool) -> WiredBench:
    wired = halves.wired
    name, other = (halves.near_name, FAR) if is_near else (halves.far_name, NEAR)
    mine = {part: component for part, component in wired.parts.items() if (part in halves.far) is not is_near}
    ports = halves.border.ports if is_near else tuple(_mirrored(port) for port in halves.border.ports)
    number = Parameter(LAYOUT, Type(Kind.INTEGER), halves.number, tunable=False)
    link = Component(
        name=f"{other}_of_{wired.bench.name}",
        interface=Interface(f"{other}_border", (*ports, Port(f"their_{LAYOUT}", Causality.OUTPUT, number.type))),
        title=f"The {other}'s half of {wired.bench.name}",
        source=replace(source, layout=halves.number),
        parameters=(number,),
        where=wired.where,
    )
    connections: dict[str, Connection] = {}
    for connection in wired.connections:
        begins, ends = (_part_of(wired, end) in mine for end in (connection.source, connection.target))
        if begins and ends:
            connections[connection.target] = connection
        elif begins:
            target = f"{name}.{connection.source}"
            connections[target] = Connection(connection.source, target, connection.where)
        elif ends:
            start = f"{name}.{connection.source}"
            connections[connection.target] = Connection(start, connection.target, connection.where)
    for port in ports:  # what crosses only to be recorded
        target = f"{name}.{port.name}"
        if port.causality is Causality.INPUT and target not in connections:
            connections[target] = Connection(port.name, target, wired.where)
    order = tuple(name if part == FAR else part for part in halves.order) if is_near else (name, *_far_order(halves))
    return replace(
        wired,
        parts={**mine, name: link},
        connections=tuple(connections.values()),
        values={end: value for end, value in wired.values.items() if _part_of(wired, end) in mine},
        faces={face: end for face, end in wired.faces.items() if _part_of(wired, end) in mine},
        order=order,
        streams=tuple(stream for stream in wired.streams if _part_of(wired, stream.name) in mine),
    )


def _chosen(wired: WiredBench, names: Iterable[str]) -> frozenset[str]:
    """The parts called *names*, or standing in an architecture called so."""
    found: set[str] = set()
    problems = []
    for name in names:
        meant = {part for part in wired.parts if part == name or part.startswith(f"{name}.")}
        if not meant:
            problems.append(Problem(f"there is no part '{name}'", wired.where, closest(name, wired.parts)))
        found |= meant
    raise_if_any(problems)
    return frozenset(found)


def _method_problems(wired: WiredBench, simulation: Simulation, far: frozenset[str]) -> Iterable[Problem]:
    where, method = simulation.where, simulation.method
    if simulation.check_step:
        yield Problem("a bench in two halves has no error bars", where, "leave out check_step")
    if not replace(method, steps={}, bonds=()).is_plain_but_for_order:
        hint = "jacobi or gauss_seidel, one step for all, inputs held"
        yield Problem("coupling, extrapolation and adaptive do not work between two halves", where, hint)
    if method.steps:
        what = f"{some_of(list(method.steps))} cannot have steps of their own in a bench in two halves"
        yield Problem(what, where, "one step for all")
    for bond in method.bonds:
        if any(_part_of(wired, end) in far for end in (bond.effort, bond.flow)):
            yield Problem(f"bond '{bond.name}' touches the world's half: its energy cannot be counted here", where)


def _border(wired: WiredBench, far: frozenset[str], columns: Iterable[str], problems: list[Problem]) -> Interface:
    """The signals that cross, by what the car does with them: sorted by name, numbers in names by their value."""
    out: dict[str, Type] = {}
    back: dict[str, Type] = {}
    ports = wired.ports
    crossing = [
        (connection.source, connection.where)
        for connection in wired.connections
        if (_part_of(wired, connection.source) in far) is not (_part_of(wired, connection.target) in far)
    ]
    recorded = [(name, wired.where) for name in columns if name in ports and _part_of(wired, name) in far]
    for name, where in (*crossing, *recorded):
        type_ = ports[name][1].type
        if not type_.kind.is_number:
            what = f"{name} is {type_.kind}: it cannot cross the border between the car and the world"
            problems.append(Problem(what, where or wired.where, "have both of its ends in one half: --parts"))
        (back if _part_of(wired, name) in far else out)[name] = type_.in_si
    sides = (Causality.INPUT, out), (Causality.OUTPUT, back)
    found = (Port(name, side, types[name]) for side, types in sides for name in sorted(types, key=_natural))
    return Interface(FAR, tuple(found))


def _order(wired: WiredBench, simulation: Simulation, far: frozenset[str]) -> tuple[str, ...]:
    """The elements as the whole bench steps them, with `FAR` for the world's.

    With Gauss-Seidel an element is given the newest values, so that the order decides results: the world's must be
    neighbours in it. Raises DseError if they are not.
    """
    order = _stepping(wired)
    runs = [(is_far, list(group)) for is_far, group in groupby(order, key=far.__contains__)]
    if simulation.method.algorithm is Algorithm.GAUSS_SEIDEL and sum(is_far for is_far, _ in runs) > 1:
        told = "; then ".join(f"{some_of(group)} {'there' if is_far else 'here'}" for is_far, group in runs)
        what = f"with gauss_seidel the world's parts must step one after the other, but it is {told}"
        hint = "choose other parts for the world (--parts), or 'algorithm: jacobi' in the bench, which has no order"
        raise fail(what, simulation.where, hint)
    first = next(place for place, part in enumerate(order) if part in far)
    near = [part for part in order if part not in far]
    before = sum(part not in far for part in order[:first])
    return (*near[:before], FAR, *near[before:])


def _far_order(halves: Halves) -> list[str]:
    return [part for part in _stepping(halves.wired) if part in halves.far]


def _stepping(wired: WiredBench) -> list[str]:
    owners = wired.ports
    wires = (Wire(owners[c.source][0], "", owners[c.target][0], "") for c in wired.connections)
    return along_the_flow(tuple(wired.parts), wires)


def _number(wired: WiredBench, simulation: Simulation, far: frozenset[str], border: Interface) -> int:
    """31 bits of what decides how packets are read and what the world answers."""
    values = {end: value for end, value in wired.values.items() if _part_of(wired, end) in far}
    decides = {
        "border": [(port.name, str(port.causality), str(port.type), port.type.items) for port in border.ports],
        "step": simulation.step,
        "algorithm": str(simulation.method.algorithm),
        "parts": sorted((part, wired.parts[part].name) for part in far),
        "values": sorted((end, str(value)) for end, value in values.items()),
    }
    return int.from_bytes(sha256(json.dumps(decides, sort_keys=True).encode()).digest()[:4], "big") >> 1


def _part_of(wired: WiredBench, end: str) -> str:
    """Where ``part.port`` stands: the longest part that its name begins with."""
    return max((part for part in wired.parts if end.startswith(f"{part}.")), key=len, default="")


def _mirrored(port: Port) -> Port:
    is_input = port.causality is Causality.INPUT
    return replace(port, causality=Causality.OUTPUT if is_input else Causality.INPUT)


def _natural(name: str) -> tuple[object, ...]:
    return tuple(int(piece) if place % 2 else piece for place, piece in enumerate(_DIGITS.split(name)))


def _free(name: str, taken: Iterable[str]) -> str:
    there = set(taken)
    while any(part == name or part.startswith(f"{name}.") for part in there):
        name += "_"
    return name
