"""Every case of the rule by which runs pass or fail, written out: for metrics, for the report and for its page."""

from __future__ import annotations

import math
from itertools import product
from typing import NamedTuple

BOUNDS = ((4.0, None), (None, 2.0), (4.0, 2.0))
"""At most and at least, of three requirements."""

_VERDICTS = {
    -math.inf: "pass fail fail",
    1.0: "pass fail fail",
    2.0: "pass pass pass",
    3.0: "pass pass pass",
    4.0: "pass pass pass",
    5.0: "fail pass fail",
    math.inf: "fail pass fail",
    math.nan: "fail fail fail",
}
_MARGINS = {
    -math.inf: (math.inf, -math.inf, -math.inf),
    1.0: (3.0, -1.0, -1.0),
    2.0: (2.0, 0.0, 0.0),
    3.0: (1.0, 1.0, 1.0),
    4.0: (0.0, 2.0, 0.0),
    5.0: (-1.0, 3.0, -1.0),
    math.inf: (-math.inf, math.inf, -math.inf),
    math.nan: (math.nan, math.nan, math.nan),
}


class Case(NamedTuple):
    """A run: the *value* of its metric, which requirements it *exercised*, and what must follow."""

    value: float
    exercised: tuple[bool, ...]
    done: bool
    margins: tuple[float, ...]
    verdicts: tuple[str, ...]
    overall: str


def cases() -> list[Case]:
    """All of them."""
    return [_case(*facts) for facts in product(_VERDICTS, product((True, False), repeat=len(BOUNDS)), (True, False))]


def _case(value: float, exercised: tuple[bool, ...], done: bool) -> Case:
    if not done:
        return Case(value, exercised, done, _MARGINS[value], ("failed to run",) * len(BOUNDS), "failed to run")
    told = zip(_VERDICTS[value].split(), exercised, strict=True)
    verdicts = tuple(verdict if flag else "not exercised" for verdict, flag in told)
    overall = next(word for word in ("fail", "not exercised", "pass") if word in verdicts)
    return Case(value, exercised, done, _MARGINS[value], verdicts, overall)
