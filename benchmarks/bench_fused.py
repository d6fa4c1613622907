"""Processor time of a run through FMI and in one library, on three benches of the library, and what the library costs.

An ACC car, a motorway pilot in traffic and an emergency brake, each in the first configuration of its study: simulated,
measured and judged as a study does it, waveforms not kept, at the nominal point with other noise each time where there
is any. The two take turns, so that a machine that slows down slows both; the best of all turns is shown. The library is
made anew, without what the cache has; its processor time is that of the compiler (none is known on Windows).
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from dse.domain.noise import DRAW
from dse.domain.run import Outcome, RunRequest
from dse.fmu.fusion.fuse import fuse
from dse.loading.workspace import Workspace
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.runner import Runner
from dse.testbench.selection import proposing, selected
from dse.testbench.study import Preparing

STUDIES = {"acc_gains": 100, "highway_architectures": 5, "aeb_rare": 60}
"""Runs in a turn by study."""

TURNS = 5


def main() -> None:
    workspace = Workspace.around(Path(__file__).parent)
    print("bench                  parts  steps    FMI ms  library ms  ratio  library made in s  pays after runs")
    for name, runs in STUDIES.items():
        study = workspace.study(name)
        if study.sampler.proposes:
            chosen = list(proposing(study).configurations(1))
        else:
            chosen = list(selected(study.bench.design, study.selection, study.where))[:1]
        (bench,) = Preparing(study).benches(chosen).values()
        assert isinstance(bench, PreparedBench)
        simulation = bench.simulation
        with tempfile.TemporaryDirectory(prefix="dse-bench-") as cache:
            before = os.times()
            library = fuse(bench.system, bench.recording.variables, simulation.method, cache=Path(cache))
            made = sum(os.times()[:4]) - sum(before[:4])
            through_fmi, fused = compared((bench, replace(bench, fused=library)), runs)
        print(
            f"{study.bench.name:22} {len(bench.system.elements):5} {simulation.steps:6} {1e3 * through_fmi:9.3f}"
            f" {1e3 * fused:11.3f} {through_fmi / fused:6.2f} {made:18.1f} {made / (through_fmi - fused):16.0f}"
        )


def compared(benches: Sequence[PreparedBench], runs: int) -> list[float]:
    """Seconds of processor time that each of *benches* takes for a run; all compute the same metrics."""
    runners = [Runner(bench) for bench in benches]
    least = [float("inf")] * len(runners)
    for turn in range(TURNS + 1):  # in the first one the reset is proved
        requests = [RunRequest(n, "", {DRAW: n} if DRAW in benches[0].settings else {}) for n in range(runs)]
        metrics = []
        for number, runner in enumerate(runners):
            start = time.process_time()
            made = [runner.run(request, keep=False) for request in requests]
            seconds = (time.process_time() - start) / runs
            assert all(run.outcome is Outcome.DONE for run in made)
            metrics.append(repr([run.metrics for run in made]))
            if turn:
                least[number] = min(least[number], seconds)
        assert len(set(metrics)) == 1
    for runner in runners:
        runner.close()
    return least


if __name__ == "__main__":
    main()
