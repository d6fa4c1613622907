"""The results of some runs as arrays, one row per run: how they travel from a worker to the study folder."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Judgement, Verdict
from dse.domain.run import Outcome, Run, RunRequest

_CODES = {verdict: code for code, verdict in enumerate(VERDICTS)}


@dataclass(frozen=True, slots=True)
class Measures:
    """What every run has to give, by name and in the study's order."""

    metrics: tuple[str, ...] = ()
    requirements: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class RowBlock:
    """Results of n runs, m metrics and r requirements in the study's order.

    *numbers* (n,) int64; *done* (n,) bool; *metrics* (n, m) and *margins* (n, r) float64 in SI, NaN where
    undefined; *verdicts* (n, r) uint8, positions in `VERDICTS`; *wall* (n,) seconds. *problems* has an entry for
    each run that has something to say.
    """

    numbers: NDArray[np.int64]
    done: NDArray[np.bool_]
    metrics: NDArray[np.float64]
    verdicts: NDArray[np.uint8]
    margins: NDArray[np.float64]
    wall: NDArray[np.float64]
    problems: Mapping[int, str]

    def __len__(self) -> int:
        return len(self.numbers)

    def part(self, rows: NDArray[np.intp]) -> RowBlock:
        """The block with only these *rows*, in this order."""
        numbers = self.numbers[rows]
        present = set(numbers.tolist())
        return RowBlock(
            numbers,
            self.done[rows],
            self.metrics[rows],
            self.verdicts[rows],
            self.margins[rows],
            self.wall[rows],
            {number: text for number, text in self.problems.items() if number in present},
        )

    def differs_from(self, other: RowBlock) -> NDArray[np.bool_]:
        """Row by row, whether the results differ in any bit (*other* has the same runs in the same order).

        NaN equals NaN; the sign of zero is not compared, as SQLite does not keep it.
        """
        return np.asarray(
            (self.done != other.done)
            | _differ(self.metrics, other.metrics)
            | _differ(self.margins, other.margins)
            | (self.verdicts != other.verdicts).any(axis=1),
            dtype=np.bool_,
        )

    def runs(self, requests: Iterable[RunRequest], measures: Measures) -> Iterator[Run]:
        """The rows one by one as runs of *requests*, without waveforms."""
        columns = (self.done, self.metrics, self.verdicts, self.margins)
        for request, done, metrics, verdicts, margins in zip(requests, *(c.tolist() for c in columns), strict=True):
            yield Run(
                request,
                Outcome.DONE if done else Outcome.FAILED,
                dict(zip(measures.metrics, metrics, strict=True)) if done else {},
                tuple(
                    Judgement(name, VERDICTS[code], margin)
                    for name, code, margin in zip(measures.requirements, verdicts, margins, strict=True)
                ),
                self.problems.get(request.number, ""),
            )


def block_of(runs: Sequence[Run], measures: Measures, wall: Sequence[float] | None = None) -> RowBlock:
    """*runs* as a block, *wall* seconds each; KeyError if a finished run lacks a metric or a requirement."""
    n = len(runs)
    judged = [_judged(run, measures.requirements) for run in runs]
    metrics = [_metrics(run, measures.metrics) for run in runs]
    shape = (n, len(measures.requirements))
    return RowBlock(
        np.array([run.request.number for run in runs], dtype=np.int64),
        np.array([run.outcome is Outcome.DONE for run in runs], dtype=np.bool_),
        np.array(metrics, dtype=np.float64).reshape(n, len(measures.metrics)),
        np.array([[_CODES[verdict] for verdict, _ in row] for row in judged], dtype=np.uint8).reshape(shape),
        np.array([[margin for _, margin in row] for row in judged], dtype=np.float64).reshape(shape),
        np.full(n, math.nan) if wall is None else np.array(wall, dtype=np.float64),
        {run.request.number: run.problem for run in runs if run.problem},
    )


def _metrics(run: Run, names: Sequence[str]) -> list[float]:
    if run.outcome is Outcome.FAILED:
        return [math.nan] * len(names)
    return [run.metrics[name] for name in names]


def _judged(run: Run, names: Sequence[str]) -> list[tuple[Verdict, float]]:
    if run.outcome is Outcome.FAILED:
        return [(Verdict.FAILED_TO_RUN, math.nan)] * len(names)
    by_name = {judgement.requirement: (judgement.verdict, judgement.margin) for judgement in run.judgements}
    return [by_name[name] for name in names]


def _differ(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(((a != b) & ~(np.isnan(a) & np.isnan(b))).any(axis=1), dtype=np.bool_)
