"""The error bars of a run: what variations of it change."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from dse.cosim import RunFailed, Simulator
from dse.domain.bench import VERDICTS, Judgement, Verdict
from dse.domain.run import ERROR_BAR, VERDICTS_UNDER
from dse.metrics import between_rows
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.variations import SAFETY, Variation, shares

_ENOUGH = 2
"""So many variations that change nothing show that a metric is exact."""
_UNCHANGED = "no other step changes them, but only one could be tried"
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
        self,
        metrics: Mapping[str, float],
        constants: Mapping[str, float],
        start: Mapping[str, float],
        time: NDArray[np.float64],
        columns: Mapping[str, NDArray[np.float64]],
    ) -> tuple[dict[str, float], str]:
        """How far each of *metrics* may be off, by ``NAME.error``, and what cannot be told. *time* and *columns* are
        the run's own, as for `MetricProgram.evaluate`.

        That is what happens between rows, and the errors that changes by the variations stand for. Besides, by
        ``R.verdicts``, which verdicts on each requirement the variations gave: see `VERDICTS_UNDER`. One that fails to
        run gives that.

        An error bar is NaN where the metric is undefined in all runs, or cannot be measured; infinite where it is
        undefined in some of them; 0 where no other step changes it, two having been tried or its parts being exact.
        """
        checks = self._prepared.checks
        changes: dict[str, list[float]] = {name: [] for name in metrics if name not in checks.unmeasured}
        under = {requirement.name: 0 for requirement in self._prepared.requirements}
        failure = ""
        for variation, simulator, rows in self._repeated if changes else ():
            try:
                found, judged = self._measured(variation, simulator, rows, constants, start)
            except RunFailed as error:
                failure = f"{variation.what}: {error}"
                under = {name: verdicts | _FAILED for name, verdicts in under.items()}
                break
            _note(under, judged)
            for name, apart in changes.items():
                apart.append(_distance(metrics[name], found[name]))
        off, nearby = between_rows(self._prepared.program, time, columns, constants)
        _note(under, nearby)
        bars: dict[str, float] = {}
        unmeasured = dict(checks.unmeasured)
        for name, apart in changes.items() if not failure else ():
            bars[name] = self._together(apart) + SAFETY * off[name]
            if name in checks.unless and not self._answers(apart):
                unmeasured[name] = checks.unless[name]
            elif bars[name] == 0.0 and len(apart) < _ENOUGH and name not in checks.exact:
                unmeasured[name] = _UNCHANGED
        said = "; ".join(filter(None, (_unmeasured_text(unmeasured, metrics), failure)))
        under |= {each.name: 0 for each in self._prepared.requirements if each.metric in unmeasured}
        numbers = {
            f"{name}{ERROR_BAR}": math.nan if name in unmeasured else bars.get(name, math.nan) for name in metrics
        }
        return numbers | {f"{name}{VERDICTS_UNDER}": float(verdicts) for name, verdicts in under.items()}, said

    def _answers(self, apart: Sequence[float]) -> bool:
        """Whether a shorter step of the whole system changes a metric."""
        return any(change > 0.0 for (v, _, _), change in zip(self._repeated, apart, strict=True) if v.step < 1.0)

    def _together(self, apart: Sequence[float]) -> float:
        """The error that changes by each variation stand for: the largest by shorter steps, which is one error, and the
        others. Where they show none, what any variation changes.
        """
        system = self._prepared.system
        told = [(v, v.errors * change) for (v, _, _), change in zip(self._repeated, apart, strict=True) if v.errors]
        finer = [error for v, error in told if v.step < 1.0 and v.system is system]
        other = [error for v, error in told if not (v.step < 1.0 and v.system is system)]
        if odd := [error for error in (*finer, *other) if not math.isfinite(error)]:
            return math.inf if math.inf in odd else math.nan
        return max(finer, default=0.0) + math.fsum(other) or max(apart, default=0.0)

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


def _note(under: dict[str, int], judged: Iterable[Judgement]) -> None:
    for each in judged:
        under[each.requirement] |= 1 << VERDICTS.index(each.verdict)


def _unmeasured_text(unmeasured: Mapping[str, str], metrics: Mapping[str, float]) -> str:
    """Which of *metrics* have no error bar, and why."""
    by_reason: dict[str, list[str]] = {}
    for name in metrics:
        if name in unmeasured:
            by_reason.setdefault(unmeasured[name], []).append(name)
    return "; ".join(
        f"error {'bar' if len(names) == 1 else 'bars'} of {', '.join(names)} not measurable: {why}"
        for why, names in by_reason.items()
    )


def _distance(a: float, b: float) -> float:
    if math.isnan(a) or math.isnan(b):
        return math.nan if math.isnan(a) and math.isnan(b) else math.inf
    return 0.0 if a == b else abs(a - b)
