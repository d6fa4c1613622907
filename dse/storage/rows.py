"""The results of some runs as arrays, one row per run: how they travel from a worker to the study folder."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Judgement, Verdict
from dse.domain.run import Outcome, Run, RunRequest
from dse.storage.attempts import this_process

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
    each run that has something to say. *maker* is the process that made the runs, as an `Attempt` has it.
    """

    numbers: NDArray[np.int64]
    done: NDArray[np.bool_]
    metrics: NDArray[np.float64]
    verdicts: NDArray[np.uint8]
    margins: NDArray[np.float64]
    wall: NDArray[np.float64]
    problems: Mapping[int, str]
    maker: str = ""

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
            self.maker,
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
    """*runs* as a block of this process, *wall* seconds each; KeyError if a finished one lacks one of *measures*."""
    n = len(runs)
    metrics, margins, codes = zip(*(numbers_of(run, measures) for run in runs), strict=True) if n else ((), (), ())
    shape = (n, len(measures.requirements))
    return RowBlock(
        np.array([run.request.number for run in runs], dtype=np.int64),
        np.array([run.outcome is Outcome.DONE for run in runs], dtype=np.bool_),
        np.array(metrics, dtype=np.float64).reshape(n, len(measures.metrics)),
        np.array(codes, dtype=np.uint8).reshape(shape),
        np.array(margins, dtype=np.float64).reshape(shape),
        np.full(n, math.nan) if wall is None else np.array(wall, dtype=np.float64),
        {run.request.number: run.problem for run in runs if run.problem},
        this_process(),
    )


def numbers_of(run: Run, measures: Measures) -> tuple[list[float], list[float], list[int]]:
    """Metrics, margins and verdicts (positions in `VERDICTS`) of *run*; KeyError if it is finished and lacks one."""
    names = measures.requirements
    judgements = {judgement.requirement: judgement for judgement in run.judgements}
    if run.outcome is Outcome.FAILED:
        nothing = [math.nan] * len(names)
        given = (judgements[name].verdict if name in judgements else Verdict.FAILED_TO_RUN for name in names)
        return [math.nan] * len(measures.metrics), nothing, [_CODES[verdict] for verdict in given]
    judged = [judgements[name] for name in names]
    metrics = [run.metrics[name] for name in measures.metrics]
    return metrics, [judgement.margin for judgement in judged], [_CODES[judgement.verdict] for judgement in judged]


def _differ(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(((a != b) & ~(np.isnan(a) & np.isnan(b))).any(axis=1), dtype=np.bool_)
