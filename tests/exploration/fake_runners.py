"""Fake benches, executors and studies. Importable by name, as a worker process needs it; imports little."""

from __future__ import annotations

import ctypes
import math
import os
import signal
import stat
import struct
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from definitions import at_most_one, metrics, stored_definition

from dse.domain.bench import VERDICTS, Judgement, Simulation, TestBench, Verdict
from dse.domain.definition import DefinedConfiguration, DefinedSampler, DefinedVariable, StudyDefinition
from dse.domain.design import Compound, DesignSpace
from dse.domain.run import ERROR_BAR, VERDICTS_UNDER, Outcome, Run, RunRequest, Waveforms
from dse.domain.sampler import DesignVariable, Sampler
from dse.domain.study import Keep, Study
from dse.errors import fail
from dse.exploration.samplers.full_factorial import FullFactorial
from dse.units import DIMENSIONLESS

METRICS = tuple(f"m{i}" for i in range(8))
REQUIREMENTS = ("R1", "R2")


@dataclass(frozen=True)
class FakeBench:
    """What happens (*mischief*) in the runs whose number is in *when*; *file* lets it happen only once."""

    name: str
    mischief: str = ""
    when: tuple[int, ...] = ()
    timeout: float = 60.0
    file: Path | None = None
    seconds: float = 0.0
    memory: float = 4e9
    thread_safe: bool = True
    most_runs: int | None = None

    def describe_progress(self, block: bytes) -> str:
        (number,) = struct.unpack_from("=q", block)
        return f"fake: fmi2DoStep of run {number - 1}" if number else ""


DEPENDS_ON = {"clock": time.perf_counter_ns, "process": os.getpid, "counter": count().__next__}
"""What a run's results depend on if that is its bench's mischief; a counter goes on from run to run."""

hoard: list[bytearray] = []
"""Memory that is never freed."""


class FakeRunner:
    """Metrics are simple functions of the point, so that any mistake on their way shows."""

    def __init__(self, bench: FakeBench, progress: memoryview) -> None:
        self.bench = bench
        self.progress = progress
        if bench.mischief == "refuses":
            raise fail("sensor.gap -> controller.speed: units differ", hint="connect another port")
        if bench.mischief == "dies loading":
            sys.stderr.write("cannot open libfake.so\n")
            sys.stderr.flush()
            os._exit(7)
        if bench.mischief == "cannot be loaded once" and bench.file is not None and not bench.file.exists():
            bench.file.touch()
            raise OSError("libfake.so: file too short")
        self.left = bench.most_runs

    @property
    def runs_left(self) -> int | None:
        return self.left

    def run(self, request: RunRequest, *, keep: bool) -> Run:
        bench = self.bench
        if self.left is not None:
            self.left -= 1
        struct.pack_into("=q", self.progress, 0, request.number + 1)
        if bench.seconds:
            time.sleep(bench.seconds)
        if bench.mischief == "takes long" and request.number in bench.when:
            for step in range(10_000):
                struct.pack_into("=q", self.progress, 8, step)
                time.sleep(0.01)
        if bench.mischief == "locks and leaks":
            ctypes.CDLL(None).mlockall(3)  # what is there and what comes
        if bench.mischief in ("leaks", "locks and leaks"):
            hoard.append(bytearray(os.urandom(1)) * 50_000_000)
        if bench.mischief == "leaks files" and request.number in bench.when:
            for _ in range(20):
                os.open(os.devnull, os.O_RDONLY)
        if bench.mischief == "tells its process":
            with (bench.file or Path()).open("a", encoding="utf-8") as file:
                file.write(f"{os.getpid()} {threading.get_ident()}\n")
        first = bench.file is None or bench.mischief == "tells its process" or not bench.file.exists()
        if bench.mischief.startswith("lowers a limit") and request.number not in bench.when:
            os.close(os.dup(0))
        if bench.mischief == "catches signals" and signal.getsignal(signal.SIGUSR1) != signal.SIG_DFL:
            return Run(request, Outcome.FAILED, problem="world: somebody has taken a signal")
        if bench.mischief == "fails after a greedy one":
            try:
                os.close(os.dup(0))
            except OSError:
                return Run(request, Outcome.FAILED, problem="world: cannot read its tables")
        if request.number in bench.when and first:
            if bench.file is not None:
                bench.file.touch()
            self._misbehave(request.number)
        if bench.mischief in ("fails", "is fatal") and request.number in bench.when:
            return Run(request, Outcome.FAILED, problem="world: fmi2DoStep at t = 3.21 s returned error")
        values = [value for value in request.point.values() if isinstance(value, float)]
        total = sum(values)
        drift = 1e-15 if (bench.mischief == "drifts" and keep) or bench.mischief == "drifts otherwise" else 0.0
        if bench.mischief in DEPENDS_ON:
            drift = float(DEPENDS_ON[bench.mischief]())
        metrics = {name: total * (i + 1) + drift for i, name in enumerate(METRICS)}
        metrics["m6"] = math.nan if total > 1.5 else -math.inf
        if bench.mischief == "forgets" and request.number in bench.when:
            del metrics["m3"]
        verdicts = (Verdict.PASS if total < 1.0 else Verdict.FAIL, Verdict.NOT_EXERCISED)
        judgements = tuple(Judgement(n, v, 1.0 - total) for n, v in zip(REQUIREMENTS, verdicts, strict=True))
        # Runs that are made only to compare signals have other numbers.
        recorded = waveforms(0 if bench.mischief in DEPENDS_ON else request.number, drift) if keep else None
        return Run(request, Outcome.DONE, metrics, judgements, "", recorded)

    def close(self) -> None:
        pass

    def _misbehave(self, number: int) -> None:
        match self.bench.mischief:
            case "exits":
                os._exit(3)
            case "prints and exits":
                sys.stderr.write(f"oil is low in run {number}\n")
                sys.stderr.flush()
                os._exit(3)
            case "crashes":
                signal.raise_signal(signal.SIGSEGV)  # in this very thread
            case "is killed":
                os.kill(os.getpid(), signal.SIGKILL)
            case "prints for a second":
                for _ in range(100):
                    sys.stderr.write("x" * 100_000 + "\n")
                    time.sleep(0.01)
            case "forks":
                os.fork()  # and both go on
            case "scribbles":
                scribble(b"garbage garbage garbage ")
            case "stops in a message":
                scribble(b"dse line", only=stat.S_ISSOCK)
                os.kill(os.getpid(), signal.SIGSTOP)
            case "leaves no file to open" | "fails after a greedy one":
                use_up_files()
            case "leaves few files to write":
                lower_limit(3, for_good=True)
            case "hangs":
                time.sleep(3600)
            case "raises":
                raise ValueError(f"bad run {number}")
            case "is fatal":
                self.left = 0
            case "grows":
                hoard.append(bytearray(os.urandom(1)) * 2**30)
                time.sleep(3600)
            case "lowers a limit" | "lowers a limit for good":
                lower_limit(3, for_good=self.bench.mischief.endswith("good"))
            case "catches signals":
                signal.signal(signal.SIGUSR1, lambda *_: None)
            case "aborts later":
                threading.Timer(0.3, os.abort).start()
            case "loses its folder":
                folder = tempfile.mkdtemp()
                os.chdir(folder)
                Path(folder).rmdir()
            case "is stopped":
                os.kill(os.getpid(), signal.SIGSTOP)
            case "terminates":
                for asked in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
                    os.kill(os.getpid(), asked)
            case "eats memory":
                bytearray(1 << 60)


class FakeCheck(FakeRunner):
    """Adds error bars of 0.1, 0.2, …; a variation judges otherwise where the sum of a point is just below 1."""

    def run(self, request: RunRequest, *, keep: bool) -> Run:
        run = super().run(request, keep=keep)
        if run.outcome is Outcome.FAILED:
            return run
        bars = {f"{name}{ERROR_BAR}": 0.1 * (i + 1) for i, name in enumerate(METRICS)}
        flips = 0.85 < run.metrics["m0"] < 1.0
        under = {j.requirement: {j.verdict, Verdict.FAIL} if flips else {j.verdict} for j in run.judgements}
        sums = {f"{n}{VERDICTS_UNDER}": float(sum(1 << VERDICTS.index(v) for v in each)) for n, each in under.items()}
        problem = "with half the step: bumpy" if request.number % 7 == 0 else ""
        return replace(run, metrics={**run.metrics, **bars, **sums}, problem=problem)


def make_check(bench: FakeBench, progress: memoryview) -> FakeCheck:
    return FakeCheck(bench, progress)


def lower_limit(files: int, *, for_good: bool) -> None:
    """Let this process have so many open files; a limit that others can only lower the kernel would leave as it is."""
    import resource

    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (files, files if for_good else hard))


def use_up_files() -> None:
    """Open files until no more can be opened."""
    with suppress(OSError):
        while True:
            os.dup(0)


def scribble(content: bytes, only: Callable[[int], bool] = lambda mode: True) -> None:
    """Write *content* to whatever is open, as what does not know its own files may do."""
    for handle in range(3, 64):
        with suppress(OSError):
            if only(os.fstat(handle).st_mode):
                os.write(handle, content)


def waveforms(number: int, late: float = 0.0) -> Waveforms:
    time_axis = np.linspace(0.0, 1.0, 11)
    gap = np.where(time_axis < 0.45, number, number + late)
    return Waveforms(time_axis, {"world.speed": time_axis * number, "world.gap": gap})


def make_fake(bench: FakeBench, progress: memoryview) -> FakeRunner:
    return FakeRunner(bench, progress)


def study_of(sampler: Sampler | None = None, levels: int = 5, variables: int = 2, **changes: object) -> Study:
    """A study of *variables* from 0 to 1 on an empty bench."""
    bench = TestBench(
        "bench", DesignSpace("design", Compound("design", {})), (), (), {}, Simulation(1.0, 0.1, (), 0.1), (), ()
    )
    varied = tuple(DesignVariable(f"part.x{i}", 0.0, 1.0, levels, 0.3, DIMENSIONLESS) for i in range(variables))
    settings: dict[str, object] = {"keep": Keep.NONE, "seed": 1, **changes}
    return Study("study", bench, varied, sampler or FullFactorial(), **settings)  # type: ignore[arg-type]  # by name


def definition_of(study: Study, configurations: tuple[str, ...] = ("a",), **facts: Any) -> StudyDefinition:
    """The definition of *study* on *configurations*; *facts* are other values of its fields."""
    variables = (
        DefinedVariable(v.name, "", "", v.low, v.high, v.levels, v.nominal, str(v.scale), v.values)
        for v in study.variables
    )
    return stored_definition(
        [DefinedConfiguration(name, {"place": name}) for name in configurations],
        **{
            "study": study.name,
            "variables": tuple(variables),
            "sampler": DefinedSampler(study.sampler.name, study.sampler.options(), study.sampler.grid),
            "seed": study.seed,
            "metrics": metrics(*METRICS),
            "requirements": at_most_one(METRICS[0], *REQUIREMENTS),
            **facts,
        },
    )


def benches(*names: str, **settings: object) -> Mapping[str, FakeBench]:
    return {name: FakeBench(name, **settings) for name in names}  # type: ignore[arg-type]  # by name
