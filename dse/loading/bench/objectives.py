"""What a study looks for: metrics and sums of properties to be made small or large."""

from __future__ import annotations

import re

from dse.domain.bench import TestBench
from dse.domain.design import candidates
from dse.domain.expression import Call, Name
from dse.domain.sampler import Objective
from dse.errors import closest, fail
from dse.expression import parse_expression
from dse.formats import Entry

_WRITTEN = re.compile(r"(minimize|maximize)\s+(.+)", re.DOTALL)


def read_objective(entry: Entry, written: str, bench: TestBench) -> Objective:
    """``minimize METRIC``, ``maximize METRIC``, or either of ``sum(PROPERTY)`` over the design. Raises DseError."""
    match = _WRITTEN.fullmatch(written.strip())
    if not match:
        raise fail(f"expected an objective, found '{written}'", entry.where, "minimize METRIC, or minimize sum(cost)")
    maximize = match[1] == "maximize"
    root = parse_expression(match[2], entry.where).root
    metrics = [metric.name for metric in bench.metrics]
    match root:
        case Call("sum", arguments=(Name(path=name),)):
            found = candidates(bench.design.root).values()
            known = {stated for components in found for each in components for stated in each.properties}
            if name not in known:
                raise fail(f"no component of the design states '{name}'", entry.where, closest(name, known))
            return Objective(name, maximize, is_total=True)
        case Name(path=name) if name in metrics:
            return Objective(name, maximize)
        case Name(path=name):
            raise fail(f"'{name}' is no metric of {bench.name}", entry.where, closest(name, metrics))
    what = "an objective is a metric, or a sum of a property"
    raise fail(what, entry.where, "give the bench a metric that computes it")
