"""A bench that several people share: the cars of the others take the place of its traffic."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from dse.domain.bench import TestBench
from dse.domain.component import Causality, Port, Type
from dse.domain.design import Configuration
from dse.errors import fail
from dse.kinds import RoadSource, tables_along
from dse.testbench import WiredBench, wire_bench

START = "start_station"
"""The parameter of the road that places a car at its start."""
CLOCK = "clock"
"""The output of the driver in the loop that traffic lights follow, and the input of the road (``clock_offset``)."""
Ports = Mapping[str, tuple[str, Port]]
_MOVER = re.compile(r"(.+)\.movers\[([0-9]+)\]\.([a-z_]+)")
_NEEDED = frozenset({"class", "path", "station", "offset", "turn", "speed"})


@dataclass(frozen=True, slots=True)
class Sharing:
    """How others get into a bench: by the inputs ``movers[n]`` of the part *road*, which *traffic* feeds otherwise.

    *ends* are these inputs by the driver in the loop's outputs (``other1.speed``), *types* their types, in SI. A road
    with traffic lights has one more, `CLOCK`.
    """

    road: str
    traffic: str
    ends: Mapping[str, str]
    types: Mapping[str, Type]

    @property
    def places(self) -> int:
        """The number of others that a car can have around it."""
        return max(int(name.partition(".")[0].removeprefix("other")) for name in self.ends if name != CLOCK)

    @property
    def fields(self) -> tuple[str, ...]:
        """What is known of another car, as ``speed``."""
        return tuple(dict.fromkeys(name.partition(".")[2] for name in self.ends if name != CLOCK))

    @property
    def has_clock(self) -> bool:
        """Whether the road has traffic lights."""
        return CLOCK in self.ends


def sharing_of(bench: TestBench, configuration: Configuration) -> Sharing:
    """How *bench* with *configuration* can be shared. Raises DseError that says why it cannot."""
    wired, what = wire_bench(bench, configuration), f"bench '{bench.name}' cannot be shared: "
    ports = wired.ports
    found = dict(_movers(ports))
    roads = sorted({end.partition(".movers[")[0] for end in found.values()})
    if len(roads) != 1:
        which = f"both {roads[0]} and {roads[1]} have" if roads else "no part has"
        raise fail(f"{what}{which} the inputs 'movers', through which a road takes other vehicles", bench.where)
    road, fields = roads[0], {name.partition(".")[2] for name in found}
    if missing := sorted(_NEEDED - fields):
        raise fail(f"{what}the movers of {road} have no {', '.join(missing)}", bench.where)
    component = wired.parts[road]
    if component.parameter(START) is None or START in {name.partition(".")[2] for name in wired.connected}:
        raise fail(f"{what}{road} has no parameter '{START}': all cars would start at the same place", bench.where)
    if isinstance(component.source, RoadSource) and any(p.lights for p in tables_along(component.source).paths):
        end = f"{road}.clock_offset"
        if end not in ports or end in {each.target for each in wired.connections}:
            hint = "give the interface 'road' the input clock_offset, in s, and do not connect it"
            raise fail(f"{what}the traffic lights of {road} cannot follow the time of the world", bench.where, hint)
        found[CLOCK] = end
    types = {name: ports[end][1].type for name, end in found.items()}
    types = {name: each.in_si for name, each in types.items()}
    movers = {end for name, end in found.items() if name != CLOCK}
    return Sharing(road, _traffic(wired, ports, movers, what), found, types)


def without_traffic(bench: TestBench, sharing: Sharing) -> TestBench:
    """*bench* without the component that puts out its traffic."""
    if not sharing.traffic:
        return bench
    own = f"{sharing.traffic}."
    return replace(
        bench,
        test_components=tuple(each for each in bench.test_components if each.name != sharing.traffic),
        connections=tuple(
            each for each in bench.connections if not each.source.startswith(own) and not each.target.startswith(own)
        ),
        parameters={name: value for name, value in bench.parameters.items() if not name.startswith(own)},
    )


def _movers(ports: Ports) -> Iterator[tuple[str, str]]:
    for end, (_, port) in ports.items():
        match = _MOVER.fullmatch(end)
        if match and port.causality is Causality.INPUT and port.type.kind.is_number:
            yield f"other{match[2]}.{match[3]}", end


def _traffic(wired: WiredBench, ports: Ports, movers: set[str], what: str) -> str:
    """The test component that feeds *movers*; "" if nothing does."""
    where = wired.bench.where
    parts = {ports[each.source][0] for each in wired.connections if each.target in movers}
    if not parts:
        return ""
    own = parts & {each.name for each in wired.bench.test_components}
    if len(parts) > 1 or not own:
        raise fail(f"{what}its other vehicles are from {', '.join(sorted(parts))}", where)
    (traffic,) = own
    for each in wired.connections:
        if ports[each.source][0] == traffic and each.target not in movers:
            raise fail(f"{what}{each.target} needs {each.source}, and its traffic is replaced by the others", where)
    return traffic
