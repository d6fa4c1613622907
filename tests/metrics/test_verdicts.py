"""One rule for runs as they are made and for arrays of them."""

from __future__ import annotations

import numpy as np
import pytest
from verdict_cases import BOUNDS, cases

from dse.domain.bench import VERDICTS, Metric, Requirement, overall_verdict
from dse.domain.component import Kind, Type
from dse.expression.parse import parse_expression
from dse.metrics.machine import margin_to_bounds, overall_codes, verdict_codes
from dse.metrics.program import compile_metrics
from dse.units import DIMENSIONLESS

NUMBER = Type(Kind.REAL, DIMENSIONLESS)


def test_arrays_of_runs_are_judged_case_by_case():
    runs = cases()
    values, done = np.array([run.value for run in runs]), np.array([run.done for run in runs])
    each = []
    for number, (at_most, at_least) in enumerate(BOUNDS):
        margin = margin_to_bounds(values, at_most, at_least)
        assert margin == pytest.approx([run.margins[number] for run in runs], nan_ok=True)
        each.append(verdict_codes(margin, np.array([run.exercised[number] for run in runs]), done))
        assert [VERDICTS[code] for code in each[-1]] == [run.verdicts[number] for run in runs]
    assert [VERDICTS[code] for code in overall_codes(each, done)] == [run.overall for run in runs]
    of_one = [overall_verdict([VERDICTS[codes[row]] for codes in each]) for row in range(len(runs))]
    assert of_one == [run.overall for run in runs]


@pytest.mark.parametrize("run", [run for run in cases() if run.done], ids=str)
def test_a_run_is_judged_alike_as_it_is_made(run):
    requirements = [
        Requirement(f"R{i}", "m", *bounds, DIMENSIONLESS, parse_expression(f"p.e{i} > 0.5"))
        for i, bounds in enumerate(BOUNDS)
    ]
    types = {"p.x": NUMBER, **{f"p.e{i}": NUMBER for i in range(len(BOUNDS))}}
    metric = Metric("m", parse_expression("final(p.x)"))
    program = compile_metrics([metric], requirements, types, frozenset({"p.x"}))
    constants = {f"p.e{i}": float(flag) for i, flag in enumerate(run.exercised)}
    _, judgements = program.evaluate(np.zeros(1), {"p.x": np.array([run.value])}, constants)
    assert tuple(judgement.verdict for judgement in judgements) == run.verdicts
    assert [judgement.margin for judgement in judgements] == pytest.approx(run.margins, nan_ok=True)


def test_without_a_requirement_what_came_to_its_end_passes():
    assert [VERDICTS[code] for code in overall_codes([], np.array([True, False]))] == ["pass", "failed to run"]
