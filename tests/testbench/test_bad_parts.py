"""FMUs that crash, hang or compute nonsense: the study survives and says which one did what."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspaces import written

from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.loading.workspace import Workspace
from dse.storage.folder import StudyFolder
from dse.testbench import make_runner
from dse.testbench.study import prepare_study

FILES = {
    "components/interfaces.yaml": """\
interfaces:
  source: {outputs: {y: m}}
  sink: {inputs: {u: m}, outputs: {y: m}}
""",
    "components/moody/component.yaml": """\
component: moody
implements: source
source: {kind: c, files: [moody.c], step: 10 ms}
parameters: {mood: {start: 0, min: 0, max: 3}}
""",
    "components/moody/moody.h": """\
typedef struct {
    struct { double y; } out;
    struct { double mood; } par;
    long n;
} moody;
void moody_init(moody *self);
void moody_step(moody *self);
""",
    "components/moody/moody.c": """\
#include "moody.h"
#include <math.h>
void moody_init(moody *self) { self->n = 0; self->out.y = 1.0; }
void moody_step(moody *self) {
    self->n++;
    self->out.y = 1.0 + (double)self->n;
    if (self->n < 50) return;
    if (self->par.mood == 1.0) { volatile int *nowhere = 0; *nowhere = 1; }
    if (self->par.mood == 2.0) { for (volatile long i = 0; ; i++) { } }
    if (self->par.mood == 3.0) { self->out.y = sqrt(-self->out.y); }
}
""",
    "components/follower/component.yaml": """\
component: follower
implements: sink
source: {kind: c, files: [follower.c]}
""",
    "components/follower/follower.h": """\
typedef struct { struct { double u; } in; struct { double y; } out; } follower;
void follower_init(follower *self);
void follower_step(follower *self, double h);
""",
    "components/follower/follower.c": """\
#include "follower.h"
void follower_init(follower *self) { self->out.y = self->in.u; }
void follower_step(follower *self, double h) { self->out.y += h * (self->in.u - self->out.y); }
""",
    "designs/pair.yaml": """\
design: pair
root:
  compound: {head: moody, tail: follower}
  connections: [head.y -> tail.u]
""",
    "testbenches/pair.yaml": """\
testbench: pair
design: pair
simulation: {stop: 1 s, step: 10 ms, record: [tail.y], timeout: 1.5 s}
metrics: {last: final(tail.y)}
requirements: {R1: {metric: last, at_most: 1000 m}}
""",
    "testbenches/moods.pet.yaml": """\
study: moods
testbench: pair
design_variables: {head.mood: {range: [0, 3], levels: 4}}
keep_waveforms: none
""",
}


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(written(tmp_path, FILES))


@pytest.mark.thorough
def test_each_bad_run_is_a_row_that_names_the_fmu_the_call_and_the_time(workspace, tmp_path):
    study = workspace.study("moods")
    planned = prepare_study(study, cache=tmp_path / "cache")
    with StudyFolder.create(tmp_path / "out", planned.definition) as store:
        summary = explore(study, planned.benches, store, executor=Local(workers=2), make_runner=make_runner)
        good, crashed, hung, nonsense = store.table().runs()
    assert summary.failed == 3
    assert good.problem == ""
    assert good.judgements[0].verdict == "pass"
    assert "head: fmi2DoStep at t = 0.49 s" in crashed.problem
    assert "head: fmi2DoStep at t = 0.49 s" in hung.problem
    assert "1.5 s" in hung.problem
    assert "head.y became nan at t = 0.5 s" in nonsense.problem
    assert {run.judgements[0].verdict for run in (crashed, hung, nonsense)} == {"failed to run"}
