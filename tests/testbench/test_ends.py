"""A run that an FMU ends is measured and judged over what there is, and its row says who ended it when."""

from __future__ import annotations

from pathlib import Path

import pytest
from reference_fmus import build

from dse.domain.bench import Verdict
from dse.domain.run import Outcome, RunRequest
from dse.interchange.importing.component import import_component
from dse.loading.workspace import Workspace
from dse.testbench.runner import Runner
from dse.testbench.study import bench_study, prepare_study

DESIGN = "design: alone\nroot: {compound: {stair: stair}}\n"
BENCH = """\
testbench: ending
design: alone
parameters: {stair.last: LAST}
simulation: {stop: 20 s, step: 400 ms, record: [stair.counter], record_every: 800 ms, check_step: true}
metrics: {last: final(stair.counter), seconds: integral(stair.counter)}
requirements: {R1: {metric: last, at_least: LAST}}
"""


def run_to(last: int, folder: Path):
    import_component(build("Stair", 3, "CoSimulation", folder), folder, "stair")
    for name, text in (("designs/alone.yaml", DESIGN), ("testbenches/ending.yaml", BENCH.replace("LAST", str(last)))):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    ((identity, prepared),) = prepare_study(bench_study(Workspace(folder).bench("ending"))).benches.items()
    with Runner(prepared) as runner:
        return [runner.run(RunRequest(number, identity, {}), keep=True) for number in range(3)]


def test_metrics_and_requirements_are_of_what_there_is(tmp_path):
    runs = run_to(4, tmp_path)
    for run in runs:  # fresh, proving the reset, after a reset
        assert run.outcome is Outcome.DONE
        assert run.problem == "ended early: stair: fmi3UpdateDiscreteStates at t = 3 s asked to end the simulation"
        # Asked for at 3 s: the last row is that of 2.8 s, with half the step that of 3.0 s: 4. 2.5 times that.
        assert (run.metrics["last"], run.metrics["last.error"]) == (3, 2.5)
        assert run.judgements[0].verdict is Verdict.FAIL
        assert run.waveforms.time.tolist() == pytest.approx([0.0, 0.8, 1.6, 2.4])
        assert run.waveforms.values["stair.counter"].tolist() == [1, 1, 2, 3]
    assert runs[0].metrics == runs[1].metrics == runs[2].metrics
