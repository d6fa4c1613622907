"""Every case of the rule by which runs pass or fail; the report's page is tested with the same file."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import NamedTuple

_RULE = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))
BOUNDS = tuple((at_most, at_least) for at_most, at_least in _RULE["bounds"])
"""At most and at least, of three requirements."""
_ROWS = {
    float(row["value"]): (tuple(row["verdicts"]), tuple(float(each) for each in row["margins"]))
    for row in _RULE["values"]
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
    return [_case(*facts) for facts in product(_ROWS, product((True, False), repeat=len(BOUNDS)), (True, False))]


def _case(value: float, exercised: tuple[bool, ...], done: bool) -> Case:
    told, margins = _ROWS[value]
    if not done:
        return Case(value, exercised, done, margins, ("failed to run",) * len(BOUNDS), "failed to run")
    verdicts = tuple(verdict if flag else "not exercised" for verdict, flag in zip(told, exercised, strict=True))
    overall = next(word for word in ("fail", "not exercised", "pass") if word in verdicts)
    return Case(value, exercised, done, margins, verdicts, overall)
