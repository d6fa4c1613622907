"""A configuration on several benches: the condition `TESTBENCH` of a run says which one it is made on."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace

import numpy as np

from dse.domain.bench import Judgement, Verdict
from dse.domain.component import Kind, Type
from dse.domain.design import Configuration
from dse.domain.noise import DRAW
from dse.domain.run import ERROR_BAR, TESTBENCH, Outcome, Run, RunRequest, Waveforms
from dse.testbench.prepared_bench import PreparedBench, Setting
from dse.testbench.runner import Runner

_MARK = 63
"""The byte of the progress block that tells the bench; the kernel writes the first half of it."""


@dataclass(frozen=True, slots=True)
class PreparedBenches:
    """What `SeveralRunner` simulates: one configuration on *benches*, called *names*.

    A run whose point tells none of them is made on the one with this *number*.
    """

    benches: tuple[PreparedBench, ...]
    names: tuple[str, ...]
    number: int = 0

    @property
    def configuration(self) -> Configuration:
        """What is put on the benches."""
        return self.benches[0].configuration

    @property
    def settings(self) -> dict[str, Setting]:
        """What a point may set: what can be set on every bench, and which one it is. Values are the first one's."""
        shared = shared_settings([bench.settings for bench in self.benches])
        return {**shared, TESTBENCH: Setting("", Type(Kind.ENUMERATION, items=self.names), 0.0)}

    @property
    def constants(self) -> dict[str, float]:
        """The values metrics and targets use: of the first bench, and as ``NAME/part.port`` where NAME's differ."""
        found = {name: setting.value for name, setting in self.settings.items()}
        for label, bench in zip(self.names, self.benches, strict=True):
            found |= {f"{label}/{n}": v for n, v in bench.constants.items() if found.get(n) != v}
        return found

    @property
    def kept(self) -> tuple[str, ...]:
        """The columns stored as waveforms; those that a bench does not have are NaN there."""
        return tuple(dict.fromkeys(name for bench in self.benches for name in bench.recording.kept))

    @property
    def timeout(self) -> float:
        """Seconds a single run may take."""
        return max(bench.timeout for bench in self.benches)

    @property
    def memory(self) -> float:
        """Bytes a worker may be resident with."""
        return max(bench.memory for bench in self.benches)

    @property
    def thread_safe(self) -> bool:
        """Whether several runs may be simulated at once in threads of one process."""
        return all(bench.thread_safe for bench in self.benches)

    @property
    def most_runs(self) -> int | None:
        """How many runs one process may make; None for any number."""
        return min((most for bench in self.benches if (most := bench.most_runs) is not None), default=None)

    def describe_progress(self, block: bytes) -> str:
        """The FMU, call and time a dead or hanging worker was at, and on which bench."""
        number = min(block[_MARK], len(self.benches) - 1)
        return f"{self.benches[number].describe_progress(block)} on {self.names[number]}"


Prepared = PreparedBench | PreparedBenches


def shared_settings(settings: Sequence[Mapping[str, Setting]]) -> dict[str, Setting]:
    """What can be set on every bench, of which *settings* are; the draw if it means something on one of them."""
    first, *others = settings
    shared = {name: setting for name, setting in first.items() if all(name in other for other in others)}
    draws = [each[DRAW] for each in settings if DRAW in each]
    return {**shared, DRAW: draws[0]} if draws else shared


def together(benches: Sequence[PreparedBench], names: Sequence[str]) -> Prepared:
    """One configuration on *benches*: the bench itself where there is one only."""
    return benches[0] if len(benches) == 1 else PreparedBenches(tuple(benches), tuple(names))


def on_bench(prepared: Prepared, number: int) -> Prepared:
    """*prepared* with its runs made on the bench *number* where they do not tell."""
    return replace(prepared, number=number) if isinstance(prepared, PreparedBenches) else prepared


def singly(prepared: Prepared) -> tuple[PreparedBench, ...]:
    """The benches one by one."""
    return prepared.benches if isinstance(prepared, PreparedBenches) else (prepared,)


class SeveralRunner(AbstractContextManager["SeveralRunner"]):
    """Runs one configuration on its benches in this process."""

    def __init__(self, prepared: PreparedBenches, *, progress: memoryview | None = None) -> None:
        self.prepared = prepared
        self._progress = progress
        self._runners: dict[int, Runner] = {}
        self._most = prepared.most_runs
        self._made = 0
        names = {name for bench in prepared.benches for name in bench.program.metrics}
        bars = {f"{name}{ERROR_BAR}" for name in names if prepared.benches[0].simulation.check_step}
        self._metrics = dict.fromkeys(sorted(names | bars), math.nan)
        required = dict.fromkeys(one.name for bench in prepared.benches for one in bench.requirements)
        self._none = {name: Judgement(name, Verdict.NOT_APPLICABLE, math.nan) for name in required}

    @property
    def runs_left(self) -> int | None:
        """How many more runs this process may make of the configuration; None for any number."""
        return None if self._most is None else max(0, self._most - self._made)

    def run(self, request: RunRequest, *, keep: bool) -> Run:
        """Simulate *request* on the bench its point tells; a run that fails is a result."""
        number = int(request.point.get(TESTBENCH, self.prepared.number))
        if self._progress is not None:
            self._progress[_MARK] = number
        self._made += 1
        unused = {TESTBENCH} if DRAW in self.prepared.benches[number].settings else {TESTBENCH, DRAW}
        point = {name: value for name, value in request.point.items() if name not in unused}
        made = self._runner(number).run(replace(request, point=point), keep=keep)
        return replace(
            made,
            request=request,
            # What only other benches ask for is undefined, or does not apply.
            metrics={} if made.outcome is Outcome.FAILED else {**self._metrics, **made.metrics},
            judgements=tuple({**self._none, **{one.requirement: one for one in made.judgements}}.values()),
            waveforms=made.waveforms and self._all_columns(made.waveforms),
        )

    def close(self) -> None:
        """Free the FMU instances."""
        for runner in self._runners.values():
            runner.close()
        self._runners = {}

    def __exit__(self, *_: object) -> None:
        self.close()

    def _runner(self, number: int) -> Runner:
        if number not in self._runners:
            if self._most is not None:  # its FMUs bear few instances: none is kept for a bench that is not used
                self.close()
            self._runners[number] = Runner(self.prepared.benches[number], progress=self._progress)
        return self._runners[number]

    def _all_columns(self, waveforms: Waveforms) -> Waveforms:
        nothing = np.full(len(waveforms.time), np.nan)
        values = {name: waveforms.values.get(name, nothing) for name in self.prepared.kept}
        return Waveforms(waveforms.time, values)


def make_runner(prepared: Prepared, progress: memoryview | None) -> Runner | SeveralRunner:
    """A runner for a worker process; importable by name, so that it can be sent there."""
    if isinstance(prepared, PreparedBenches):
        return SeveralRunner(prepared, progress=progress)
    return Runner(prepared, progress=progress)
