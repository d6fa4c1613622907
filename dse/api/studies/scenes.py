"""A run as a scene to look at: simulated once more, with all that it shows recorded."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dse.errors import Location, fail

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from dse.api.studies.exploring import Tell
    from dse.api.studies.run import Run
    from dse.domain.bench import Simulation, TestBench
    from dse.domain.component import Component
    from dse.report import Ground, Scene

_FRAMES = 25.0
"""In a second: what moves between them is drawn in between."""
_REACH = 700.0


def scene_of(stored: Run, *, source: str | Path | None = None, fmi: int = 2, tell: Tell | None = None) -> Scene:
    """*stored* simulated again, as `replay` does, for the eye.

    Raises DseError if nothing in it says where a car is, or if it does not come to the same metrics again.
    """
    from dse.api.studies.exploring import alone
    from dse.api.studies.replaying import benches_of
    from dse.domain.study import TESTBENCH, Selection
    from dse.report import Scene, Told
    from dse.testbench import bench_study, one_configuration, wire_bench, with_values

    on = int(stored.point.get(TESTBENCH, 0))
    point = {name: value for name, value in stored.point.items() if name != TESTBENCH}
    bench = with_values(benches_of(stored.definition, source)[on], point)
    chosen = one_configuration(bench.design, stored.configuration)
    wired = wire_bench(bench, chosen)
    told = Told(wired.signals, {name: setting.value for name, setting in wired.settings.items()}, bench.figures)
    if not told.is_scene:
        what = "no part of it tells where a car is: there are neither 'motion.x' nor 'position', 'gap' and 'lead.speed'"
        raise fail(f"run {stored.number} of bench '{bench.name}' is no scene: {what}", Location(bench.name))
    again = replace(bench, simulation=_recording(bench, told.wanted))
    made, _ = alone(bench_study(again, Selection((chosen.id,))), fmi, tell=tell)
    if made.waveforms is None or not _is_same(made.metrics, stored.metrics):
        what = f"run {stored.number} did not give the same again"
        raise fail(what, Location(bench.name), f"'dse replay DIR {stored.number}' tells what changed")
    columns = made.waveforms.values
    host = told.host(columns)
    titles = {path: component.title or component.name for path, component in wired.parts.items()}
    return Scene(
        stored.definition.title or stored.definition.study,
        f"run {stored.number}",
        made.waveforms.time,
        _ground(wired.parts.values(), np.column_stack([host.columns["x"], host.columns["y"]])),
        host,
        tuple(told.others(columns)),
        tuple(told.sensors(columns, titles)),
        told.weather(columns),
        tuple(told.instruments(columns)),
    )


def _recording(bench: TestBench, wanted: tuple[str, ...]) -> Simulation:
    """The bench's simulation with the *wanted* signals kept as often as the eye needs."""
    simulation = bench.simulation
    stride = max(round(1 / _FRAMES / simulation.step), 1)
    while simulation.steps % stride:
        stride -= 1
    return replace(simulation, record=wanted, record_every=stride * simulation.step)


def _is_same(made: Mapping[str, float], stored: Mapping[str, float]) -> bool:
    return all(np.array_equal(made.get(name, np.nan), value, equal_nan=True) for name, value in stored.items())


def _ground(parts: Iterable[Component], way: NDArray[np.float64]) -> Ground:
    """The roads around what is driven: those of the part that is a road, or two lanes straight on."""
    from dse.kinds import RoadSource, roads_of
    from dse.report import ground_of, straight_ground

    for component in parts:
        if isinstance(component.source, RoadSource):
            return ground_of(roads_of(component.source), way, _REACH)
    return straight_ground(way, _REACH)
