"""What a study looks for: metrics and sums of properties to be made small or large."""

from __future__ import annotations

import re

from dse.domain.bench import TestBench
from dse.domain.design import candidates
from dse.domain.expression import Call, Name
from dse.domain.sampler import Objective
from dse.errors import closest, fail
from dse.expression import descend, parse_expression
from dse.formats import Entry

_WRITTEN = re.compile(r"(minimize|maximize)\s+(.+)", re.DOTALL)


def read_objective(entry: Entry, written: str, bench: TestBench) -> Objective:
    """``minimize`` or ``maximize`` and a metric, ``sum(PROPERTY)`` over the design, or an expression in both.

    Raises DseError.
    """
    match = _WRITTEN.fullmatch(written.strip())
    if not match:
        raise fail(f"expected an objective, found '{written}'", entry.where, "minimize METRIC, or minimize sum(cost)")
    maximize = match[1] == "maximize"
    expression = parse_expression(match[2], entry.where)
    metrics = [metric.name for metric in bench.metrics]
    match expression.root:
        case Name(path=name) if name in metrics:
            return Objective(name, maximize)
        case Call("sum", arguments=(Name(path=name),)):
            found = Objective(name, maximize, is_total=True)
        case _:
            found = Objective(match[2].strip(), maximize, is_composite=True)
    stated = candidates(bench.design.root).values()
    known = {name for components in stated for each in components for name in each.properties}
    for name in found.totals:
        if name not in known:
            raise fail(f"no component of the design states '{name}'", entry.where, closest(name, known))
    for node in descend(expression.root):
        if isinstance(node, Name) and node.path not in (*metrics, *found.totals):
            raise fail(f"'{node.path}' is not a metric of {bench.name}", entry.where, closest(node.path, metrics))
    return found
