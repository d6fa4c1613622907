"""OpenSCENARIO files become components of a workspace: the road users, and the road that the host drives."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from dse.domain.component import Component, Interface, Kind, Parameter, Type
from dse.domain.distribution import Distribution
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.formats import shown, write_flow, write_text
from dse.interchange.importing.component import interfaces_of, name_of
from dse.interchange.importing.files import write_new
from dse.interchange.names import free_word
from dse.loading import check_choice, write_component
from dse.units import parse_unit
from dse.world import (
    OWN_PARAMETERS,
    CaseSet,
    Uncertain,
    Variation,
    case_sets,
    cut_off,
    host_tables,
    is_variation,
    read_variation,
    road_files,
)

_INTERFACES = ("scenario", "road")
_TITLES = {
    "drives_host": "true: the scenario drives the host itself",
    "host_front": "from the host's centre of gravity to its front bumper",
}
_FRONT = 2.3  # m, as in the library's other components; assumed


@dataclass(frozen=True, slots=True)
class ImportedTraffic:
    """The component of a scenario that was written to *path*, with that of its *road* by name.

    *road* is "" where the host has no road, which *no_road* explains. *varied* are the values of each parameter that
    the *count* cases vary, in their order; *is_product*: all combinations of these are cases. They are in the table
    *cases*, or for *uncertain* parameters there is none, and a number of *runs*.
    """

    component: Component
    path: Path
    road: str
    no_road: str
    count: int
    varied: Mapping[str, tuple[float, ...]]
    is_product: bool
    cases: Path | None
    uncertain: Mapping[str, Distribution]
    runs: int


@dataclass(frozen=True, slots=True)
class ImportedScenario:
    """What was written: *files* by path, in order, and *traffic* for each set of values that are decided when an FMU is
    built. *ignored* are elements of the file that do not matter to a simulation."""

    files: tuple[Path, ...]
    traffic: tuple[ImportedTraffic, ...]
    ignored: tuple[Problem, ...]


def import_scenario(file: Path, folder: Path, name: str | None = None, host: str | None = None) -> ImportedScenario:
    """Write the scenario in *file*, or that with its cases if it is a distribution of parameters, as components of the
    workspace *folder*; *host* is the entity that the configuration under test drives.

    The scenario, its road network and the catalogues that it uses are copied to ``scenarios/NAME``, where they keep
    their places relative to each other.
    Raises DseError: a scenario that is wrong or not supported, no such interface, a name that cannot be one, files that
    are there already. Nothing is written then.
    """
    variation = read_variation(file) if is_variation(file) else Variation(file, ({},), Location(shown(file)))
    own = name if name is not None else name_of(file, "scenario")
    problems: list[Problem] = []
    check_choice(own, Location(shown(file)), problems)
    known = interfaces_of(folder)
    for interface in _INTERFACES:
        if interface not in known:
            hint = "'dse init' creates a workspace with it: copy it from components/interfaces.yaml there"
            problems.append(Problem(f"the workspace has no interface '{interface}'", Location(shown(folder)), hint))
    raise_if_any(problems)
    sets = case_sets(variation, host)
    scenario = variation.scenario.resolve()
    copies = _copies(scenario, sets, folder / "scenarios" / own)
    place = next(target for target, source in copies.items() if source == scenario)
    writer = _Writer(folder, own, place, variation, host, known)
    written = [writer.traffic(label, each) for label, each in _labelled(own, sets)]
    write_new(writer.texts, copies)
    ignored = dict.fromkeys(problem for each in sets for problem in each.scenario.ignored)
    return ImportedScenario((*copies, *writer.texts), tuple(written), tuple(ignored))


def _copies(scenario: Path, sets: Sequence[CaseSet], target: Path) -> dict[Path, Path]:
    """What each file to write is a copy of. Raises DseError where copies would not find each other."""
    names = {path: name for each in sets for path, name in each.scenario.files.items()}
    problems = []
    for path, name in names.items():
        seen = Path(os.path.normpath(scenario.parent / name.replace("\\", "/")))
        if Path(name).is_absolute() or seen not in (path, path.parent):
            what = f"'{name}' is an absolute path or leads through a link, so that a copy would not find it"
            problems.append(Problem(what, Location(shown(scenario)), "name it by a path relative to the scenario"))
    raise_if_any(problems)
    files = [scenario, *sorted(names)]
    top = os.path.commonpath([file.parent for file in files])
    return {target / file.relative_to(top): file for file in files}


def _labelled(own: str, sets: Sequence[CaseSet]) -> Iterator[tuple[str, CaseSet]]:
    """A name for each set: *own*, with the value that tells it from the others."""
    if len(sets) == 1:
        yield own, sets[0]
        return
    taken: set[str] = set()
    names = sorted({name for each in sets for name in each.values})
    columns = [[each.values.get(name, "") for each in sets] for name in names]
    different = [column for column in columns if len(set(column)) > 1]
    alone = [column for column in different if len(set(column)) == len(sets)]
    chosen = [min(alone, key=lambda column: sum(map(len, column)))] if alone else different
    for number, each in enumerate(sets):
        label = "_".join(name_of(Path(column[number]), "") for column in chosen if column[number])
        taken.add(free := free_word(f"{own}_{label}" if label else own, taken))
        yield free, each


@dataclass(slots=True)
class _Writer:
    """The *texts* of files of the workspace *folder*, by path; *place* is the scenario there.

    *roads* are the names of road components by their C: sets of cases on one road share it.
    """

    folder: Path
    own: str
    place: Path
    variation: Variation
    host: str | None
    known: Mapping[str, Interface]
    texts: dict[Path, str] = field(default_factory=dict)
    roads: dict[str, str] = field(default_factory=dict)

    def traffic(self, name: str, each: CaseSet) -> ImportedTraffic:
        """Add the files of a set of cases. Raises DseError: a parameter starts outside its constraints."""
        columns = {one: tuple(point[one] for point in each.points) for one in each.points[0]}
        varied = {one: column for one, column in columns.items() if len(set(column)) > 1}
        parameters = tuple(_parameters(each, columns, self.variation.uncertain))
        title = f"The road users of {self.variation.scenario.name}"
        component = Component(name, self.known["scenario"], title, None, parameters)
        path = self.folder / "components" / "traffic" / name / "component.yaml"
        self.texts[path] = write_component(component, self._source("scenario", path, each))
        road, no_road = self._road(name, each)
        cases = self.folder / "scenarios" / self.own / f"cases{name.removeprefix(self.own)}.csv" if varied else None
        if cases is not None:
            self.texts[cases] = _table(varied)
        levels = {one: tuple(dict.fromkeys(column)) for one, column in varied.items()}
        is_product = math.prod(map(len, levels.values())) == len(each.points)
        uncertain = {one: found.distribution for one, found in self.variation.uncertain.items()}
        return ImportedTraffic(
            component, path, road, no_road, len(each.points), levels, is_product, cases, uncertain, self.variation.runs
        )

    def _road(self, name: str, each: CaseSet) -> tuple[str, str]:
        """The name of the component of the host's road, or "" and why there is none."""
        try:
            tables = host_tables(each.scenario, None)
        except DseError as error:
            return "", error.problems[0].what
        own = f"{name if self.roads else self.own}_road"
        road = self.roads.setdefault("".join(road_files(tables).values()), own)
        if road == own:
            path = self.folder / "components" / "roads" / own / "component.yaml"
            title = f"The road of {self.variation.scenario.name}"
            made = Component(own, self.known["road"], title, None, tuple(_road_parameters()))
            self.texts[path] = write_component(made, self._source("road", path, each))
        return road, ""

    def _source(self, kind: str, path: Path, each: CaseSet) -> str:
        near = Path(os.path.relpath(self.place.absolute(), path.parent.absolute())).as_posix()
        entries = {"kind": kind, "file": write_text(near)}
        if each.values:
            entries["values"] = write_flow({name: write_text(text) for name, text in sorted(each.values.items())})
        if self.host is not None:
            entries["host"] = write_text(self.host)
        return write_flow(entries)


def _parameters(
    each: CaseSet, columns: Mapping[str, Sequence[float]], uncertain: Mapping[str, Uncertain]
) -> Iterator[Parameter]:
    """Those of the FMU; one that has the same value in all cases starts with it. Raises DseError."""
    flag, front = OWN_PARAMETERS
    metres = Type(Kind.REAL, parse_unit("m"))
    yield Parameter(flag, Type(Kind.BOOLEAN), start=False, title=_TITLES[flag], tunable=False)
    yield Parameter(front, metres, _FRONT, 0.0, 10.0, title=_TITLES[front], tunable=False)
    problems = []
    unknown = uncertain.keys() - {one.name for one in each.scenario.parameters}
    for declared in each.scenario.parameters:
        starts = columns.get(declared.name, (declared.start,))
        one = cut_off(replace(declared, start=starts[0]), uncertain.get(declared.name))
        if not one.allows(one.start):
            problems.append(Problem(f"'{one.name}' is {one.start:g}, which its constraints do not allow", one.where))
        title = "1: true, 0: false" if one.type == "boolean" else ""
        yield Parameter(one.name, Type(Kind.REAL), one.start, one.least, one.most, title=title, tunable=False)
    problems += [Problem(f"'{name}' cannot be uncertain: it is no number that can vary") for name in sorted(unknown)]
    raise_if_any(problems)


def _road_parameters() -> Iterator[Parameter]:
    metres = Type(Kind.REAL, parse_unit("m"))
    alone = "without a scenario: "
    yield Parameter("start_station", metres, 0.0, 0.0, title=f"{alone}station of the host at the start", tunable=False)
    title = "the lane of the host; 1 is the next one to the left"
    yield Parameter("start_lane", Type(Kind.INTEGER), 0, -9, 9, title=title, tunable=False)
    title = f"{alone}from the middle of its lane to the left"
    yield Parameter("start_offset", metres, 0.0, -10.0, 10.0, title=title, tunable=False)
    yield Parameter("preview_spacing", metres, 2.5, 0.0, 100.0, title="of the points ahead; 0 = none")


def _table(columns: Mapping[str, Sequence[float]]) -> str:
    numbers = ([repr(value).removesuffix(".0") for value in row] for row in zip(*columns.values(), strict=True))
    return "".join(",".join(row) + "\n" for row in ([f"traffic.{name}" for name in columns], *numbers))
