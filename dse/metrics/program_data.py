"""Compiled metrics as plain data: what a page needs to measure and judge a run as `MetricProgram` does.

The page (``report/web/src/metrics``) has every operator and every function of ours; both sides are tested with
``tests/metric_program_cases.json``. Functions of installed packages are Python and refused by name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from dse.errors import Problem, raise_if_any
from dse.metrics import functions
from dse.metrics.catalogue import ROWWISE
from dse.metrics.compiler import OPERATORS, is_true, select
from dse.metrics.machine import MetricProgram

_WORDS: Mapping[Callable[..., Any], str] = {
    np.negative: "negative",
    np.logical_not: "not",
    is_true: "is_true",
    select: "select",
    **{function: word for word, function in {**OPERATORS, **ROWWISE}.items() if word != "iff"},  # which is ==
}
"""What works row by row, by the word of the expression language; the functions of waveforms have their own names."""


def program_as_data(program: MetricProgram) -> dict[str, Any]:
    """*program* as JSON can hold it: registers are numbers, functions are words, *size* is the number of registers.

    An instruction is ``[word, target, argument, …]``, a literal ``[register, value]``, in SI. Raises DseError with
    every function that is not ours.
    """
    words = {step.function: _word(step.function) for step in program.instructions}
    raise_if_any(
        Problem(
            f"a report page cannot compute the metric function '{function.__name__}' of {function.__module__}",
            hint="it can compute those of dse only",
        )
        for function, word in words.items()
        if word is None
    )
    return {
        "size": program.size,
        "signals": {name: program.inputs[name] for name in program.signals},
        "constants": {name: program.inputs[name] for name in program.constants},
        "literals": [[register, value] for register, value in program.literals],
        "instructions": [[words[step.function], step.target, *step.arguments] for step in program.instructions],
        "metrics": dict(program.metrics),
        "checks": [
            {
                "requirement": check.requirement,
                "atMost": check.at_most,
                "atLeast": check.at_least,
                "metric": check.metric,
                "exercised": check.exercised,
                "conditionMetrics": list(check.condition_metrics),
            }
            for check in program.checks
        ],
    }


def _word(function: Callable[..., Any]) -> str | None:
    own = getattr(functions, function.__name__, None) is function
    return function.__name__ if own else _WORDS.get(function)
