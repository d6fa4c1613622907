"""A run's numerical check: the same run with half the step, and what that changes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dse.cosim import RunFailed, Simulator
from dse.domain.method import Method
from dse.domain.run import ERROR_BAR
from dse.testbench.prepared import PreparedBench


class Halved:
    """Repeats runs of *prepared* with half of every step.

    *simulator* makes the runs themselves. Where all parts make the bench's step it makes these, too, on the same
    instances; else they have instances of their own.
    """

    def __init__(self, prepared: PreparedBench, simulator: Simulator, progress: memoryview | None) -> None:
        self._prepared = prepared
        self._step = prepared.simulation.step / 2
        self._own: Simulator | None = None
        if prepared.simulation.method.steps or prepared.simulation.method.adaptive:
            self._own = Simulator(
                prepared.system,
                prepared.recording.variables,
                method=finer(prepared.simulation.method),
                progress=progress,
                facts=prepared.facts,
            )
        self._simulator = self._own or simulator
        rows = 2 * prepared.simulation.steps + 1
        self._time: NDArray[np.float64] = np.arange(rows, dtype=np.float64) * self._step

    def error_bars(
        self, metrics: Mapping[str, float], constants: Mapping[str, float], start: Mapping[str, float]
    ) -> tuple[dict[str, float], str]:
        """How much each of *metrics* differs with half the step, by ``NAME.error``, and why that cannot be told.

        An error bar is NaN where the metric is undefined in both runs, infinite where it is in one of them, and 0 where
        it is infinite in both alike. For a method of order p the error of the metric itself is about 2^p / (2^p - 1)
        error bars (Richardson).
        """
        prepared = self._prepared
        try:
            table = self._simulator.run(stop=prepared.simulation.stop, step=self._step, start=start)
        except RunFailed as error:
            return dict.fromkeys((f"{name}{ERROR_BAR}" for name in metrics), math.nan), f"with half the step: {error}"
        columns = dict(zip(prepared.recording.columns, np.ascontiguousarray(table.T), strict=True))
        finer, _ = prepared.program.evaluate(self._time[: len(table)], columns, constants)
        return {f"{name}{ERROR_BAR}": _distance(value, finer[name]) for name, value in metrics.items()}, ""

    def close(self) -> None:
        """Free the instances that are not the simulator's."""
        if self._own is not None:
            self._own.close()


def finer(method: Method) -> Method:
    """*method* with half of every step that parts have of their own.

    Adaptive steps are what their tolerance makes of them: a quarter of it stands for half the step, as the error of a
    step goes with its square.
    """
    adaptive = method.adaptive
    if adaptive is not None:
        adaptive = replace(adaptive, tolerance=adaptive.tolerance / 4, absolute=adaptive.absolute / 4)
    return replace(method, steps={part: step / 2 for part, step in method.steps.items()}, adaptive=adaptive)


def _distance(a: float, b: float) -> float:
    if math.isnan(a) or math.isnan(b):
        return math.nan if math.isnan(a) and math.isnan(b) else math.inf
    return 0.0 if a == b else abs(a - b)
