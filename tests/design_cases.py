"""Cases of the rule by which runs make a design feasible or not; the report's page is tested with the same file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

_RULE = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))
AT_MOST = float(_RULE["at_most"])
"""The bound of the one requirement, on the metric that is also the objective, to be small."""


class Run(NamedTuple):
    """One of a design, at a condition, with a draw of what is uncertain."""

    condition: float
    draw: float
    value: float
    exercised: bool
    done: bool


class DesignCase(NamedTuple):
    """A design and what must follow from its *runs*: *objective* is the largest mean of any condition."""

    runs: tuple[Run, ...]
    verdict: str
    margin: float
    objective: float


DESIGN_CASES = tuple(
    DesignCase(
        tuple(Run(condition, draw, float(value), *flags) for condition, draw, value, *flags in case["runs"]),
        case["verdict"],
        float(case["margin"]),
        float(case["objective"]),
    )
    for case in _RULE["designs"]
)
