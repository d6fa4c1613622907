"""What came of runs that were made again for error bars, and which verdicts that leaves certain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict

_JUDGED = tuple(VERDICTS.index(verdict) for verdict in (Verdict.PASS, Verdict.FAIL))


class Certainty(StrEnum):
    """Whether a verdict stays what it is with finer numerics; "" if nobody has looked."""

    UNCHECKED = ""
    CERTAIN = "certain"
    DOUBTFUL = "doubtful"


CERTAINTIES = tuple(Certainty)
"""By the number that stands for them in tables."""

_UNCHECKED, _CERTAIN, _DOUBTFUL = range(3)


@dataclass(frozen=True, slots=True, eq=False)
class Checks:
    """Checks of c runs, m metrics and r requirements in the study's order, sorted by number.

    *numbers* (c,) int64; *errors* (c, m) float64 in SI, the metrics' error bars; *verdicts* (c, r) int64, which
    verdicts the variations gave, as a sum of 2^position in `VERDICTS`, 0 where none can tell. *problems* has what is to
    be said of a check, by number.
    """

    numbers: NDArray[np.int64]
    errors: NDArray[np.float64]
    verdicts: NDArray[np.int64]
    problems: Mapping[int, str]

    def __len__(self) -> int:
        return len(self.numbers)

    def of(self, numbers: NDArray[np.int64]) -> Checks:
        """Those of the runs *numbers*."""
        rows = np.isin(self.numbers, numbers)
        there = set(self.numbers[rows].tolist())
        problems = {number: text for number, text in self.problems.items() if number in there}
        return Checks(self.numbers[rows], self.errors[rows], self.verdicts[rows], problems)


NO_CHECKS = Checks(np.zeros(0, np.int64), np.zeros((0, 0)), np.zeros((0, 0), np.int64), {})
"""Of a study without any; it has no columns either."""


def certainties(
    verdicts: NDArray[np.uint8], margins: NDArray[np.float64], errors: NDArray[np.float64], under: NDArray[np.int64]
) -> NDArray[np.uint8]:
    """How certain the *verdicts* of n checked runs on one requirement are, as positions in `CERTAINTIES`; all are (n,).

    A verdict is certain if all variations gave it (*under*, as `Checks` has it) and, where it is pass or fail, its
    margin is larger than the metric's error bar. Where the margin is undefined, no error is larger.
    """
    same = under == np.left_shift(1, verdicts.astype(np.int64))
    apart = ~np.isin(verdicts, _JUDGED) | np.isnan(margins) | (np.abs(margins) > errors)
    return np.where(same & apart, _CERTAIN, _DOUBTFUL).astype(np.uint8)


def certainties_by_bars(
    verdicts: NDArray[np.uint8], margins: NDArray[np.float64], errors: NDArray[np.float64]
) -> NDArray[np.uint8]:
    """The same of n runs of which the error bars are all that is known: nothing of verdicts that no margin decides.

    Where the margin is undefined, a bar that is infinite says that a variation has one.
    """
    certain = np.where(np.isnan(margins), ~np.isinf(errors), np.abs(margins) > errors)
    found = np.where(certain, _CERTAIN, _DOUBTFUL)
    return np.where(np.isin(verdicts, _JUDGED), found, _UNCHECKED).astype(np.uint8)
