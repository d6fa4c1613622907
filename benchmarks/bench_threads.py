"""Runs of one configuration in one process: by one thread, and by two at once, as a worker makes them.

Each run is simulated, measured and judged. The two take turns, so that a machine that slows down slows both; medians
are shown. Needs two processors with nothing else to do.
"""

from __future__ import annotations

import pickle
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from bench_study import first_ask

from dse.exploration.supervision.guarded_runner import GuardedRunner
from dse.exploration.supervision.heartbeat import Heartbeat
from dse.exploration.supervision.messages import Setup
from dse.exploration.supervision.worker import simulate
from dse.exploration.work import Batch
from dse.loading.workspace import Workspace
from dse.storage.rows import Measures
from dse.testbench import make_runner
from dse.testbench.study import prepare_study

RUNS = 600
TURNS = 5


def main() -> None:
    study = Workspace.around(Path(__file__).parent).study("acc_gains")
    planned = prepare_study(study)
    asked = first_ask(study, planned.definition)
    name = asked[0].configuration
    batch = Batch(0, name, tuple(request for request in asked if request.configuration == name)[:RUNS])
    prepared = planned.benches[batch.configuration]
    assert prepared.thread_safe
    sys.setswitchinterval(1e-4)  # as a worker with threads does
    with tempfile.TemporaryDirectory(prefix="dse-bench-") as scratch:
        folder = Path(scratch)
        measures = Measures(tuple(metric.name for metric in study.bench.metrics))
        setup = Setup(make_runner, folder, folder, folder, measures, threads=2)
        setup.file(batch.configuration).write_bytes(pickle.dumps(prepared))
        Heartbeat.lay_out(folder / "beat", 2)
        runners = [GuardedRunner(setup, Heartbeat(folder / "beat", thread)) for thread in range(2)]
        rates: dict[int, list[float]] = {1: [], 2: []}
        results = {}
        for threads in (1, 2):
            results[threads] = sorted(
                (run.request.number, *run.metrics.values()) for run, _ in simulate(batch, runners[:threads])
            )
        assert repr(results[1]) == repr(results[2])
        for _ in range(TURNS):
            for threads, measured in rates.items():
                measured.append(rate(batch, runners[:threads]))
    one, two = median(rates[1]), median(rates[2])
    print(f"{len(batch.requests)} runs of {prepared.simulation.steps} steps in one process, median of {TURNS}")
    print(f"  one thread  {one:8.0f} runs/s")
    print(f"  two threads {two:8.0f} runs/s")
    print(f"  ratio       {two / one:8.2f}   (wanted: at least 1.8)")


def rate(batch: Batch, runners: Sequence[GuardedRunner]) -> float:
    """Runs per second."""
    start = time.perf_counter()
    done = sum(1 for _ in simulate(batch, runners))
    return done / (time.perf_counter() - start)


if __name__ == "__main__":
    main()
