"""The traffic of a shared world: a run of the bench's road and traffic alone, which sees all cars.

A component can be such traffic if it has the inputs ``hosts[n]``, cars along the host's path, to which it reacts, and
puts out all of its road users, as ``everyone[n]`` or, if there are no more, ``movers[n]``. Its own host is left out.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from dse.domain.bench import TestBench
from dse.domain.component import Causality, Kind, Port, Value
from dse.domain.design import Configuration, Connection
from dse.domain.method import PLAIN
from dse.domain.udp import LinkMode
from dse.kinds import RoadSource, tables_along
from dse.live.driver_in_the_loop import DriverInTheLoop, driver_of, heedless, link, own_signals
from dse.live.others import Users, Ways
from dse.live.packet import Packet
from dse.live.seat import PlacedSession
from dse.live.session import OWN_VALUES, Patience, Why
from dse.live.shared_bench import CLOCK, Sharing
from dse.live.shared_world import Place, SharedWorld
from dse.testbench import PreparedBench, WiredBench, prepare_unmeasured, wire_bench

_LONGEST = 86_400.0
"""Seconds that it lasts."""
_HOST, _OWN_HOST = re.compile(r"hosts\[([0-9]+)\]\.([a-z_]+)"), ("lane.", "motion.")
_USER = re.compile(r"(everyone|movers)\[([0-9]+)\]\.([a-z_]+)")
_PLACE = ("path", "lane", "station", "offset")
_NEEDED = frozenset({"id", "class", "turn", "speed", *_PLACE})


@dataclass(frozen=True, slots=True)
class WorldTraffic:
    """What a `TrafficSession` runs: *hosts* cars have *fields*, its road users have *columns*, along *ways*."""

    prepared: PreparedBench
    end: DriverInTheLoop
    hosts: int
    fields: tuple[str, ...]
    columns: tuple[str, ...]
    ways: Ways

    def take_part(self, world: SharedWorld) -> None:
        """Be the traffic of *world*."""

        def begin(place: Place) -> Callable[[], None]:
            return TrafficSession(self, world, place).close

        world.have_traffic(self.hosts, self.fields, begin)


def traffic_of(
    bench: TestBench, configuration: Configuration, sharing: Sharing, *, version: int = 2
) -> WorldTraffic | None:
    """The traffic of *bench* for a world that is shared so; None if it has none that can react to several cars."""
    wired = wire_bench(bench, configuration)
    name, source = sharing.traffic, wired.parts[sharing.road].source
    if not name or not isinstance(source, RoadSource) or traffic_left_out(bench, configuration, sharing):
        return None
    ports = {port.name: port for port in wired.parts[name].interface.ports}
    hosts, users = _hosts_of(ports), _users_of(ports, sharing)
    columns = tuple(dict.fromkeys(each[3] for each in users))
    part = driver_of(bench)
    ends = {each: f"{name}.{port}" for each, port in hosts.items()}
    clock = f"{sharing.road}.clock_offset"
    given = {each: ports[port].type for each, port in hosts.items()}
    if sharing.has_clock:
        ends[CLOCK], given[CLOCK] = clock, sharing.types[CLOCK]
    seen = {f"{part.name}.{each}": type_ for each, type_ in own_signals().items()}
    seen |= {f"{name}.{each[0]}": ports[each[0]].type for each in users}
    inputs = [Port(f"sees.n{number}", Causality.INPUT, type_.in_si) for number, type_ in enumerate(seen.values(), 1)]
    outputs = [Port(each, Causality.OUTPUT, type_.in_si) for each, type_ in {**given, **own_signals()}.items()]
    # The clock stops while no car is driven, for any time.
    component = link(part, (*inputs, *outputs), LinkMode.LOCKSTEP, _LONGEST)
    ways = {f"{part.name}.{each}": end for each, end in ends.items()}
    ways |= {end: f"{part.name}.{port.name}" for end, port in zip(seen, inputs, strict=True)}
    alone = _alone(wired, sharing, part.name)
    alone = replace(
        alone,
        parts={**alone.parts, part.name: component},
        connections=(*alone.connections, *(Connection(source, end, part.where) for source, end in ways.items())),
        values={**alone.values, **({f"{name}.minds_host": False} if wired.parts[name].parameter("minds_host") else {})},
    )
    length = round(_LONGEST / bench.simulation.step) * bench.simulation.step
    simulation = replace(bench.simulation, method=PLAIN, stop=length, record=(), record_every=length, check_step=False)
    prepared = prepare_unmeasured(alone, simulation, version=version)
    elements = (heedless(each) if each.name == part.name else each for each in prepared.system.elements)
    prepared = replace(prepared, system=replace(prepared.system, elements=tuple(elements)))
    end = DriverInTheLoop(bench, configuration, part.name, (), {}, tuple(seen)[OWN_VALUES:], tuple(given))
    fields = tuple(dict.fromkeys(each.partition(".")[2] for each in hosts))
    count = max(int(each.partition(".")[0].removeprefix("other")) for each in hosts)
    return WorldTraffic(prepared, end, count, fields, columns, Ways.along(tables_along(source).paths))


def traffic_left_out(bench: TestBench, configuration: Configuration, sharing: Sharing) -> str:
    """Why a world that is shared so is without the traffic of *bench*; "" if it has it, or the bench has none."""
    if not sharing.traffic:
        return ""
    wired = wire_bench(bench, configuration)
    component = wired.parts[sharing.traffic]
    ports = [port.name for port in component.interface.ports]
    why = ""
    if not _hosts_of(ports):
        why = "it reacts to one host only, as it has no inputs 'hosts'"
    elif missing := sorted(_NEEDED - {each[3] for each in _users_of(ports, sharing)}):
        why = f"its road users have no {', '.join(missing)}"
    elif not isinstance(wired.parts[sharing.road].source, RoadSource):
        why = f"{sharing.road} is not of the kind 'road'"
    return f"without the traffic of the bench ({component.name}): {why}" if why else ""


def _hosts_of(ports: Iterable[str]) -> dict[str, str]:
    return {f"other{found[1]}.{found[2]}": port for port in ports if (found := _HOST.fullmatch(port))}


def _users_of(ports: Iterable[str], sharing: Sharing) -> list[re.Match[str]]:
    """The ports of its road users, as matches of `_USER`: those of ``everyone``, if it has that output."""
    users = [found for port in ports if (found := _USER.fullmatch(port)) and found[3] in sharing.fields]
    return [each for each in users if each[1] == "everyone"] or users


def _alone(wired: WiredBench, sharing: Sharing, driver: str) -> WiredBench:
    """The road, the traffic, and what the bench has besides that feeds them, such as the weather."""
    tests = {each.name for each in wired.bench.test_components} - {driver}
    of = {end: part for end, (part, _) in wired.ports.items()}
    of |= {f"{part}.{each.name}": part for part, found in wired.parts.items() for each in found.parameters}
    own = tuple(f"{sharing.traffic}.{each}" for each in _OWN_HOST)
    ways = [each for each in wired.connections if not each.target.startswith(own)]
    kept, before = {sharing.road, sharing.traffic}, set[str]()
    while kept != before:
        before = set(kept)
        kept |= {of[each.source] for each in ways if of[each.target] in kept and of[each.source] in tests}
    cut = [
        each.target
        for each in wired.connections
        if of[each.target] in kept and not (each in ways and of[each.source] in kept)
    ]
    nothing = {end: _nothing(wired.ports[end][1]) for end in cut if end in wired.ports}
    return replace(
        wired,
        parts={name: part for name, part in wired.parts.items() if name in kept},
        connections=tuple(each for each in ways if of[each.source] in kept and of[each.target] in kept),
        values={end: value for end, value in wired.values.items() if of[end] in kept} | nothing,
        faces={},
        streams=tuple(each for each in wired.streams if of[each.name] in kept),
    )


def _nothing(port: Port) -> Value:
    """What an input has that is connected no longer."""
    match port.type.kind:
        case Kind.ENUMERATION:
            return port.type.items[0]
        case Kind.BOOLEAN:
            return False
    return 0


class TrafficSession(PlacedSession):
    """A `PlacedSession` of *traffic*."""

    def __init__(self, traffic: WorldTraffic, world: SharedWorld, place: Place) -> None:
        self._traffic = traffic
        super().__init__(traffic.prepared, traffic.end, {}, Patience(step=_LONGEST), world=world, place=place)

    def state_of(self, packet: Packet) -> Users:
        """Its road users, as its run tells."""
        columns = self._traffic.columns
        table = np.array(packet.values[OWN_VALUES:]).reshape(-1, len(columns))
        table = table[table[:, columns.index("class")] > 0]
        named = {name: table[:, number] for number, name in enumerate(columns)}
        return Users(named, *self._traffic.ways.plane(*(named[name] for name in _PLACE)))

    def answer(self, packet: Packet, others: Mapping[str, float]) -> Packet:
        """What it is told of the cars."""
        return super().answer(packet, {name: value for name, value in others.items() if name in self._values})

    def _talk(self) -> None:
        super()._talk()
        self.world.leave(self.place)  # also if it never came to take part
        if self._ended and self._ended.why is Why.CRASHED:
            self.world.problem = f"the traffic has ended: {self._ended.text}"

    def _overdue(self, began: float, heard: float) -> tuple[Why, str] | None:
        return (Why.FINISHED, "no car is left") if self._wants_end.is_set() else super()._overdue(began, heard)
