"""The error bars of a run: what variations of it change."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from dse.cosim import RunFailed, Simulator
from dse.domain.bench import VERDICTS, Judgement, Verdict
from dse.domain.run import ERROR_BAR, VERDICTS_UNDER
from dse.testbench.prepared import PreparedBench
from dse.testbench.variations import Variation, shares

_FAILED = 1 << VERDICTS.index(Verdict.FAILED_TO_RUN)


class Comparison:
    """Repeats runs of *prepared* by its variations.

    *simulator* makes the runs themselves, and those of variations that differ in the bench's step only; others have
    instances of their own.
    """

    def __init__(self, prepared: PreparedBench, simulator: Simulator, progress: memoryview | None) -> None:
        self._prepared = prepared
        self._own: list[Simulator] = []
        self._repeated: list[tuple[Variation, Simulator, NDArray[np.float64]]] = []
        for variation in prepared.checks.variations:
            makes = simulator
            if not shares(variation, prepared.system, prepared.simulation):
                makes = Simulator(
                    variation.system,
                    prepared.recording.variables,
                    method=variation.method,
                    progress=progress,
                    facts=prepared.facts,
                )
                self._own.append(makes)
            step = prepared.simulation.step * variation.step
            rows = round(prepared.simulation.stop / step) + 1
            self._repeated.append((variation, makes, np.arange(rows, dtype=np.float64) * step))

    def error_bars(
        self, metrics: Mapping[str, float], constants: Mapping[str, float], start: Mapping[str, float]
    ) -> tuple[dict[str, float], str]:
        """How much each of *metrics* changes by all variations together, by ``NAME.error``, and what nobody can tell.

        Besides, by ``R.verdicts``, which verdicts on each requirement the variations gave: see `VERDICTS_UNDER`. One
        that fails to run gives that.

        An error bar is NaN where the metric is undefined in all runs, or cannot be measured; infinite where it is
        undefined in some of them, and 0 where it is infinite in all alike. For a method of order p the error of the
        metric itself is about 2^p / (2^p - 1) of what half the step changes (Richardson).
        """
        unmeasured = self._prepared.checks.unmeasured
        changes: dict[str, list[float]] = {name: [] for name in metrics if name not in unmeasured}
        under = {requirement.name: 0 for requirement in self._prepared.requirements}
        failure = ""
        for variation, simulator, time in self._repeated if changes else ():
            try:
                found, judged = self._measured(variation, simulator, time, constants, start)
            except RunFailed as error:
                failure = f"{variation.what}: {error}"
                under = {name: verdicts | _FAILED for name, verdicts in under.items()}
                break
            for each in judged:
                under[each.requirement] |= 1 << VERDICTS.index(each.verdict)
            for name, apart in changes.items():
                apart.append(_distance(metrics[name], found[name]))
        bars = {name: math.nan if failure else _together(apart) for name, apart in changes.items()}
        said = "; ".join(filter(None, (_said(unmeasured, metrics), failure)))
        under |= {each.name: 0 for each in self._prepared.requirements if each.metric in unmeasured}
        numbers = {f"{name}{ERROR_BAR}": bars.get(name, math.nan) for name in metrics}
        return numbers | {f"{name}{VERDICTS_UNDER}": float(verdicts) for name, verdicts in under.items()}, said

    def close(self) -> None:
        """Free the instances that are not the simulator's."""
        for simulator in self._own:
            simulator.close()

    def _measured(
        self,
        variation: Variation,
        simulator: Simulator,
        time: NDArray[np.float64],
        constants: Mapping[str, float],
        start: Mapping[str, float],
    ) -> tuple[dict[str, float], tuple[Judgement, ...]]:
        prepared = self._prepared
        step = prepared.simulation.step * variation.step
        table = simulator.run(stop=prepared.simulation.stop, step=step, start=start)
        columns = dict(zip(prepared.recording.columns, np.ascontiguousarray(table.T), strict=True))
        return prepared.program.evaluate(time[: len(table)], columns, constants)


def _said(unmeasured: Mapping[str, str], metrics: Mapping[str, float]) -> str:
    """Which of *metrics* have no error bar, and why."""
    by_reason: dict[str, list[str]] = {}
    for name in metrics:
        if name in unmeasured:
            by_reason.setdefault(unmeasured[name], []).append(name)
    return "; ".join(
        f"error {'bar' if len(names) == 1 else 'bars'} of {', '.join(names)} not measurable: {why}"
        for why, names in by_reason.items()
    )


def _together(changes: Iterable[float]) -> float:
    changes = list(changes)
    return math.inf if math.inf in changes else math.fsum(changes)


def _distance(a: float, b: float) -> float:
    if math.isnan(a) or math.isnan(b):
        return math.nan if math.isnan(a) and math.isnan(b) else math.inf
    return 0.0 if a == b else abs(a - b)
