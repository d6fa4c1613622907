"""The check of a run with half the step: what it changes is each metric's error bar."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from workspaces import OSCILLATOR, written

from dse.domain.method import Adaptive, Method
from dse.domain.run import Outcome, RunRequest
from dse.loading.workspace import Workspace
from dse.testbench.runner import Runner
from dse.testbench.study import bench_study, prepare_study
from dse.testbench.variations import scaled

FILES = {
    **OSCILLATOR,
    "testbenches/swing.yaml": """\
testbench: swing
design: one
simulation: {stop: 1 s, step: 10 ms, record: [mass.x], check_step: true}
metrics:
  end: final(mass.x)
  never: reach_time(mass.x, target = mass.far)
requirements:
  R1: {metric: end, at_most: 1 m}
""",
}


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    written(tmp_path, FILES)
    monkeypatch.chdir(tmp_path)
    return Workspace(tmp_path).bench("swing")


def run_of(bench, **point: float):
    planned = prepare_study(bench_study(bench))
    ((identity, prepared),) = planned.benches.items()
    with Runner(prepared) as executor:
        return executor.run(RunRequest(0, identity, point), keep=False), planned


@pytest.mark.thorough
def test_the_error_bar_is_the_error_with_a_quarter_more(bench):
    run, _ = run_of(bench)
    step = replace(bench.simulation, step=0.005, record_every=0.005, check_step=False)
    finer, _ = run_of(replace(bench, simulation=step))
    # Jacobi is of first order: the error of the run is about twice what half the step changes (Richardson).
    true_error = abs(run.metrics["end"] - math.cos(1.0))
    assert true_error == pytest.approx(2 * abs(run.metrics["end"] - finer.metrics["end"]), rel=0.05)
    assert run.metrics["end.error"] == pytest.approx(1.25 * true_error, rel=0.05)


def test_a_metric_that_is_undefined_in_both_runs_has_no_error_bar(bench):
    run, _ = run_of(bench)
    assert math.isnan(run.metrics["never"])
    assert math.isnan(run.metrics["never.error"])


def test_a_metric_that_only_one_of_the_runs_defines_has_an_infinite_error_bar(bench):
    first, _ = run_of(bench)
    step = replace(bench.simulation, step=0.005, record_every=0.005, check_step=False)
    second, _ = run_of(replace(bench, simulation=step))
    # The mass falls all the time: between the two ends lies what only one of the runs reaches, by 2 %.
    between = (first.metrics["end"] + second.metrics["end"]) / 2
    run, _ = run_of(bench, **{"mass.far": between / 1.02})
    assert math.isinf(run.metrics["never.error"])


def test_a_run_that_fails_with_half_the_step_says_so_and_keeps_its_metrics(bench):
    run, _ = run_of(bench, **{"mass.fails_below": 0.007})
    assert run.outcome is Outcome.DONE
    assert math.isfinite(run.metrics["end"])
    assert math.isnan(run.metrics["end.error"])
    assert run.problem.startswith("with half the step: mass.x became nan")


def test_error_bars_are_columns_of_the_study(bench):
    _, planned = run_of(bench)
    names = [metric.name for metric in planned.definition.metrics]
    assert names == ["end", "never", "end.error", "never.error"]
    assert planned.definition.metrics[2].error_of == "end"


def test_without_the_check_nothing_is_added(bench):
    plain = replace(bench, simulation=replace(bench.simulation, check_step=False))
    run, planned = run_of(plain)
    assert set(run.metrics) == {"end", "never"}
    assert len(planned.definition.metrics) == 2


def test_steps_of_parts_are_halved_too():
    assert scaled(Method(steps={"a": 0.5, "b": 2.0}), 0.5).steps == {"a": 0.25, "b": 1.0}


def test_the_error_bar_of_adaptive_steps_is_of_the_size_of_the_error(bench):
    # The tolerance decides on the steps: with the same one the finer run would make the same steps.
    simulation = replace(
        bench.simulation, step=0.1, record_every=0.1, method=Method(adaptive=Adaptive(1e-3, 1e-6, 1e-6))
    )
    run, _ = run_of(replace(bench, simulation=simulation))
    true_error = abs(run.metrics["end"] - math.cos(1.0))
    assert true_error / 4 < run.metrics["end.error"] < 4 * true_error
