"""How good a design is: its runs in all cases become objectives and a violation of the requirements."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from dse.domain.bench import Verdict
from dse.domain.sampler import Objective, Outcomes

_DIGITS = 10
"""Significant ones that are compared: the last bits of another machine do not matter."""

_FAILED = 2.0
"""The violation of a run that failed, or that has no value of an objective: worse than of any requirement."""

Aggregate = Literal["worst", "mean"]


@dataclass(frozen=True, slots=True)
class Result:
    """One run: objectives to be minimised, NaN for none; verdicts and margins by requirement."""

    done: bool
    objectives: tuple[float, ...]
    verdicts: Mapping[str, Verdict]
    margins: Mapping[str, float]

    @property
    def is_lost(self) -> bool:
        """Whether it proves that the design is none to take, whatever it does in other cases."""
        failed = any(verdict in (Verdict.FAIL, Verdict.FAILED_TO_RUN) for verdict in self.verdicts.values())
        return failed or not self.done or any(map(math.isnan, self.objectives))


@dataclass(frozen=True, slots=True)
class Judgement:
    """Objectives to be minimised, and a *violation*: 0 where all requirements are met in all cases."""

    objectives: tuple[float, ...]
    violation: float


def results(outcomes: Outcomes, objectives: Sequence[Objective]) -> list[Result]:
    """What came of runs, one by one. Raises KeyError for an objective that they do not have."""
    columns = [(outcomes.totals if each.is_total else outcomes.metrics)[each.name].tolist() for each in objectives]
    signs = [-1 if each.maximize else 1 for each in objectives]
    margins = {name: column.tolist() for name, column in outcomes.margins.items()}
    return [
        Result(
            done,
            tuple(sign * column[row] for sign, column in zip(signs, columns, strict=True)),
            {name: verdicts[row] for name, verdicts in outcomes.verdicts.items()},
            {name: column[row] for name, column in margins.items()},
        )
        for row, done in enumerate(outcomes.done.tolist())
    ]


@dataclass(frozen=True, slots=True)
class Judge:
    """Judges designs by their results in up to *cases* cases.

    An objective is the worst, or the mean, of all cases. A requirement is met if no case fails it and at least one
    passes it: one that no case exercised is not, unless *may_be_idle*. What fails by a margin violates by less than 1,
    at first in proportion to the requirement's scale of *scales*; what is never exercised by 1, a run that failed or
    has no value of an objective by 2 more, and cases that were not run by their share.
    """

    cases: int
    aggregate: Aggregate
    may_be_idle: bool
    scales: Mapping[str, float]

    def judged(self, found: Sequence[Result]) -> Judgement:
        """A design by its results, of which there is one at least."""
        violation = sum(self._violation(name, found) for name in found[0].verdicts)
        violation += _FAILED * any(not one.done or any(map(math.isnan, one.objectives)) for one in found)
        violation += (self.cases - len(found)) / self.cases
        together = max if self.aggregate == "worst" else _mean
        objectives = tuple(
            _rounded(together(column)) for column in zip(*(one.objectives for one in found), strict=True)
        )
        return Judgement(objectives, _rounded(violation))

    def _violation(self, name: str, found: Sequence[Result]) -> float:
        scale = self.scales.get(name, 1.0)
        worst = max(_missed(one.verdicts[name], one.margins.get(name, math.nan) / scale) for one in found)
        idle = all(one.verdicts[name] is Verdict.NOT_EXERCISED for one in found)
        return 1.0 if idle and not self.may_be_idle else worst


def scales(found: Sequence[Result]) -> dict[str, float]:
    """The usual size of each requirement's margins: the median of those that are known."""
    usual: dict[str, float] = {}
    for name in found[0].margins if found else ():
        sizes = sorted(
            abs(one.margins[name]) for one in found if math.isfinite(one.margins[name]) and one.margins[name]
        )
        if sizes:
            usual[name] = sizes[len(sizes) // 2]
    return usual


def _missed(verdict: Verdict, margin: float) -> float:
    """How far a requirement is from being met, 0 … 1."""
    match verdict:
        case Verdict.FAIL:
            miss = max(-margin, 0.0)
            return miss / (1.0 + miss) if math.isfinite(miss) else 1.0
        case Verdict.FAILED_TO_RUN:
            return 1.0
    return 0.0


def _mean(column: Sequence[float]) -> float:
    return math.fsum(column) / len(column)


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
