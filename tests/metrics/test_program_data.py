"""Compiled metrics as data, which the report's page computes as the machine does."""

from __future__ import annotations

import inspect
import json
from pathlib import Path

import numpy as np
import pytest
from metric_program_cases import FILE, HERE, SIGNALS, case_program, case_results

from dse.domain.bench import Metric
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.loading import Workspace
from dse.metrics import compile_metrics, functions, program_as_data
from dse.metrics.catalogue import ROWWISE, Argument, Wants, metric_function, same
from dse.metrics.compiler import OPERATORS
from dse.places import NO_BENCHES
from dse.testbench import check_bench, one_configuration
from dse.units import DIMENSIONLESS

WORKSPACE = Workspace(Path(__file__).parents[2])
BENCHES = [path.name for path in WORKSPACE.files("testbenches") if not path.name.endswith(NO_BENCHES)]
CASES = json.loads(FILE.read_text(encoding="utf-8"))


def test_the_cases_of_the_page_are_what_the_machine_computes():
    program = case_program()
    assert json.loads(json.dumps(program_as_data(program))) == CASES["program"]
    for case in CASES["cases"]:
        found = case_results(program, case)
        assert found["verdicts"] == case["verdicts"]
        for key in ("metrics", "margins"):
            wanted = np.array(case[key], dtype=np.float64)
            # Powers may differ in the last bits from one C library to another.
            np.testing.assert_allclose(np.array(found[key], dtype=np.float64), wanted, rtol=1e-12, atol=0)


def test_the_cases_of_the_page_use_every_function_and_operator():
    own = {name for name, _ in inspect.getmembers(functions, inspect.isfunction) if not name.startswith("_")}
    words = {*own, *OPERATORS, *ROWWISE, "negative", "not", "is_true", "select"} - {"iff"}
    assert {word for word, *_ in CASES["program"]["instructions"]} == words


def peak_to_peak(x):
    return float(np.max(x) - np.min(x))


def test_a_function_of_another_package_is_refused_by_name():
    x = Argument("x", Wants.WAVEFORM, any_unit=True)
    texts = ("peak_to_peak(a.x)", "maximum(a.x)")
    metrics = [Metric(f"m{n}", parse_expression(text, HERE), DIMENSIONLESS) for n, text in enumerate(texts)]
    offered = {"peak_to_peak": metric_function(peak_to_peak, [x], same)}
    program = compile_metrics(metrics, (), SIGNALS, frozenset(SIGNALS), offered)
    with pytest.raises(DseError, match=f"'peak_to_peak' of {__name__}") as error:
        program_as_data(program)
    assert len(error.value.problems) == 1


@pytest.mark.thorough
@pytest.mark.parametrize("name", BENCHES)
def test_all_metrics_of_every_bench_can_be_data(name):
    bench = WORKSPACE.bench(str(WORKSPACE.root / "testbenches" / name))
    data = program_as_data(check_bench(bench, one_configuration(bench.design, None)).program)
    assert (len(data["metrics"]), len(data["checks"])) == (len(bench.metrics), len(bench.requirements))


def test_all_benches_are_found():
    assert len(BENCHES) >= 44
