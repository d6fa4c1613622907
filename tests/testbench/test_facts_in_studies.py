"""A study acts on what is known of its FMUs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from workspaces import written

from dse.domain.facts import Answer, FmuFacts, Question
from dse.domain.study import Keep
from dse.errors import DseError
from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.fmu.toolchain.platforms import this_platform
from dse.loading.workspace import Workspace
from dse.storage.folder import StudyFolder
from dse.testbench import make_runner
from dse.testbench.facts import keep_facts
from dse.testbench.study import PreparedStudy, bench_study, prepare_study

FILES = {
    "components/interfaces.yaml": "interfaces:\n  source: {outputs: {y: m}}\n",
    "components/fragile/component.yaml": """\
component: fragile
implements: source
source: {kind: c, files: [fragile.c], step: 10 ms}
parameters: {gain: {start: 0, min: 0, max: 24}}
""",
    "components/fragile/fragile.h": """\
typedef struct { struct { double y; } out; struct { double gain; } par; double x; } fragile;
void fragile_init(fragile *self);
void fragile_step(fragile *self);
""",
    # It is initialized once for every instance and every run, and dies of the 21st time in one process.
    "components/fragile/fragile.c": """\
#include "fragile.h"
static int times;
void fragile_init(fragile *self) {
    if (++times > 20) { volatile int *nowhere = 0; *nowhere = 1; }
    self->x = self->out.y = 0.0;
}
void fragile_step(fragile *self) { self->x += self->par.gain; self->out.y = self->x; }
""",
    "designs/one.yaml": "design: one\nroot: {compound: {head: fragile}}\n",
    "testbenches/one.yaml": """\
testbench: one
design: one
simulation: {stop: 1 s, step: 10 ms, record: [head.y]}
metrics: {last: final(head.y)}
requirements: {R1: {metric: last, at_most: 1000 m}}
""",
    "testbenches/gains.pet.yaml": """\
study: gains
testbench: one
design_variables: {head.gain: {range: [0, 24], levels: 25}}
keep_waveforms: none
""",
    "designs/two.yaml": "design: two\nroot: {compound: {head: fragile, tail: fragile}}\n",
    "testbenches/two.yaml": """\
testbench: two
design: two
simulation: {stop: 1 s, step: 10 ms, record: [head.y, tail.y]}
metrics: {last: final(head.y)}
requirements: {R1: {metric: last, at_most: 1000 m}}
""",
}


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(written(tmp_path, FILES))


def know(planned: PreparedStudy, cache: Path, answers: dict[Question, Answer], instances: int = 0) -> None:
    (prepared,) = planned.benches.values()
    (content,) = {element.model.content_hash for element in prepared.system.elements}
    known = FmuFacts(content, this_platform().name, "fragile", 2, "CoSimulation", answers, instances=instances)
    keep_facts(known, cache=cache)


def problems(planned: PreparedStudy, folder: Path, threads: int = 1) -> list[str]:
    with StudyFolder.create(folder, planned.definition) as store:
        explore(
            planned.study, planned.benches, store, executor=Local(workers=1, threads=threads), make_runner=make_runner
        )
        return [run.problem for run in store.table().runs() if run.problem]


def deaths(folder: Path) -> list[str]:
    with StudyFolder.open(folder) as store:
        return [attempt.cause for attempt in store.attempts() if attempt.cause]


@pytest.mark.parametrize("keep", [Keep.NONE, Keep.ALL])
@pytest.mark.thorough
def test_a_process_is_renewed_before_an_fmu_dies_of_too_many_instances(workspace, tmp_path, keep):
    study, cache = replace(workspace.study("gains"), keep=keep), tmp_path / "cache"
    unknown = prepare_study(study, cache=cache)
    assert problems(unknown, tmp_path / "unknown") == []  # a fresh process makes the run that the worn one died of
    (died,) = deaths(tmp_path / "unknown")
    assert died.startswith("crashed (signal 11)")
    know(unknown, cache, {Question.LASTS: Answer.NO, Question.RESETS: Answer.NO}, instances=12)
    assert problems(prepare_study(study, cache=cache), tmp_path / "known") == []
    assert deaths(tmp_path / "known") == []


def test_what_is_known_changes_neither_the_study_nor_its_numbers(workspace, tmp_path):
    study, cache = workspace.study("gains"), tmp_path / "cache"
    before = prepare_study(study, cache=cache)
    know(before, cache, {Question.RESETS: Answer.NO, Question.THREADS: Answer.NO})
    after = prepare_study(study, cache=cache)
    assert after.definition == before.definition


def test_a_system_its_fmus_do_not_bear_is_refused_before_the_first_run(workspace, tmp_path):
    bench, cache = workspace.bench("two"), tmp_path / "cache"
    study = bench_study(bench)
    know(prepare_study(study, cache=cache), cache, {Question.COEXISTS: Answer.NO})
    with pytest.raises(DseError, match=r"two\.yaml.*head, tail: fragile does not support several instances"):
        prepare_study(study, cache=cache)


def test_threads_are_taken_only_where_they_are_known_to_be_borne(workspace, tmp_path):
    study, cache = workspace.study("gains"), tmp_path / "cache"
    (ours,) = prepare_study(study, cache=cache).benches.values()
    assert not ours.thread_safe  # its instances have a variable in common
    for answer in (Answer.YES, Answer.NO):
        know(prepare_study(study, cache=cache), cache, {Question.THREADS: answer})
        (probed,) = prepare_study(study, cache=cache).benches.values()
        assert probed.thread_safe is (answer is Answer.YES)
