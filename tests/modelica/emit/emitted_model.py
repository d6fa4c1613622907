"""Emitted C, compiled with every warning an error and called through ctypes."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import dse.fmu
from dse import csolve
from dse.fmu.toolchain.compilation import LANGUAGE_OPTIONS
from dse.fmu.toolchain.compiler import environment, find_compiler
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.expressions.setting import memory_layout
from dse.modelica.emit.model import emit
from dse.modelica.emit.variables import FmuVariable, variables
from dse.modelica.solved_model import Solved

INCLUDES = (f"-I{Path(dse.fmu.__file__).parent / 'runtime'}", f"-I{csolve.INCLUDE}")
_SHIM = """
#include "model.h"
#define ROOM 64
static char told[ROOM][200];
static int told_count;
static dse_component component;
double *test_v(void) { return component.v; }
double *test_pre(void) { return component.pre; }
double *test_data(void) { return component.data; }
void test_time(double time) { component.time = time; }
unsigned char *test_held(void) { return component.held; }
unsigned char *test_is_true(void) { return component.is_true; }
unsigned char *test_was_true(void) { return component.was_true; }
unsigned char *test_is_active(void) { return component.is_active; }
unsigned char *test_ticks(void) { return component.ticks; }
void test_start(void) {
    memset(&component, 0, sizeof component);
    told_count = 0;
    memcpy(component.v, dse_starts, sizeof component.v);
}
const char *test_failure(int code) { return dse_failure[(code < 0 ? -code : code) - 1]; }
const char *test_token(void) { return dse_token; }
static void tell(dse_component *m, int check, int is_warning, const char *text) {
    (void)m;
    snprintf(told[told_count++ % ROOM], sizeof told[0], "%d %d %s", check, is_warning, text);
}
int test_told_count(void) { return told_count; }
const char *test_told(int number) { return told[number]; }
int test_parameters(void) { return model_parameters(&component); }
int test_guess(void) { return model_guess(&component); }
int test_initial(void) { return model_initial(&component); }
int test_derivatives(void) { return model_derivatives(&component); }
int test_outputs(void) { return model_outputs(&component); }
int test_event(void) { return model_event(&component); }
int test_reinitialize(void) { return model_reinitialize(&component); }
int test_check(void) { return model_check(&component, tell); }
int test_event_check(void) { return model_event_check(&component, tell); }
int test_aliases(void) { model_aliases(&component); return 0; }
static double crossing[DSE_ROOM(DSE_RELATIONS)];
static unsigned char truth[DSE_ROOM(DSE_RELATIONS)];
int test_relations(void) { return model_relations(&component, crossing, truth); }
double test_crossing(int number) { return crossing[number]; }
int test_truth(int number) { return truth[number]; }
double test_nominal(int number) { return dse_nominals[number]; }
int test_clock(int number, int part) {
    const struct dse_clock *c = &dse_clocks[number];
    return (int)(part == 0 ? c->period : part == 1 ? c->phase : c->denominator);
}
int test_unused(void) {
    return (int)(dse_state[0] + dse_derivative[0] + dse_discrete[0] + dse_slots[0].offset) + !dse_state_names[0]
           + !dse_names[0] + !dse_relations[0] + (int)DSE_SLOT_COUNT;
}
"""


@dataclass
class Emitted:
    """One compiled model and its single instance. `call` returns what the function does; values are by symbol."""

    library: ctypes.CDLL
    places: Mapping[Symbol, int]
    files: Mapping[str, bytes]
    variables: tuple[FmuVariable, ...]
    own: Mapping[str, int] = field(default_factory=dict)

    def call(self, name: str) -> int:
        return int(getattr(self.library, f"test_{name}")())

    def doubles(self, name: str) -> ctypes.Array[ctypes.c_double]:
        function = getattr(self.library, f"test_{name}")
        function.restype = ctypes.POINTER(ctypes.c_double)
        found: ctypes.Array[ctypes.c_double] = function()
        return found

    def flags(self, name: str) -> ctypes.Array[ctypes.c_ubyte]:
        function = getattr(self.library, f"test_{name}")
        function.restype = ctypes.POINTER(ctypes.c_ubyte)
        found: ctypes.Array[ctypes.c_ubyte] = function()
        return found

    def text(self, name: str, number: int) -> str:
        function = getattr(self.library, f"test_{name}")
        function.restype = ctypes.c_char_p
        return bytes(function(number)).decode()

    def double(self, name: str, number: int) -> float:
        function = getattr(self.library, f"test_{name}")
        function.restype = ctypes.c_double
        return float(function(number))

    def set(self, values: Mapping[Symbol, float]) -> None:
        v = self.doubles("v")
        for symbol, value in values.items():
            v[self.places[symbol]] = value

    def get(self, symbol: Symbol) -> float:
        return float(self.doubles("v")[self.places[symbol]])

    def start(self, **parameters: float) -> None:
        """The order of the runtime: starts, what was set, parameters, guesses, initialization, parameters."""
        self.library.test_start()
        v = self.doubles("v")
        by_name = {each.name: each.place for each in self.variables}
        for name, value in parameters.items():
            v[by_name[name]] = value
        for function in ("parameters", "guess"):
            assert self.call(function) == 0


Emitter = Callable[..., Emitted]


def compiled(folder: Path, solved: Solved, options: tuple[str, ...], starts: Mapping[str, float] | None) -> Emitted:
    """Emit, compile and load *solved*; *options* go to the compiler."""
    listed = variables(solved, starts)
    files = emit(solved, listed, "{token}")
    shim = "#include <stdio.h>\n" + _SHIM
    for name, content in {**files, "shim.c": shim.encode()}.items():
        (folder / name).write_bytes(content)
    library = folder / "model.so"
    compiler = find_compiler()
    warnings = ("-Wall", "-Wextra", "-Werror", "-Wno-unused-function")
    command = [*compiler.command, *LANGUAGE_OPTIONS, *warnings, *options, "-shared", "-fPIC", *INCLUDES]
    command += [str(folder / "shim.c"), str(folder / "start.c"), "-o", str(library), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment(), check=False)
    assert done.returncode == 0, done.stderr[:3000]
    where = memory_layout(solved)
    made = Emitted(ctypes.CDLL(str(library)), where.places, files, listed, where.own)
    made.library.test_time.argtypes = [ctypes.c_double]
    made.library.test_start()
    return made
