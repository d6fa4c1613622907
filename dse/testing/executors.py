"""What every executor has to be.

class TestMine(ExecutorSuite):
    executor = Mine
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from dse.domain.bench import Judgement, Verdict
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.errors import DseError, fail
from dse.exploration import Batch, Executor, Work, in_words
from dse.loading import EXECUTORS, ExecutorSection
from dse.storage import Attempt, Measures, RowBlock, block_of, write_waveforms

_RUNS, _SIZE = 60, 7


@dataclass(frozen=True, slots=True)
class SmallBench:
    """A bench whose runs are a line of arithmetic; those in *fails* fail, those in *breaks* raise."""

    name: str
    fails: tuple[int, ...] = ()
    breaks: tuple[int, ...] = ()
    loads: bool = True
    timeout: float = 60.0
    memory: float = 4e9
    thread_safe: bool = True
    most_runs: int | None = None

    def describe_progress(self, block: bytes) -> str:
        (number,) = struct.unpack_from("=q", block)
        return f"run {number}"


class SmallRunner:
    """Simulates a `SmallBench`."""

    runs_left = None

    def __init__(self, bench: SmallBench, progress: memoryview) -> None:
        if not bench.loads:
            raise fail("there is no such FMU")
        self._bench = bench
        self._progress = progress

    def run(self, request: RunRequest, *, keep: bool) -> Run:
        """The metric is a function of the point that any mistake on the way would change."""
        number = request.number
        struct.pack_into("=q", self._progress, 0, number)
        if number in self._bench.breaks:
            raise ZeroDivisionError("by the bench")
        if number in self._bench.fails:
            return Run(request, Outcome.FAILED, problem="as the bench defines")
        x = float(request.point["x"])
        metric = math.sin(x) * 1e-3 + len(self._bench.name)
        time = np.linspace(0.0, 1.0, 5)
        waveforms = Waveforms(time, {"y": time * metric}) if keep else None
        judgement = Judgement("R", Verdict.PASS if metric > 1 else Verdict.FAIL, metric - 1)
        return Run(request, Outcome.DONE, {"m": metric}, (judgement,), waveforms=waveforms)

    def close(self) -> None:
        pass


def make_small(bench: SmallBench, progress: memoryview) -> SmallRunner:
    """A runner, importable by name."""
    return SmallRunner(bench, progress)


class Gathered:
    """A sink that remembers; with *stops_after* it interrupts when so many runs are there."""

    def __init__(self, stops_after: int | None = None) -> None:
        self.blocks: list[RowBlock] = []
        self.kept: dict[str, tuple[int, ...]] = {}
        self.ends: list[int] = []
        self.attempts: list[Attempt] = []
        self._stops_after = stops_after

    def rows(self, batch: Batch, block: RowBlock) -> None:
        assert set(block.numbers.tolist()) <= set(batch.numbers)
        self.blocks.append(block)

    def tried(self, attempts: Sequence[Attempt]) -> None:
        assert all(attempt.cause for attempt in attempts)
        self.attempts += attempts

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        self.ends.append(batch.identity)
        if batch.keep:
            self.kept[batch.file] = kept

    def tick(self) -> None:
        if self._stops_after is not None and len(self.results()) >= self._stops_after:
            raise KeyboardInterrupt

    def results(self) -> dict[int, tuple[bool, str, str]]:
        """By run: whether it is done, its numbers to the last bit, and what it failed of."""
        found = {}
        for block in self.blocks:
            for row, number in enumerate(block.numbers.tolist()):
                assert number not in found
                bits = (
                    block.metrics[row].tobytes() + block.margins[row].tobytes() + block.verdicts[row].tobytes()
                ).hex()
                found[number] = bool(block.done[row]), bits, block.problems.get(number, "")
        return found


class ExecutorSuite:
    """Each of the executor's examples makes small runs; the reference makes them in this process."""

    executor: type[ExecutorSection]

    @pytest.fixture
    def made(self, example: Mapping[str, Any]) -> Executor:
        return cast(Executor, self.executor.model_validate(example))

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        if "example" in metafunc.fixturenames:
            metafunc.parametrize("example", self.executor.examples, ids=str)

    def test_it_is_found_by_its_name(self) -> None:
        assert EXECUTORS.get(self.executor.name) is self.executor

    def test_its_options_are_plain_data(self, example: Mapping[str, Any]) -> None:
        options = self.executor.model_validate(example).options()
        assert json.loads(json.dumps(options, allow_nan=False)) == options

    def test_its_results_are_those_of_one_process_bit_for_bit(self, made: Executor, tmp_path: Path) -> None:
        """Runs, failures in words, and files of waveforms, over several configurations and two rounds of work.

        The waveforms of every second batch are kept.
        """
        expected, found = Gathered(), Gathered()
        reference, work = work_in(tmp_path / "expected"), work_in(tmp_path / "found")
        asked = batches(keep=False)
        asked[1::2] = batches(keep=True)[1::2]
        for batch in asked:
            make_here(batch, reference, expected)
        with made.open(work, found) as pool:
            pool.work_off(asked[:4])
            assert len(found.ends) == 4
            pool.work_off(asked[4:])
        assert found.results() == expected.results()
        assert found.kept == expected.kept
        assert sorted(found.ends) == sorted(expected.ends)
        assert files(work.waveforms) == files(reference.waveforms)

    def test_an_interruption_is_passed_on_and_what_came_before_it_counts(self, made: Executor, tmp_path: Path) -> None:
        """Ctrl-C must not be swallowed, and workers do not outlive it."""
        sink = Gathered(stops_after=10)
        with pytest.raises(KeyboardInterrupt), made.open(work_in(tmp_path), sink) as pool:  # noqa: PT012
            pool.work_off(batches(keep=False))
            pool.work_off(batches(keep=False, first=1000))
        assert len(sink.results()) >= 10

    def test_nothing_to_do_is_done_at_once(self, made: Executor, tmp_path: Path) -> None:
        """A finished study costs nothing."""
        sink = Gathered()
        with made.open(work_in(tmp_path), sink) as pool:
            pool.work_off([])
        assert sink.results() == {}


def work_in(folder: Path) -> Work:
    """Four small benches, one of which cannot be loaded; waveforms go into *folder*."""
    folder.mkdir(parents=True, exist_ok=True)
    benches = {
        "plain": SmallBench("plain"),
        "failing": SmallBench("failing", fails=(63, 64)),
        "breaking": SmallBench("breaking", breaks=(125,)),
        "missing": SmallBench("missing", loads=False),
    }
    return Work(benches, make_small, folder, Measures(("m",), ("R",)), folder.with_name(f"{folder.name}.spool"))


def make_here(batch: Batch, work: Work, sink: Gathered) -> None:
    """The runs of *batch* in this process, for comparison: nothing but the runner, and what a failure is called."""
    try:
        runner = make_small(cast(SmallBench, work.configurations[batch.configuration]), memoryview(bytearray(64)))
    except DseError as error:
        runs = [Run(request, Outcome.FAILED, problem=str(error)) for request in batch.requests]
    else:
        runs = [_made(runner, request, batch) for request in batch.requests]
    kept = [(run.request.number, run.waveforms) for run in runs if run.waveforms is not None]
    if kept:
        write_waveforms(work.waveforms / batch.file, kept)
    sink.rows(batch, block_of(runs, work.measures))
    sink.ended(batch, tuple(number for number, _ in kept))


def _made(runner: SmallRunner, request: RunRequest, batch: Batch) -> Run:
    try:
        return runner.run(request, keep=batch.keep)
    except ZeroDivisionError as error:
        return Run(request, Outcome.FAILED, problem=in_words(error))


def batches(*, keep: bool, first: int = 0) -> list[Batch]:
    """Batches of each configuration of `work_in`, of 60 runs each, numbered from *first*."""
    found = []
    for index, name in enumerate(("plain", "failing", "breaking", "missing")):
        for start in range(0, _RUNS, _SIZE):
            numbers = tuple(first + index * _RUNS + n for n in range(start, min(start + _SIZE, _RUNS)))
            file = f"runs-{numbers[0]:08d}-{numbers[-1]:08d}.parquet" if keep else ""
            requests = tuple(RunRequest(number, name, {"x": number * 0.1}) for number in numbers)
            found.append(Batch(numbers[0], name, requests, file))
    return found


def files(folder: Path) -> dict[str, bytes]:
    """Every file in *folder*."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
