"""``source: {kind: sumo}``: traffic by SUMO, on the roads of a road component."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from dse.domain.bench import is_multiple
from dse.domain.component import Component
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.kinds._generated import build_generated
from dse.kinds._partner import partner_files
from dse.kinds.road import RoadSource, WaysSection, tables_along, tolerated_of, written_ways
from dse.loading import ComponentKind, Plain, SourcePlace, Workspace

_INTERFACE = "traffic"
_STRUCT = "sumo_traffic"
_PARTNER = "dse.world.sumo.partner"
_STEP, _FINEST = 0.01, 0.001
_PARAMETERS = {
    "seed", "warm_up", "truck_share", "motorcycle_share", "truck_speed", "speed_deviation", "model", "time_gap",
    "standstill_gap", "change_duration", "minds_host", "host_front", "host_rear", "host_width",
}  # fmt: skip


class SumoSection(WaysSection):
    """The keys of ``source``: those of the road, a demand of one's own, and SUMO's step."""

    demand: str | None = None
    step: Plain | None = None


@dataclass(frozen=True, slots=True)
class SumoSource(RoadSource):
    """Traffic on the *ways* of a road: by flows, and by a file with a *demand*; SUMO makes steps of *step* s."""

    kind = "sumo"
    label = "SUMO"

    demand: Path | None = None
    step: float = _STEP
    where: Location | None = None

    @property
    def is_exact(self) -> bool:
        """SUMO integrates."""
        return False


class SumoKind(ComponentKind[SumoSection, SumoSource]):
    """SUMO runs in a process beside that of the run (docs/decisions/0032-sumo.md)."""

    section = SumoSection

    def read(self, section: SumoSection, place: SourcePlace) -> SumoSource:
        """The road's file and ways, as a road component names them. Files are opened when they are needed."""
        file = place.file(section.file, (".xodr", ".yaml"), "file")
        demand = None if section.demand is None else place.file(section.demand, (".xml",), "demand")
        step = _STEP if section.step is None else place.number(section.step, "s", "step")
        if step < _FINEST or not is_multiple(step, _FINEST):
            raise fail(f"SUMO's step is a multiple of 1 ms, not {section.step}", place.at("step"), "step: 10 ms")
        ways = written_ways(section, place)
        tolerated = tolerated_of(section, place)
        where = place.at("file")
        return SumoSource(file, place.inside, ways, tolerated=tolerated, demand=demand, step=step, where=where)

    def build(self, component: Component, source: SumoSource, *, version: int, cache: Path | None) -> Path:
        """The FMU. Raises DseError: SUMO is not here, or cannot read the roads, or nothing leads along a way."""
        resources = _resources(component, source, cache)
        files = partner_files(component, _STRUCT)
        return build_generated(
            component, files, _STRUCT, version=version, cache=cache, partner=_PARTNER, resources=resources
        )

    def check(self, component: Component, source: SumoSource) -> tuple[Problem, ...]:
        """Raise DseError with what is wrong; that SUMO is not here is told, and nothing else."""
        from dse.world import sumo_version

        _check(component, source)
        try:
            sumo_version(component.where)
        except DseError as error:
            return error.problems
        _resources(component, source, None)
        return ()


def _resources(component: Component, source: SumoSource, cache: Path | None) -> dict[str, bytes]:
    """What the simulation reads, by file name."""
    from dse.kinds._partner import asked_names
    from dse.world import opendrive_text, sumo_resources

    _check(component, source)
    tables = tables_along(source)
    parameters, inputs = asked_names(component)
    about = {"parameters": parameters, "inputs": inputs, "step": source.step}
    roads = opendrive_text(str(source.file), Workspace(source.inside))
    found = sumo_resources(roads, tables, about, source.where, cache)
    if source.demand is not None:
        found["demand.rou.xml"] = source.demand.read_bytes()
    return found


def _check(component: Component, source: SumoSource) -> None:
    if not sys.platform.startswith("linux"):
        raise fail("traffic by SUMO runs on Linux only", component.where)
    problems = []
    if component.interface.name != _INTERFACE:
        what = f"component '{component.name}': SUMO implements '{_INTERFACE}', not '{component.interface.name}'"
        problems.append(Problem(what, component.where, f"implements: {_INTERFACE}"))
    flows = {f"flow[{number + 1}]" for number in range(len(source.ways))} if len(source.ways) > 1 else {"flow"}
    wanted = _PARAMETERS | flows
    named = {parameter.name for parameter in component.parameters}
    problems += [
        Problem(f"traffic by SUMO has no parameter '{p.name}'", p.where, closest(p.name, wanted))
        for p in component.parameters
        if p.name not in wanted
    ]
    problems += [
        Problem(f"component '{component.name}': parameter '{p.name}' must not be tunable: SUMO takes it once", p.where)
        for p in component.parameters
        if p.tunable and p.name in wanted
    ]
    if missing := sorted(wanted - named):
        what = f"component '{component.name}': traffic by SUMO also needs {', '.join(map(repr, missing))}"
        problems.append(Problem(what, component.where, "components/traffic/sumo_traffic has them all"))
    raise_if_any(problems)
    if source.demand is not None:
        _check_demand(source.demand)


def _check_demand(path: Path) -> None:
    from dse.formats import read_xml_file, shown

    root = read_xml_file(path, shown(path))
    if root.tag != "routes":
        raise fail(f"<{root.tag}> is not a demand of SUMO", root.where, "a .rou.xml begins with <routes>")


KIND = SumoKind()
