"""The paper's study with the controller in the shape of Simulink's coder, against the hand-written one, in one sitting.

Every run of `acc_gains` with each controller, metrics and verdicts included, in one process: through FMI calls, and
fused. The contenders take turns of a few runs, so that a machine that slows down slows both; medians are shown.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median

from bench_study import first_ask

from dse.domain.run import Run, RunRequest
from dse.loading.workspace import Workspace
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.runner import Runner
from dse.testbench.study import prepare_study

TURNS, RUNS = 41, 20


def main() -> None:
    study = Workspace.around(Path(__file__).parent).study("acc_gains_coded")
    planned = prepare_study(study)
    asked = first_ask(study, planned.definition)
    for title, benches in (("through FMI", planned.benches), ("fused", prepare_study(study, fuse=True).benches)):
        compare(title, benches, asked)


def compare(title: str, benches: Mapping[str, PreparedBench], asked: Sequence[RunRequest]) -> None:
    """Print the runs per second of each controller; both give the same."""
    names = {bench.configuration.choices["controller"]: name for name, bench in benches.items()}
    runners = {name: Runner(benches[name]) for name in names.values()}
    seconds: dict[str, list[float]] = {name: [] for name in runners}
    for turn in range(TURNS):
        found: list[list[Run]] = []
        for name, runner in runners.items():
            mine = [request for request in asked if request.configuration == name][turn * RUNS : (turn + 1) * RUNS]
            begin = time.perf_counter()
            found.append([runner.run(request, keep=False) for request in mine])
            seconds[name].append(time.perf_counter() - begin)
        one, other = ([(run.metrics, run.judgements) for run in runs] for runs in found)
        assert repr(one) == repr(other)  # as text: what is undefined is NaN
    for runner in runners.values():
        runner.close()
    print(title)
    for controller, name in names.items():
        print(f"  {controller:<13}{RUNS / median(seconds[name][1:]):8.0f} runs/s")
    plain, coded = (median(seconds[names[controller]][1:]) for controller in ("pd_acc", "pd_acc_coded"))
    print(f"  ratio        {plain / coded:8.2f}   (wanted: at least 0.7)")


if __name__ == "__main__":
    main()
