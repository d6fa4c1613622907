"""``source: {kind: road}``: ways through a network of roads, in OpenDRIVE or in YAML."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.component import Component, Source
from dse.errors import Location, Problem, closest, fail, raise_if_any
from dse.kinds._generated import build_generated
from dse.kinds.scenario import Values, written_values
from dse.loading import ComponentKind, Plain, Section, SourcePlace, SourceSection, Workspace

if TYPE_CHECKING:
    from dse.world import Network, RoadTables, Route, Scenario

_INTERFACE = "road"
_MOST = {"paths": 8, "traffic lights": 16, "conflicts, each counted on both of its paths": 16}
_MOST_STEP, _MOST_KINK = 2.0, 1.0  # m, rad
_PARAMETERS = ("start_station", "start_lane", "start_offset", "preview_spacing")


class WaySection(Section):
    """A way: ids of roads in order (none: along the segments, else the longest straight on), and its first lane."""

    route: list[str | int] = []
    lane: int = 0


class ToleranceSection(Section):
    """The largest step and kink of a road that is smoothed; what is larger is refused, as it is without this."""

    step: Plain = 0
    kink: Plain = 0


class WaysSection(WaySection, SourceSection):
    """The keys of ``source`` that name ways through the roads of a file."""

    file: str
    paths: dict[str, WaySection] = {}
    tolerance: ToleranceSection | None = None


class RoadSection(WaysSection):
    """The keys of ``source``; *values* and *host* as in a scenario, if the file is one."""

    values: Values = {}
    host: str | None = None


@dataclass(frozen=True, slots=True)
class WrittenWay:
    """A way as it is written: its *name*, ids of *roads*, a *lane* (0: any), and *where* it stands."""

    name: str
    roads: tuple[str, ...]
    lane: int
    where: Location


@dataclass(frozen=True, slots=True)
class RoadSource(Source):
    """*ways* through the roads of *file*, the host's first; *inside* is the workspace.

    The road of a scenario depends on *values* of its parameters, and on its *host*. *tolerated* are the largest step in
    m and kink in rad that are smoothed.
    """

    kind = "road"
    label = "road"

    file: Path
    inside: Path
    ways: tuple[WrittenWay, ...]
    values: tuple[tuple[str, str], ...] = ()
    host: str | None = None
    tolerated: tuple[float, float] = (0.0, 0.0)

    @property
    def is_exact(self) -> bool:
        """Tables integrate nothing."""
        return True


class RoadKind(ComponentKind[RoadSection, RoadSource]):
    """The paths become tables, which the core of the world looks up in."""

    section = RoadSection

    def read(self, section: RoadSection, place: SourcePlace) -> RoadSource:
        """The host's way, and those under ``paths``. The file is opened when it is needed."""
        file = place.file(section.file, (".xodr", ".yaml", ".xosc"), "file")
        if file.suffix == ".xosc":
            _refuse_ways(section, place)
        elif section.values or section.host is not None:
            key = "values" if section.values else "host"
            raise fail(f"'{key}' is for a scenario (.xosc), and '{section.file}' is none", place.at(key))
        values = written_values(section.values)
        ways = written_ways(section, place)
        return RoadSource(file, place.inside, ways, values, section.host, tolerated_of(section, place))

    def build(self, component: Component, source: RoadSource, *, version: int, cache: Path | None) -> Path:
        """The FMU. Raises DseError with what is wrong with the roads and the ways through them."""
        from dse.world import STRUCT, road_files

        files = road_files(_tables(component, source))
        return build_generated(component, files, STRUCT, version=version, cache=cache)

    def check(self, component: Component, source: RoadSource) -> tuple[Problem, ...]:
        """What is ignored or smoothed along the ways, and where they end although their roads go on.

        Raises DseError with what is wrong with the roads and the ways through them.
        """
        tables = _tables(component, source)
        smoothed = [problem for path in tables.paths for problem in path.smoothed]
        return tuple(dict.fromkeys([*smoothed, *_notes(source)]))


def tables_along(source: RoadSource) -> RoadTables:
    """The paths along the ways of *source*. Raises DseError with what is wrong with them and the roads."""
    from dse.world import Tolerance, host_tables, road_tables

    if source.file.suffix == ".xosc":
        return host_tables(_scenario(source), source.ways[0].where)
    return road_tables(roads_of(source), _routes(source), Tolerance(*source.tolerated))


def written_ways(section: WaysSection, place: SourcePlace) -> tuple[WrittenWay, ...]:
    """The host's way, and those under ``paths``."""
    ways = [_way("host", section, place.at("route"))]
    return (*ways, *(_way(name, way, place.at("paths", name)) for name, way in section.paths.items()))


def roads_of(source: RoadSource) -> Network:
    """The roads that its ways lead through. Raises DseError with what is wrong with them."""
    from dse.world import open_roads

    if source.file.suffix == ".xosc":
        network = _scenario(source).network
        if network is None:
            raise fail("the scenario has no road network", source.ways[0].where)
        return network
    return open_roads(str(source.file), Workspace(source.inside))


def tolerated_of(section: WaysSection, place: SourcePlace) -> tuple[float, float]:
    """The step in m and the kink in rad of ``tolerance``."""
    given = section.tolerance or ToleranceSection()
    found = tuple(
        place.number(raw, unit, "tolerance", key)
        for key, raw, unit in (("step", given.step, "m"), ("kink", given.kink, "rad"))
    )
    for key, value, most in zip(("step", "kink"), found, (_MOST_STEP, _MOST_KINK), strict=True):
        if not 0.0 <= value <= most:
            raise fail(f"'{key}' of 'tolerance' is not between 0 and {most:g}", place.at("tolerance", key))
    return found[0], found[1]


def _routes(source: RoadSource) -> list[Route]:
    from dse.world import Route

    return [Route(way.roads, way.lane, way.name, way.where) for way in source.ways]


def _notes(source: RoadSource) -> Iterator[Problem]:
    """What the roads along the ways have that is ignored, and where the ways end in the middle of the network."""
    from dse.world import route_notes

    if source.file.suffix != ".xosc":
        yield from route_notes(roads_of(source), _routes(source))


def _scenario(source: RoadSource) -> Scenario:
    from dse.world import read_scenario

    return read_scenario(source.file, dict(source.values), source.host, source.inside)


def _refuse_ways(section: RoadSection, place: SourcePlace) -> None:
    """The path of a scenario's host follows from where the scenario places it."""
    written = {"route": section.route, "lane": section.lane, "paths": section.paths, "tolerance": section.tolerance}
    key = next((name for name, value in written.items() if value), "")
    if key:
        raise fail(f"'{key}' is not for a scenario: it places its host itself", place.at(key), "leave it out")


def _way(name: str, section: WaySection, where: Location) -> WrittenWay:
    return WrittenWay(name, tuple(map(str, section.route)), section.lane, where)


def _tables(component: Component, source: RoadSource) -> RoadTables:
    raise_if_any(_misfits(component))
    tables = tables_along(source)
    counts = len(tables.paths), sum(len(path.lights) for path in tables.paths), len(tables.conflicts)
    for (what, most), count in zip(_MOST.items(), counts, strict=True):
        if count > most:
            said = f"{count} {what}: a road has at most {most}"
            raise fail(said, source.ways[-1].where, "leave out paths that no vehicle takes")
    lanes = [lane.number for lane in tables.paths[0].lanes]
    start = component.parameter("start_lane")
    if start is not None and start.start not in lanes:
        what = f"'start_lane': the path has no lane {start.start}"
        raise_if_any([Problem(what, start.where, f"possible: {', '.join(map(str, sorted(lanes)))}")])
    return tables


def _misfits(component: Component) -> list[Problem]:
    found = []
    if component.interface.name != _INTERFACE:
        what = f"component '{component.name}': a road implements '{_INTERFACE}', not '{component.interface.name}'"
        found.append(Problem(what, component.where, f"implements: {_INTERFACE}"))
    return found + [
        Problem(f"a road has no parameter '{p.name}'", p.where, closest(p.name, _PARAMETERS))
        for p in component.parameters
        if p.name not in _PARAMETERS
    ]


KIND = RoadKind()
