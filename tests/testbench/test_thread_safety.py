"""What is built here from source is simulated in threads unless it keeps something outside of its instances."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspaces import written

from dse.domain.fmu import FmuModel
from dse.fmu import statics
from dse.fmu.fusion.sources import OwnSources, own_sources
from dse.fmu.statics import static_names
from dse.fmu.toolchain.compilation import compile_assembly
from dse.fmu.toolchain.compiler import find_compiler
from dse.loading.workspace import Workspace
from dse.testbench.study import bench_study, prepare_study

FILES = {
    "components/interfaces.yaml": "interfaces:\n  source: {outputs: {y: m}}\n",
    "components/counter/component.yaml": """\
component: counter
implements: source
source: {kind: c, files: [counter.c], step: 10 ms}
""",
    "components/counter/counter.h": """\
typedef struct { struct { double y; } out; double x; } counter;
void counter_init(counter *self);
void counter_step(counter *self);
""",
    "designs/one.yaml": "design: one\nroot: {compound: {head: counter}}\n",
    "testbenches/one.yaml": """\
testbench: one
design: one
simulation: {stop: 1 s, step: 10 ms, record: [head.y]}
metrics: {last: final(head.y)}
requirements: {R1: {metric: last, at_most: 1000 m}}
""",
}

CODE = """\
#include "counter.h"
static const double table[2] = {{1.0, 2.0}};
static const char *const names[] = {{"one", "two"}};
void counter_init(counter *self) {{ self->x = 0.0; self->out.y = (double)names[0][0]; }}
void counter_step(counter *self) {{ %s self->x += table[self->x > 5.0]; self->out.y = self->x; }}
""".replace("{{", "{").replace("}}", "}")


@pytest.mark.parametrize(
    ("line", "safe"), [("", True), ("static double before; self->x += before; before = self->x;", False)]
)
@pytest.mark.parametrize("version", [2, 3])
def test_a_c_component_with_static_variables_is_not_simulated_in_threads(
    tmp_path: Path, line: str, safe: bool, version: int
) -> None:
    written(tmp_path, {**FILES, "components/counter/counter.c": CODE % line})
    study = bench_study(Workspace(tmp_path).bench("one"))
    for _ in range(2):  # found out, and remembered
        planned = prepare_study(study, cache=tmp_path / "cache", version=version)
        assert [bench.thread_safe for bench in planned.benches.values()] == [safe]


@pytest.mark.parametrize(
    ("declaration", "found"),
    [
        ("static double state;", ["state"]),
        ("static double state = 1.0;", ["state"]),
        ("double state;", ["state"]),
        ("double state = 1.0;", ["state"]),
        ("_Thread_local double state;", ["state"]),
        ("static _Thread_local double state = 1.0;", ["state"]),
        ("static const double state = 1.0;", []),
        ("const double state = 1.0;", []),
        ('static const char *const state = "";', []),
    ],
)
def test_variables_that_last_are_found_and_constants_are_none(declaration: str, found: list[str]) -> None:
    change = "" if "const" in declaration else "state += 1.0;"
    text = f"{declaration}\ndouble use(double x) {{ {change} return x + (state != 0); }}\n"
    assembly = compile_assembly(find_compiler(), {"unit.c": text.encode()}, "unit.c")
    assert [name.removeprefix("_") for name in static_names(assembly)] == found


def test_the_sources_of_a_component_are_read_once_however_many_configurations_have_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[str] = []

    def counted(model: FmuModel) -> OwnSources:
        read.append(model.identifier)
        return own_sources(model)

    monkeypatch.setattr(statics, "own_sources", counted)
    design = "design: one\nroot: {compound: {head: counter, tail: {optional: counter}}}\n"
    written(tmp_path, {**FILES, "designs/one.yaml": design, "components/counter/counter.c": CODE % ""})
    study = bench_study(Workspace(tmp_path).bench("one"))
    planned = prepare_study(study, cache=tmp_path / "cache")
    assert [bench.thread_safe for bench in planned.benches.values()] == [True, True]
    assert len(read) == 1
