"""How often a requirement is met, and how sure that is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dse.analysis.cells import effective, lean
from dse.analysis.data import ALL, MET, StudyData, withheld
from dse.domain.bench import VERDICTS, Verdict

CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Interval:
    """An estimate with its confidence interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Met:
    """How often *requirement* is met where it is exercised: the *share* of *met* in *met* + *failed*.

    *not_exercised* runs and those that *failed_to_run* are in neither; but of all requirements together the share is
    that of the whole space: what does not exercise one does not meet all, and is *failed*. Where runs count
    differently, *counts_as* is how many that count alike would tell as much.
    """

    requirement: str
    share: Interval
    met: int
    failed: int
    not_exercised: int
    failed_to_run: int
    counts_as: float

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
    """DseError if there is no such requirement, no run met or failed it, or they crowd on one side of the boundary."""
    codes = data.codes(requirement)
    if requirement == ALL:
        codes = np.where(codes == VERDICTS.index(Verdict.NOT_EXERCISED), VERDICTS.index(Verdict.FAIL), codes)
    met = codes == MET
    judged = met | (codes == VERDICTS.index(Verdict.FAIL))
    count = {verdict: int((codes == code).sum()) for code, verdict in enumerate(VERDICTS)}
    if not judged.any():
        told = f"{count[Verdict.NOT_EXERCISED]} runs do not exercise it, {count[Verdict.FAILED_TO_RUN]} failed to run"
        raise withheld(requirement, f"no run says whether it is met: {told}")
    weights = data.weights[judged]
    counts_as = effective(weights) * min(data.different / len(data), 1.0)
    share = float(data.weights[met].sum() / weights.sum())
    interval = wilson(share * counts_as, counts_as)
    excess = 0.0 if data.on_grid else lean(data.places[judged], weights, met[judged])
    if abs(excess) > (interval.high - interval.low) / 2:
        told = f"{count[Verdict.PASS]} runs meet it and {count[Verdict.FAIL]} do not, but they crowd on one side of"
        raise withheld(requirement, f"{told} where that changes: what share of the space it is cannot be told")
    low, high = max(interval.low - max(excess, 0.0), 0.0), min(interval.high - min(excess, 0.0), 1.0)
    return Met(
        requirement,
        Interval(share, low, high),
        count[Verdict.PASS],
        count[Verdict.FAIL],
        count[Verdict.NOT_EXERCISED],
        count[Verdict.FAILED_TO_RUN],
        counts_as,
    )
