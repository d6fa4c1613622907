"""A bench whose halves run in one process, the world's in a thread."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
from background import LIMIT, in_background

from dse.cosim import Simulator
from dse.domain.bench import TestBench
from dse.domain.run import Run, RunRequest
from dse.domain.udp import LinkRole, UdpSource
from dse.loading import Workspace
from dse.testbench import (
    PreparedBench,
    WorldPlace,
    make_runner,
    one_configuration,
    prepare_bench,
    prepare_world,
)

_ROOT = Path(__file__).parents[2]
Parts = tuple[str, ...] | None


def bench_of(name: str, stop: float | None = None, **simulation: object) -> TestBench:
    """A bench of the example workspace, simulated for *stop* s."""
    bench = Workspace.around(_ROOT).bench(name)
    more = simulation if stop is None else {"stop": stop, **simulation}
    return replace(bench, simulation=replace(bench.simulation, **more))


def whole_of(bench: TestBench, cache: Path | None = None) -> PreparedBench:
    chosen = one_configuration(bench.design, None)
    return prepare_bench(bench, [chosen], cache=cache)[chosen.id]


def near_of(bench: TestBench, port: int, parts: Parts, cache: Path | None = None, **source: float) -> PreparedBench:
    chosen = one_configuration(bench.design, None)
    place = WorldPlace(UdpSource(port, **{"timeout": LIMIT, "wait": LIMIT, **source}), parts)
    return prepare_bench(bench, [chosen], cache=cache, world=place)[chosen.id]


def far_of(bench: TestBench, port: int, parts: Parts, cache: Path | None = None) -> PreparedBench:
    chosen = one_configuration(bench.design, None)
    source = UdpSource(port, role=LinkRole.SERVER, timeout=LIMIT, wait=LIMIT)
    return prepare_world(bench, chosen, WorldPlace(source, parts), cache=cache)


def run_of(prepared: PreparedBench) -> Run:
    with make_runner(prepared, None) as runner:
        return runner.run(RunRequest(0, prepared.configuration.id, {}), keep=True)


@contextmanager
def served(far: PreparedBench) -> Iterator[None]:
    """*far* serves until somebody has made a run to the end."""
    simulation = far.simulation

    def serve() -> None:
        with Simulator(far.system, (), method=simulation.method) as simulator:
            simulator.reset_is_trusted = False
            rows = 0
            while rows < 2:
                table = simulator.run(stop=simulation.stop + simulation.step, step=simulation.step)
                rows = len(table)

    with in_background(serve):
        yield


def digest(run: Run) -> str:
    """Of every bit of its metrics and waveforms."""
    found = hashlib.sha256(repr(sorted(run.metrics.items())).encode())
    assert run.waveforms is not None, run.problem
    found.update(run.waveforms.time.tobytes())
    for name, values in sorted(run.waveforms.values.items()):
        found.update(name.encode() + np.ascontiguousarray(values).tobytes())
    return found.hexdigest()
