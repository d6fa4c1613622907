"""How often a requirement is met, and how sure that is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from dse.analysis.cells import effective
from dse.analysis.data import ALL, MET, StudyData, withheld
from dse.domain.bench import VERDICTS, Verdict

CONFIDENCE = 0.95

LEAST_EVEN = 50
"""Fewer evenly drawn runs among others do not say what share of the space is met."""


@dataclass(frozen=True, slots=True)
class Interval:
    """An estimate with its confidence interval."""

    value: float
    low: float
    high: float


class Basis(StrEnum):
    """What a share of the space is taken from."""

    RUNS = "runs"
    """All, which were drawn evenly."""
    EVEN_RUNS = "runs drawn evenly"
    """Only these; the others were placed by what came of earlier ones, or by the user."""
    MODEL = "a model of the verdicts"
    """`modelled_share`, through all runs."""


@dataclass(frozen=True, slots=True)
class Met:
    """How often *requirement* is met where it is exercised: the *share* of *met* in *met* + *failed*.

    *not_exercised* runs and those that *failed_to_run* are in neither; but of all requirements together the share is
    that of the whole space: what does not exercise one does not meet all, and is *failed*. Where runs count
    differently, *counts_as* is how many that count alike would say as much. Of designs it is met at all *conditions*.
    *basis* is what the share is taken from.
    """

    requirement: str
    share: Interval
    met: int
    failed: int
    not_exercised: int
    failed_to_run: int
    counts_as: float
    conditions: int = 0
    basis: Basis = Basis.RUNS

    @property
    def judged(self) -> int:
        """Runs that met it or failed it."""
        return self.met + self.failed


def wilson(successes: float, trials: float, confidence: float = CONFIDENCE) -> Interval:
    """Of a share: *successes* of so many *trials*, more than 0, whole or not (Wilson 1927).

    It holds the true share p in about 95 % of cases if n p and n (1 - p) are more than about 5, less often near the
    ends for some n; of sequences that fill the space more evenly than chance, more often.
    """
    from scipy.special import ndtri

    z, p = float(ndtri(0.5 + confidence / 2)), successes / trials
    shrink = 1 + z * z / trials
    centre = (p + z * z / (2 * trials)) / shrink
    half = z / shrink * math.sqrt(p * (1 - p) / trials + (z / (2 * trials)) ** 2)
    return Interval(p, max(0.0, centre - half) if p > 0 else 0.0, min(1.0, centre + half) if p < 1 else 1.0)


def probability_met(data: StudyData, requirement: str = ALL) -> Met:
    """By the runs that were drawn evenly over the space.

    DseError if there is no such requirement, if no run met or failed it, or if fewer than 50 of others were drawn so.
    """
    return met_by_runs(data.evenly(requirement, LEAST_EVEN), requirement)


def met_by_runs(data: StudyData, requirement: str) -> Met:
    """As `probability_met`, of all runs, however they were placed."""
    codes = data.codes(requirement)
    if requirement == ALL:
        codes = np.where(codes == VERDICTS.index(Verdict.NOT_EXERCISED), VERDICTS.index(Verdict.FAIL), codes)
    met = codes == MET
    judged = met | (codes == VERDICTS.index(Verdict.FAIL))
    count = {verdict: int((codes == code).sum()) for code, verdict in enumerate(VERDICTS)}
    if not judged.any():
        without = (
            f"{count[Verdict.NOT_EXERCISED]} runs do not exercise it, {count[Verdict.FAILED_TO_RUN]} failed to run"
        )
        raise withheld(requirement, f"no run shows whether it is met: {without}")
    counts_as = effective(data.weights[judged]) * min(data.different / len(data), 1.0)
    share = float(data.weights[met].sum() / data.weights[judged].sum())
    return Met(
        requirement,
        wilson(share * counts_as, counts_as),
        count[Verdict.PASS],
        count[Verdict.FAIL],
        count[Verdict.NOT_EXERCISED],
        count[Verdict.FAILED_TO_RUN],
        counts_as,
        data.conditions,
    )
