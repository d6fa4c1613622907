"""OpenSCENARIO files at the front door: played by themselves, and as pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dse.api.studies.run import Waveforms
from dse.api.studies.single_run import prepare_once
from dse.domain.bench import Simulation, TestBench, TestComponent
from dse.domain.component import Component, Parameter, Type, Value
from dse.domain.design import Compound, DesignSpace
from dse.domain.run import Waveforms as Recorded
from dse.errors import Location, fail
from dse.formats import shown
from dse.kinds import ScenarioSource
from dse.loading import Workspace
from dse.world import OWN_PARAMETERS, read_scenario

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from dse.api.studies.single_run import Tell
    from dse.interchange import DrivenEntity
    from dse.loading import Raw
    from dse.report import Host, RoadPicture
    from dse.world import Scenario

_PART = "scenario"
_POSE = {"x": ("station", "m"), "y": ("offset", "m"), "heading": ("turn", "rad"), "speed": ("speed", "m/s")}
_MOST_STATES = 256


@dataclass(frozen=True, slots=True, eq=False)
class PlayedScenario:
    """A scenario after a run in which it drove every entity.

    *poses* are ``ENTITY.x``, ``.y`` (of the middle of its box, in m), ``.heading`` (rad) and ``.speed`` (m/s) over
    *time* (s), NaN where an entity is not there. *began* and *completed* are times of elements of the storyboard by
    name, in s. *ended* is the time of the stop trigger; None: it did not come.
    """

    scenario: Scenario
    time: NDArray[np.float64]
    poses: Mapping[str, NDArray[np.float64]]
    began: Mapping[str, float]
    completed: Mapping[str, float]
    ended: float | None

    @property
    def waveforms(self) -> Waveforms:
        """The poses, to be written or converted."""
        units = {name: _POSE[name.rpartition(".")[2]][1] for name in self.poses}
        return Waveforms(Recorded(self.time, self.poses), units)


def play_scenario(
    path: Path,
    content: Path,
    settings: Mapping[str, str],
    *,
    stop: float = 60.0,
    step: float = 0.01,
    sandbox: bool = False,
    tell: Tell | None = None,
) -> PlayedScenario:
    """The OpenSCENARIO file at *path* with values of its parameters, for at most *stop* s in steps of *step* s.

    *content* is a folder with the program's component library. The run counts until the stop trigger. Raises DseError:
    what is wrong in the file or not supported, an unknown parameter, a run that fails, or a position that is no number.
    """
    scenario = read_scenario(path)
    tuned = {each.name for each in scenario.parameters}
    given = {name: text for name, text in settings.items() if name not in tuned}
    if given:
        scenario = read_scenario(path, given)
    values: dict[str, Value] = {}
    for name in tuned & settings.keys():
        try:
            values[name] = float(settings[name])
        except ValueError as error:
            raise fail(f"'{name}' is '{settings[name]}', not a number", Location(shown(path))) from error
    bench = _bench(scenario, path, content, given, values, stop, step)
    if tell is not None:
        tell("building the scenario")
    run = prepare_once(bench, None, {}, sandbox=sandbox, tell=tell).simulate(sandbox=sandbox)
    if run.problem or run.waveforms is None:
        raise fail(f"the scenario failed to run: {run.problem}", Location(shown(path)))
    recorded: Mapping[str, NDArray[np.float64]] = run.waveforms
    time = run.waveforms.time
    seen_by = _first(recorded[f"{_PART}.ended"] > 0.5)
    last = None if seen_by is None else max(seen_by - 1, 0)  # triggers are evaluated before the step
    rows = slice(0, len(time) if last is None else last + 1)
    poses: dict[str, NDArray[np.float64]] = {}
    undefined: dict[int, str] = {}
    began: dict[str, float] = {}
    completed: dict[str, float] = {}
    for number, name in enumerate(scenario.entities, 1):
        seen = recorded[f"{_PART}.everyone[{number}].class"] > 0
        for label, (port, _) in _POSE.items():
            column = recorded[f"{_PART}.everyone[{number}].{port}"]
            poses[f"{name}.{label}"] = np.where(seen, column, np.nan)[rows]
            if (row := _first(np.isnan(column[rows]))) is not None:
                undefined.setdefault(row, name)
    if undefined:
        row = min(undefined)
        what = f"entity '{undefined[row]}' has no position from {time[row]:g} s on"
        if row == 0:
            what = "an expression of the scenario has no finite value with these parameters"
        raise fail(what, Location(shown(path)))
    for number, element in enumerate(scenario.elements[:_MOST_STATES], 1):
        states = recorded[f"{_PART}.states[{number}]"][rows]
        for times, reached in ((began, states >= 1), (completed, states >= 2)):
            if (row := _first(reached)) is not None:
                times.setdefault(element.name, float(time[row]))
    return PlayedScenario(scenario, time[rows], poses, began, completed, None if last is None else float(time[last]))


def scenario_picture(played: PlayedScenario, title: str) -> RoadPicture:
    """The roads of a scenario with the paths of its entities. Raises DseError: it has no road network."""
    from dse.report import road_picture, with_driven

    network = played.scenario.network
    if network is None:
        raise fail(f"'{title}' has no road network to draw")
    picture = road_picture(network, title)
    for name in played.scenario.entities:
        x, y = played.poses[f"{name}.x"], played.poses[f"{name}.y"]
        there = np.isfinite(x)
        if np.any(there):
            picture = with_driven(picture, network, name, x[there], y[there])
    return picture


def _bench(
    scenario: Scenario,
    path: Path,
    content: Path,
    given: Mapping[str, str],
    values: Mapping[str, Value],
    stop: float,
    step: float,
) -> TestBench:
    interface = dict(Workspace(content).interfaces).get(_PART)
    if interface is None:
        raise fail(f"{shown(content)} has no interface '{_PART}'")
    real = Type(interface.port("movers[1].speed").type.kind)  # type: ignore[union-attr]
    flag = Type(interface.port("ended").type.kind)  # type: ignore[union-attr]
    front, drives = OWN_PARAMETERS[1], OWN_PARAMETERS[0]
    parameters = [
        Parameter(drives, flag, True, tunable=False),
        Parameter(front, real, 0.0, tunable=False),
        *(Parameter(each.name, real, each.start, tunable=False) for each in scenario.parameters),
    ]
    source = ScenarioSource(path.resolve(), None, tuple(sorted(given.items())), None, Location(shown(path)))
    component = Component("scenario", interface, path.stem, source, tuple(parameters), where=Location(shown(path)))
    record = [f"{_PART}.ended", *(f"{_PART}.states[{n + 1}]" for n in range(min(len(scenario.elements), _MOST_STATES)))]
    for number in range(1, len(scenario.entities) + 1):
        ports = ("class", *(port for port, _ in _POSE.values()))
        record += [f"{_PART}.everyone[{number}].{port}" for port in ports]
    simulation = Simulation(stop, step, tuple(record), step)
    design = DesignSpace("nothing", Compound("nothing", {}))
    return TestBench(path.stem, design, (TestComponent(_PART, component, values),), (), {}, simulation, (), ())


def _first(condition: NDArray[np.bool_]) -> int | None:
    rows = np.flatnonzero(condition)
    return int(rows[0]) if len(rows) else None


def element_times(
    played: PlayedScenario, kinds: Sequence[str] = ("act", "event")
) -> list[tuple[str, str, float | None, float | None]]:
    """Kind, name, and times of start and completion of the storyboard's elements of these *kinds*, in order."""
    return [
        (each.kind, each.name.rpartition("/")[2], played.began.get(each.name), played.completed.get(each.name))
        for each in played.scenario.elements
        if each.kind in kinds
    ]


def export_scenario(
    bench: TestBench,
    configuration: str | None,
    settings: Mapping[str, Raw],
    target: Path,
    *,
    tell: Tell | None = None,
    warn: Tell | None = None,
) -> tuple[str, int]:
    """Write a run of a bench as an OpenSCENARIO file, with its road beside it as OpenDRIVE.

    Every road user follows its driven path. Returns the id of the configuration, and how many entities there are;
    *warn* receives each doubt about the size of the host. Raises DseError: the bench has no road or no chassis, or the
    run fails.
    """
    from dse.api.studies.scenes import recording
    from dse.interchange import scenario_text
    from dse.report import SceneSignals
    from dse.scratch import write_whole
    from dse.testbench import one_configuration, wire_bench, with_settings

    chosen = one_configuration(bench.design, configuration)
    wired = wire_bench(with_settings(bench, settings, chosen), chosen)
    values = {name: setting.value for name, setting in wired.settings.items()}
    scene = SceneSignals(wired.signals, values, ())
    interfaces = {component.interface.name for component in wired.parts.values()}
    if missing := [name for name in ("road", "chassis") if name not in interfaces]:
        raise fail(f"the bench has no part with the interface '{missing[0]}'", bench.where)
    road_text = _opendrive(wired.parts[scene.road])
    kept = replace(bench, simulation=recording(bench, scene.wanted, _RATE))
    run = prepare_once(kept, chosen.id, settings, tell=tell).simulate()
    if run.problem or run.waveforms is None:
        raise fail(f"the run failed: {run.problem}", bench.where)
    host = scene.host(run.waveforms)
    if warn:
        for doubt in host.doubts:
            warn(doubt)
    entities = _entities(host, scene.others(run.waveforms), run.waveforms.time)
    roads = target.with_suffix(".xodr")
    write_whole(roads, road_text)
    write_whole(target, scenario_text(entities, roads.name, f"{bench.name}, configuration {chosen.id}"))
    return chosen.id, len(entities)


_RATE = 10.0  # poses per second


def _entities(
    host: Host, others: Iterable[Mapping[str, NDArray[np.float64]]], time: NDArray[np.float64]
) -> list[DrivenEntity]:
    from dse.interchange import DrivenEntity

    own, ahead = host.columns, host.front - host.length / 2
    x, y = own["x"] + ahead * np.cos(own["heading"]), own["y"] + ahead * np.sin(own["heading"])
    found = [DrivenEntity("Ego", 1, (host.length, host.width, host.height), time, x, y, own["z"], own["heading"])]
    for actor in others:
        changes = np.flatnonzero(np.diff(actor["id"]) != 0) + 1
        for rows in np.split(np.arange(len(time)), changes):
            first = int(rows[0])
            if actor["class"][first] == 0 or len(rows) < 2:
                continue
            size = (float(actor["length"][first]), float(actor["width"][first]), float(actor["height"][first]))
            name = f"Actor{int(actor['id'][first])}"
            name = name if all(each.name != name for each in found) else f"{name}_{first}"
            poses = (np.asarray(actor[port][rows]) for port in ("x", "y", "z", "heading"))
            found.append(DrivenEntity(name, int(actor["class"][first]), size, time[rows], *poses))
    return found


def _opendrive(component: Component) -> str:
    """The roads of a road component as OpenDRIVE. Raises DseError where its kind has none."""
    from dse.kinds import RoadSource
    from dse.world import opendrive_text

    source = component.source
    if not isinstance(source, RoadSource):
        raise fail(f"component '{component.name}' is not of the kind 'road'", component.where)
    file = source.file
    if file.suffix.lower() == ".xosc":
        scenario = read_scenario(file, dict(source.values), source.host, source.inside)
        file = next(path for path in scenario.files if path.suffix.lower() != ".xosc")
    return opendrive_text(str(file), Workspace(source.inside)).decode()
