"""The rule by which runs pass or fail, for one run and for arrays of them.

The report's page judges by the same rule, at bounds that the reader moves (``verdicts.ts``).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict

Codes = NDArray[np.uint8]
"""Verdicts as their positions in `VERDICTS`."""

N = TypeVar("N", float, NDArray[np.float64])


def margin_to_bounds(value: N, at_most: float | None, at_least: float | None) -> N:
    """The distance of *value* to the nearer bound, of which there is one at least: negative outside, NaN where it is.

    An open side is no bound at infinity: an infinite time to collision would have no margin to it.
    """
    below: Any = None if at_most is None else at_most - value
    above: Any = None if at_least is None else value - at_least
    found: N = above if below is None else below if above is None else np.minimum(below, above)
    return found


def verdict_codes(margin: Any, exercised: Any, done: Any = True) -> Any:
    """The verdict with that *margin* as its position in `VERDICTS`; all three may be arrays of runs.

    A metric that is undefined although the run exercised the requirement has not met it: no comparison with NaN holds.
    """
    return _BY_CASE[4 * done + 2 * exercised + (margin >= 0)]


def overall_codes(verdicts: Sequence[Codes], done: NDArray[np.bool_]) -> Codes:
    """The verdict on all requirements: one failure fails a run, and without one a gap leaves it open."""
    ranks = [np.zeros(len(done), dtype=np.uint8), *(_RANK[codes] for codes in verdicts)]
    found: Codes = np.where(done, _BY_RANK[np.maximum.reduce(ranks)], _FAILED).astype(np.uint8)
    return found


_PASS, _FAIL, _OPEN, _FAILED = (
    VERDICTS.index(verdict) for verdict in (Verdict.PASS, Verdict.FAIL, Verdict.NOT_EXERCISED, Verdict.FAILED_TO_RUN)
)
_BY_CASE = np.array([_FAILED] * 4 + [_OPEN, _OPEN, _FAIL, _PASS], dtype=np.uint8)
_BY_RANK = np.array([_PASS, _OPEN, _FAIL, _FAILED], dtype=np.uint8)
_RANK = np.argsort(_BY_RANK).astype(np.uint8)
