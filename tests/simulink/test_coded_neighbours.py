"""Coded models beside others with the same names: each computes what it computes alone."""

from __future__ import annotations

import json
import subprocess
import sys
from itertools import count, islice
from pathlib import Path

import coded_texts as texts
import pytest
from coded_workspaces import ENABLED, SPEEDS, workspace
from command_line import run_dse
from port_workspaces import run
from private_memory import keeps

from dse.domain.run import RunRequest
from dse.fmu import find_compiler
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.prepare import prepare_bench
from dse.testbench.runner import Runner

pytest.importorskip("clang.cindex")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="libraries are loaded before others on Linux")

# Whatever the models have, and nothing like it.
_CLASHING = """
double clash_U[4] = {7, 7, 7, 7}, clash_Y[4], clash_DW[4] = {9, 9, 9, 9}, clash_P[4] = {100, 100, 100, 100};
void abort(void);
void clash_step(void) { abort(); }
void clash_initialize(void) { abort(); }
int dse_coded_step(void) { abort(); }
int dse_coded_start(void) { abort(); }
void *dse_coded_new(void) { abort(); }
"""


@pytest.mark.thorough
def test_models_of_the_same_name_and_a_library_that_exports_theirs_do_not_meet(tmp_path: Path) -> None:
    source, library = tmp_path / "other.c", tmp_path / "other.so"
    source.write_text(_CLASHING, encoding="utf-8")
    subprocess.run([*find_compiler().command, "-shared", "-fPIC", str(source), "-o", str(library)], check=True)
    models = {"one": texts.whole_program("clash"), "two": texts.whole_program("clash")}
    models["two"] = {name: text.replace("{ 3.0 }", "{ 5.0 }") for name, text in models["two"].items()}
    root = workspace(tmp_path / "workspace", models, is_together=True)
    for options in ((), ("--fuse",)):
        arguments = ("simulate", "see", *options, "--output", "found.json", "--format", "json")
        # What the dynamic linker looks up by name it finds there first.
        done = run_dse(root, *arguments, cache=tmp_path / "cache", LD_PRELOAD=str(library))
        assert done.returncode == 0, done.stdout + done.stderr
        found = json.loads((root / "found.json").read_text(encoding="utf-8"))
        for name, gain in (("one", 3.0), ("two", 5.0)):
            values = found["signals"][f"{name}.filtered"]["values"]
            expected = [0.0, *texts.lag(SPEEDS, gain, ENABLED)]
            assert values == pytest.approx(expected[: len(values)], rel=1e-12)


@pytest.mark.thorough
def test_a_model_that_cannot_be_unloaded_is_not_the_next_one(tmp_path: Path) -> None:
    # A file with the number of the old one has its name, by which the dynamic linker would take the old one for it.
    stays = """
  struct { const char *file; void *base; const char *name; void *place; } found;
  extern int dladdr(const void *, void *);
  extern void *dlopen(const char *, int);
  dladdr((void *) stay_step, &found);
  dlopen(found.file, 0x1002);
"""
    files = dict(texts.whole_program("stay"))
    files["stay.c"] = files["stay.c"].replace("stay_U.speed = 0.0;", stays)
    made = run(workspace(tmp_path / "workspace", {"one": files}), cache=tmp_path / "cache")
    assert made.waveforms is not None, made.problem
    values = list(made.waveforms.values["part.filtered"])
    assert values == pytest.approx([0.0, *texts.lag(SPEEDS, 3.0, ENABLED)][: len(values)], rel=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("style", ["whole_program", "class_of_cpp"])
def test_thousands_of_runs_leave_nothing_behind(style: str, tmp_path: Path) -> None:
    root = workspace(tmp_path / "workspace", {"one": getattr(texts, style)("one")}, stop="0.3 s")
    tested = Workspace(root).bench("see")
    space = open_space(tested.design).configurations()
    (prepared,) = prepare_bench(tested, space, version=2, cache=tmp_path / "cache").values()
    numbers = count()
    with Runner(prepared) as runner:

        def use() -> None:
            for number in islice(numbers, 1000):
                made = runner.run(RunRequest(number, prepared.configuration.id, {}), keep=False)
                assert made.metrics["end"] == pytest.approx(texts.lag(SPEEDS, 3.0, ENABLED)[2], rel=1e-12)

        def held() -> tuple[int, int]:
            maps = Path("/proc/self/maps").read_text(encoding="utf-8")
            return len(list(Path("/proc/self/fd").iterdir())), maps.count("memfd:model")

        use()
        before = held()
        assert not keeps(use, 1_000_000)  # less than a kB a run; a copy of the library takes 14
        assert held() == before
