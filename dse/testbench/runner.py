"""Simulate, measure, judge: one request → one run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import AbstractContextManager

import numpy as np
from numpy.typing import NDArray

from dse.cosim import RunFailed, Simulator
from dse.domain.component import as_number
from dse.domain.noise import DRAW
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.metrics import judge_failed
from dse.testbench.comparison import Comparison
from dse.testbench.prepared_bench import PreparedBench


class Runner(AbstractContextManager["Runner"]):
    """Runs one configuration again and again in this process, its FMUs loaded once."""

    def __init__(self, prepared: PreparedBench, *, progress: memoryview | None = None) -> None:
        self.prepared = prepared
        self._simulator = Simulator(
            prepared.system,
            prepared.recording.variables,
            method=prepared.simulation.method,
            progress=progress,
            facts=prepared.facts,
            fused=prepared.fused,
        )
        simulation = prepared.simulation
        self._time: NDArray[np.float64] = np.arange(simulation.steps + 1, dtype=np.float64) * simulation.step
        self._comparison = Comparison(prepared, self._simulator, progress) if simulation.check_step else None
        self._constants = prepared.constants
        self._columns = prepared.recording.columns
        # Both are used for every run: to get memory anew costs as much as what is done with it.
        self._table: NDArray[np.float64] | None = None
        self._rows: NDArray[np.float64] | None = None

    @property
    def runs_left(self) -> int | None:
        """How many more runs this process may make of the configuration; None for any number."""
        left, each = self._simulator.runs_left, 1 + len(self.prepared.checks.variations)
        return left if left is None else (left + each - 1) // each

    def run(self, request: RunRequest, *, keep: bool) -> Run:
        """Simulate *request*; a run that fails is a result, not an exception. Waveforms come only with *keep*."""
        prepared, simulation = self.prepared, self.prepared.simulation
        start = {}
        constants = dict(self._constants)
        for name, value in request.point.items():
            constants[name] = as_number(value, prepared.settings[name].type)
            start[prepared.settings[name].target] = constants[name]
        if DRAW in request.point:
            del start[prepared.settings[DRAW].target]
            for stream in prepared.streams:
                if stream.name not in request.point:
                    start[prepared.settings[stream.name].target] = stream.seed(constants[DRAW])
        for name, follows in prepared.derived.items():
            value = float(follows.rows({given: np.array([constants[given]]) for given in follows.names})[0])
            if not math.isfinite(value):
                problem = f"{name} is derived from this point as {value}"
                return Run(request, Outcome.FAILED, {}, judge_failed(prepared.requirements), problem)
            start[prepared.settings[name].target] = constants[name] = value
        try:
            table = self._simulator.run(stop=simulation.stop, step=simulation.step, start=start, out=self._table)
        except RunFailed as error:
            return Run(request, Outcome.FAILED, {}, judge_failed(prepared.requirements), str(error))
        time, is_whole = self._time[: len(table)], len(table) == len(self._time)
        self._table = table if is_whole else self._table
        self._rows = np.empty((len(self._columns), len(self._time))) if self._rows is None else self._rows
        rows = self._rows[:, : len(table)]
        rows[:] = table.T
        columns = dict(zip(self._columns, rows, strict=True))
        metrics, judgements = prepared.program.evaluate(time, columns, constants)
        problem = "" if is_whole else f"ended early: {self._simulator.ended}"
        if self._comparison is not None:
            bars, unknown = self._comparison.error_bars(metrics, constants, start, time, columns)
            metrics, problem = {**metrics, **bars}, "; ".join(filter(None, (problem, unknown)))
        waveforms = self._waveforms(time, columns) if keep else None
        return Run(request, Outcome.DONE, metrics, judgements, problem, waveforms)

    def close(self) -> None:
        """Free the FMU instances."""
        if self._comparison is not None:
            self._comparison.close()
        self._simulator.close()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _waveforms(self, time: NDArray[np.float64], columns: Mapping[str, NDArray[np.float64]]) -> Waveforms:
        stride = self.prepared.simulation.stride
        values = {name: columns[name][::stride].copy() for name in self.prepared.recording.kept}
        return Waveforms(np.ascontiguousarray(time[::stride]), values)
