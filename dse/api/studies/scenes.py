"""A run as a scene to look at: simulated once more, with all that it shows recorded."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dse.errors import Location, fail
from dse.scratch import ScratchFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from numpy.typing import NDArray

    from dse.api.studies.run import Run
    from dse.api.studies.single_run import Tell
    from dse.domain.bench import Simulation, TestBench
    from dse.domain.component import Component
    from dse.domain.run import Waveforms
    from dse.report import Ground, LiveScene, Scene, SceneSignals, Trace
    from dse.testbench import PreparedStudy, WiredBench

    Floats = NDArray[np.float64]

_FRAMES = 25.0
"""In a second: what moves between them is drawn in between."""
_REACH = 700.0


def scene_of(
    stored: Run,
    *,
    source: str | Path | None = None,
    near: str | Path = "",
    workspace: Path | None = None,
    fmi: int = 2,
    tell: Tell | None = None,
) -> Scene:
    """*stored* simulated again, as `replay` does, for the eye.

    Its study is taken from the file *source*, else from *workspace*, else as `in_workspace` does for the folder *near*.
    Raises DseError if nothing in it says where a car is, or if it does not come to the same metrics again.
    """
    with ScratchFolder() as scratch:
        made = _made_again(_bench_of(stored, source, Path(near), workspace, Path(scratch)), stored, fmi, tell)
        return made.scene(made.waveforms.values, made.waveforms.time)


def trace_of(
    stored: Run,
    *,
    source: str | Path | None = None,
    near: str | Path = "",
    rate: float,
    tell: Tell | None = None,
    check: Callable[[SceneSignals], object] = lambda _: None,
) -> Trace:
    """*stored* simulated again as `scene_of` does, with all signals, *rate* times a second or at the nearest rate above
    that the steps allow. Before that, *check* may refuse it. Raises DseError as `scene_of` does."""
    from dse.report import Trace, rear_axle_of

    with ScratchFolder() as scratch:
        bench = _bench_of(stored, source, Path(near), None, Path(scratch))
        made = _made_again(bench, stored, 2, tell, rate=rate, for_trace=True, check=check)
        values = made.waveforms.values
        signals = {name: values[name] for name in made.wired.signals if name in values}
        rear_axle = rear_axle_of(made.told.settings)
        figures = {figure.title or figure.name: (figure.current, figure.target) for figure in made.told.figures}
        plots = {title: tuple(end for end in ends if end in signals) for title, ends in figures.items()}
        shown = {title: ends for title, ends in plots.items() if ends}
        return Trace(made.scene(values, made.waveforms.time), signals, made.wired.signals, rear_axle, shown)


def scene_page_of(
    stored: Run,
    *,
    source: str | Path | None = None,
    near: str | Path = "",
    workspace: Path | None = None,
    live: bool = False,
    tell: Tell | None = None,
) -> str:
    """The page of *stored* in three dimensions, from `scene_of`; a *live* one can be driven on by its reader.

    Raises DseError as `scene_of` does, and naming all that cannot be in a live page.
    """
    from dse.report import scene_page

    if not live:
        return scene_page(scene_of(stored, source=source, near=near, workspace=workspace, tell=tell))
    with ScratchFolder() as scratch:
        made = _made_again(_bench_of(stored, source, Path(near), workspace, Path(scratch)), stored, 2, tell)
        return scene_page(made.scene(made.waveforms.values, made.waveforms.time), _live(made, tell))


def _bench_of(stored: Run, source: str | Path | None, near: Path, workspace: Path | None, scratch: Path) -> TestBench:
    """The bench as it was simulated for *stored*; what was driven by somebody lies as a table in *scratch*."""
    from dse.api.studies.provenance import benches_near, in_workspace
    from dse.api.studies.replay import NOBODY, bench_driven, benches_of, drive_name, is_drives, recording
    from dse.domain.run import TESTBENCH
    from dse.testbench import with_values

    if is_drives(stored.definition):
        name, of = drive_name(stored.definition, stored.point), stored.definition.bench.name
        bench = in_workspace(near, lambda found: found.bench(of, Location(of)), workspace)
        return bench if name == NOBODY else bench_driven(recording(near, name), bench, scratch)
    on = int(stored.point.get(TESTBENCH, 0))
    point = {name: value for name, value in stored.point.items() if name != TESTBENCH}
    found = benches_of(stored.definition, source) if source else benches_near(stored.definition, near, workspace)
    return with_values(found[on], point)


@dataclass(frozen=True, slots=True)
class _Made:
    """*stored* simulated again as *planned* on *bench*, with all signals recorded that *told* finds for a scene."""

    stored: Run
    bench: TestBench
    wired: WiredBench
    told: SceneSignals
    planned: PreparedStudy
    waveforms: Waveforms

    def scene(self, columns: Mapping[str, Floats], time: Floats) -> Scene:
        """The scene of *columns*, with the ground that belongs to the run."""
        host = self.told.host(self.waveforms.values).columns
        way = np.column_stack([host["x"], host["y"]])
        known = self.stored.definition
        scene = scene_of_signals(self.wired, self.told, columns, time, way=way)
        subtitle = f"run {self.stored.number}"
        return replace(scene, title=known.title or known.study, subtitle=subtitle, mark=mark_of(self.stored))


def _made_again(
    bench: TestBench,
    stored: Run,
    fmi: int,
    tell: Tell | None,
    *,
    rate: float = _FRAMES,
    for_trace: bool = False,
    check: Callable[[SceneSignals], object] = lambda _: None,
) -> _Made:
    from dse.api.studies.single_run import alone
    from dse.domain.study import Selection
    from dse.report import SceneSignals
    from dse.testbench import bench_study, one_configuration, wire_bench

    chosen = one_configuration(bench.design, stored.configuration)
    wired = wire_bench(bench, chosen)
    settings = {name: setting.value for name, setting in wired.settings.items()}
    told = SceneSignals(wired.signals, settings, bench.figures, for_trace)
    if not told.is_scene:
        what = "no part gives the position of a car: neither 'motion.x' nor 'position', 'gap' and 'lead.speed'"
        raise fail(f"run {stored.number} of bench '{bench.name}' is not a scene: {what}", Location(bench.name))
    check(told)
    again = replace(bench, simulation=recording(bench, told.wanted, rate))
    made, planned = alone(bench_study(again, Selection.of((chosen,))), fmi, tell=tell)
    if made.problem and stored.is_done:
        what = f"run {stored.number} failed this time: {made.problem}"
        raise fail(what, Location(bench.name), f"'dse replay DIR {stored.number}' lists what changed")
    if made.waveforms is None or not _is_same(made.metrics, stored.metrics):
        what = f"run {stored.number} did not give the same again"
        raise fail(what, Location(bench.name), f"'dse replay DIR {stored.number}' lists what changed")
    return _Made(stored, again, wired, told, planned, made.waveforms)


def _live(made: _Made, tell: Tell | None) -> LiveScene:
    from dse.api.studies.page_simulation import OnBench, simulation_of
    from dse.domain.noise import DRAW
    from dse.report import LiveScene
    from dse.testbench import singly

    ((prepared,),) = map(singly, made.planned.benches.values())
    draws = (float(made.stored.point.get(DRAW, 0.0)),)
    names = made.told.wanted
    on = OnBench(0, prepared, made.bench)
    simulation = simulation_of(made.stored.definition, [on], draws, also=frozenset(names), tell=tell)
    # All that is to be seen is a sum of signals and a constant: that of none, and of each alone, tells which.
    alone = np.vstack([np.zeros(len(names)), np.eye(len(names))])
    sums = made.scene(dict(zip(names, alone.T, strict=True)), np.arange(len(alone), dtype=np.float64))
    return LiveScene(sums, names, simulation)


def scene_of_signals(
    wired: WiredBench,
    told: SceneSignals,
    columns: Mapping[str, Floats],
    time: Floats,
    *,
    way: Floats | None = None,
    reach: float = _REACH,
) -> Scene:
    """The scene of *wired* at each *time* (s), of what is *told* by the signals in *columns*.

    Roads are drawn as far as *reach* (m) beside the *way* (points, m) that is driven: that of the car.
    """
    from dse.kinds import RoadSource, tables_along
    from dse.report import Scene

    host = told.host(columns)
    titles = {path: component.title or component.name for path, component in wired.parts.items()}
    road = wired.parts[told.road].source if told.road else None
    ids = [light.id for way in tables_along(road).paths for light in way.lights] if isinstance(road, RoadSource) else []
    driven = np.column_stack([host.columns["x"], host.columns["y"]]) if way is None else way
    return Scene(
        wired.bench.title or wired.bench.name,
        "",
        time,
        _ground(wired.parts.values(), driven, reach),
        host,
        tuple(told.others(columns)),
        tuple(told.sensors(columns, titles)),
        told.weather(columns),
        tuple(told.instruments(columns)),
        told.lights(columns, ids),
        told.driver(columns),
    )


def mark_of(stored: Run) -> str:
    """A digest of all that the scene of *stored* comes of: another run, other results or another dse have another."""
    from dse import __version__
    from dse.report import bundle

    run, known = stored.noun, stored.definition
    of_run = run.request.number, run.request.configuration, sorted(run.request.point.items())
    metrics = sorted((name, float(value)) for name, value in run.metrics.items())
    of_study = known.title, known.study, known.bench, known.simulation, known.figures, sorted(known.fmus.items())
    of_page = __version__, bundle("scene.js"), bundle("scene.css")
    return sha256(repr((of_run, metrics, of_study, of_page)).encode()).hexdigest()


def replay_file(folder: Path, run: int) -> Path:
    """Where in *folder* the replay of a run lies, if one was written."""
    return folder / "replays" / f"run_{run}.html"


def replays_in(folder: Path) -> Iterator[int]:
    """Numbers of the runs whose replays lie in *folder*, in order, whatever they were made of."""
    names = (re.fullmatch(r"run_(0|[1-9]\d{0,8})\.html", path.name) for path in (folder / "replays").glob("run_*.html"))
    yield from sorted(int(name[1]) for name in names if name)


def recording(bench: TestBench, wanted: tuple[str, ...], rate: float) -> Simulation:
    """The bench's simulation with the *wanted* signals kept *rate* times a second, or a little more often."""
    simulation = bench.simulation
    stride = max(round(1 / rate / simulation.step), 1)
    while simulation.steps % stride:
        stride -= 1
    return replace(simulation, record=wanted, record_every=stride * simulation.step)


def _is_same(made: Mapping[str, float], stored: Mapping[str, float]) -> bool:
    return all(np.array_equal(made.get(name, np.nan), value, equal_nan=True) for name, value in stored.items())


def _ground(parts: Iterable[Component], way: Floats, reach: float) -> Ground:
    """The roads within *reach* of what is driven: those of the part that is a road, or two lanes straight on."""
    from dse.kinds import RoadSource, roads_of
    from dse.report import ground_of, straight_ground

    for component in parts:
        if isinstance(component.source, RoadSource):
            return ground_of(roads_of(component.source), way, reach)
    return straight_ground(way, _REACH)
