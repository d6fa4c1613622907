"""What a study costs beside its simulations, in one sitting: the paper's study against its kernel alone, and bare rows.

First the paper's study on two workers, from planned benches to a finished folder with metrics stored and waveforms
near the boundary kept, also for later studies, start-up of the workers included; and the same again, when all is known.
Against it the kernel alone: the same runs in two processes that only simulate, start-up not counted. They take turns,
so that a machine that slows down slows both; medians are shown. Then runs that take no time at all, to see what
workers, pipes and the folder can carry.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from statistics import median

from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import DefinedConfiguration, StudyDefinition
from dse.domain.run import Outcome, Run, RunRequest
from dse.domain.study import DesignVariable, Keep, Study
from dse.exploration.executors.local import Local
from dse.exploration.known_runs import NOTHING_KNOWN, KnownRuns
from dse.exploration.loop import explore
from dse.exploration.samplers.full_factorial import FullFactorial
from dse.exploration.scheduler import AskTellScheduler
from dse.exploration.work import MakeRunner, Runnable
from dse.loading.workspace import Workspace
from dse.storage.database.header import StudyHeader
from dse.storage.folder import StudyFolder
from dse.storage.run_store import RunStore
from dse.testbench import make_runner
from dse.testbench.address import address_of
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.runner import Runner
from dse.testbench.study import PreparedStudy, prepare_study

WORKERS = 2
TURNS = 3
ROWS = 100_000


def main() -> None:
    study = replace(Workspace.around(Path(__file__).parent).study("acc_gains"), keep=Keep.NEAR_BOUNDARY)
    planned = prepare_study(study)
    asked = first_ask(study, planned.definition)
    whole, kernel, known = [], [], []
    for _ in range(TURNS):
        kernel.append(kernel_alone(planned, asked))
        with tempfile.TemporaryDirectory(prefix="dse-bench-") as cache:
            for seconds in (whole, known):
                runs = known_runs(planned, Path(cache))
                seconds.append(whole_study(study, planned.benches, planned.definition, make_runner, runs))
    print(f"{study.name}: {len(asked)} runs on {WORKERS} workers, median of {TURNS}")
    print(f"  kernel alone {len(asked) / median(kernel):8.0f} runs/s")
    print(f"  whole study  {len(asked) / median(whole):8.0f} runs/s")
    print(f"  all known    {len(asked) / median(known):8.0f} runs/s")
    print(f"  ratio        {median(kernel) / median(whole):8.2f}   (wanted: at least 0.5)")
    bare = replace(study, sampler=FullFactorial(), variables=tuple(levelled(study)), keep=Keep.NONE)
    definition = replace(
        planned.definition,
        variables=planned.definition.variables[:2],
        configurations=(DefinedConfiguration("nothing"),),
        explored=("nothing",),
    )
    seconds = whole_study(bare, {"nothing": Nothing(definition)}, definition, make_nothing)
    runs = len(first_ask(bare, definition))
    print(f"runs that take no time: {runs} in {seconds:.2f} s, {runs / seconds:.0f} runs/s")


def first_ask(study: Study, definition: StudyDefinition) -> list[RunRequest]:
    """The runs that a new *study* asks for first, numbered from 0."""
    with tempfile.TemporaryDirectory() as scratch, StudyFolder.create(Path(scratch), definition) as folder:
        asking = AskTellScheduler(study, folder)
        asking.ask()
        return list(asking.requests.values())


def known_runs(planned: PreparedStudy, cache: Path) -> KnownRuns:
    """What *cache* has of the runs of *planned*, as `explore_into` has it."""
    addresses = {name: address for name, bench in planned.benches.items() if (address := address_of(bench))}
    kept = {name: bench.recording.kept for name, bench in planned.benches.items()}
    return KnownRuns(RunStore(cache), addresses, StudyHeader(planned.definition).measures, kept)


def whole_study(
    study: Study,
    prepared: Mapping[str, Runnable],
    definition: StudyDefinition,
    make: MakeRunner,
    known: KnownRuns = NOTHING_KNOWN,
) -> float:
    """Seconds from the start of the workers to the last committed row."""
    with (
        tempfile.TemporaryDirectory(prefix="dse-bench-") as scratch,
        StudyFolder.create(Path(scratch) / "study", definition) as folder,
    ):
        start = time.perf_counter()
        summary = explore(study, prepared, folder, executor=Local(workers=WORKERS), make_runner=make, known=known)
        seconds = time.perf_counter() - start
    assert summary.failed == 0
    assert summary.irreproducible == 0
    return seconds


def kernel_alone(planned: PreparedStudy, asked: Sequence[RunRequest]) -> float:
    """Seconds *asked* takes in processes that only simulate, their start-up not counted."""
    share = [asked[worker::WORKERS] for worker in range(WORKERS)]
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        return max(pool.map(simulate_only, [dict(planned.benches)] * WORKERS, share))


def simulate_only(prepared: dict[str, PreparedBench], asked: Sequence[RunRequest]) -> float:
    """Seconds in the kernel for *asked*: no metrics, no waveforms, nothing stored."""
    executors = {name: Runner(bench) for name, bench in prepared.items()}
    seconds = 0.0
    for request in asked:
        bench = prepared[request.configuration]
        start = {bench.settings[name].target: float(value) for name, value in request.point.items()}
        begin = time.perf_counter()
        executors[request.configuration]._simulator.run(  # noqa: SLF001  # the kernel is what is measured
            stop=bench.simulation.stop, step=bench.simulation.step, start=start
        )
        seconds += time.perf_counter() - begin
    for executor in executors.values():
        executor.close()
    return seconds


def levelled(study: Study) -> list[DesignVariable]:
    """Two of the study's variables with as many levels as make about ROWS runs."""
    return [replace(variable, levels=math.isqrt(ROWS)) for variable in study.variables[:2]]


@dataclass(frozen=True)
class Nothing:
    """A bench whose runs take no time."""

    definition: StudyDefinition
    timeout: float = 60.0
    memory: float = 4e9
    thread_safe: bool = True
    most_runs: int | None = None

    def describe_progress(self, block: bytes) -> str:  # noqa: ARG002  # as Runnable has it
        return ""


class NothingRunner:
    """Gives the same metrics at every point."""

    runs_left = None

    def __init__(self, bench: Nothing) -> None:
        self._metrics = {metric.name: 1.5 for metric in bench.definition.metrics}
        self._judgements = tuple(
            Judgement(requirement.name, Verdict.PASS, 0.5) for requirement in bench.definition.requirements
        )

    def run(self, request: RunRequest, *, keep: bool) -> Run:  # noqa: ARG002  # as Runner has it
        return Run(request, Outcome.DONE, self._metrics, self._judgements)

    def close(self) -> None:
        pass


def make_nothing(bench: Nothing, _: memoryview) -> NothingRunner:
    return NothingRunner(bench)


if __name__ == "__main__":
    # Workers import what they are given by its module's name, and this one is called __main__ here.
    import bench_study

    bench_study.main()
