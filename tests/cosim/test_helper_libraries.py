"""Libraries in a process: one of each file, and of helper libraries one of each name."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from dse.cosim.binding.library import load, unload
from dse.cosim.simulator import Simulator
from dse.errors import DseError, FreshProcessNeeded
from dse.fmu.toolchain.compiler import find_compiler

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the test's FMUs are linked for Linux")

_HELPED = r"""
#include "fmu.h"
double helped(void);
enum { U, K, C, Y };
static void set_defaults(Model *m) { m->value[Y] = 0; }
static int reset(Model *m) { return set_defaults(m), OK; }
static int initialize(Model *m) { return m->value[Y] = helped(), OK; }
static int step(Model *m, double time, double h) { return (void)m, (void)time, (void)h, OK; }
"""


def helped(shelf, folder: Path, helper: str, number: float):
    """An FMU like gain, whose y is what the library *helper* beside it returns."""
    folder.mkdir()
    compiler = [*find_compiler().command, "-shared", "-fPIC", f"-I{Path(__file__).parent / 'fmus'}"]
    (folder / "helper.c").write_text(f"double helped(void) {{ return {number}; }}")
    (folder / "main.c").write_text(_HELPED)
    beside = [f"-Wl,-soname,{helper}", "helper.c", "-o", helper]
    linked = ["-DFMI=2", "-DIDENTIFIER=gain", "main.c", helper, "-Wl,-rpath,$ORIGIN", "-o", "helped.so"]
    for command in ([*compiler, *beside], [*compiler, *linked]):
        subprocess.run(command, cwd=folder, check=True)
    return replace(shelf.fmu("gain"), library=folder / "helped.so", folder=folder)


def last(shelf, *models):
    elements = {f"e{i}": model for i, model in enumerate(models)}
    record = [f"{name}.y" for name in elements]
    with Simulator(shelf.system(elements, (), {}, record), record) as simulator:
        return simulator.run(stop=0.1, step=0.1)[-1].tolist()


def test_an_fmu_never_computes_with_the_helper_of_another(shelf, tmp_path):
    one, two = (helped(shelf, tmp_path / name, "libclash.so", n) for name, n in (("one", 1.0), ("two", 2.0)))
    assert last(shelf, one) == [1]
    with pytest.raises(FreshProcessNeeded, match=r"e0: gain: it would compute with another FMU's libclash\.so"):
        last(shelf, two)
    with pytest.raises(DseError, match="e1: gain: it would compute"):
        last(shelf, one, two)
    assert last(shelf, one) == [1]


def test_helpers_that_are_the_same_or_have_names_of_their_own_are_no_trouble(shelf, tmp_path):
    models = [
        helped(shelf, tmp_path / name, f"lib{helper}.so.1", number)
        for name, helper, number in (("a", "own", 1.0), ("b", "shared", 2.0), ("c", "shared", 2.0))
    ]
    assert last(shelf, *models) == [1, 2, 2]


def test_a_library_is_loaded_once_unless_its_file_is_another(shelf, tmp_path):
    models = [replace(shelf.fmu(name), library=tmp_path / "fmu.so") for name in ("gain", "counter")]
    shutil.copy(shelf.fmu("gain").library, tmp_path / "fmu.so")
    first = load(models[0])
    assert load(models[0]) is first
    shutil.copy(shelf.fmu("counter").library, tmp_path / "new.so")
    (tmp_path / "new.so").replace(tmp_path / "fmu.so")
    assert load(models[1]) is not first
    (tmp_path / "fmu.so").unlink()
    with pytest.raises(DseError, match="gone since"):
        load(models[1])


def test_a_library_that_is_unloaded_is_gone_and_can_be_loaded_again(shelf, tmp_path):
    library = tmp_path / "fmu.so"
    shutil.copy(shelf.fmu("gain").library, library)
    model = replace(shelf.fmu("gain"), library=library)
    before = last(shelf, model)
    unload(load(model))
    assert str(library) not in Path("/proc/self/maps").read_text()
    assert last(shelf, model) == before
    assert str(library) in Path("/proc/self/maps").read_text()
