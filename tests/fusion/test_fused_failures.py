"""A fused system fails as its FMUs do: the same words, place, time and log; and a crash is told by name."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from fusion.conftest import CASES, GEAR, IN_TURN, REAL, WHOLE, assert_same, failures, ports, system_of

import dse
from dse.cosim.failure.progress import PROGRESS_BYTES, describe_progress
from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.component import Parameter

FAULTS = """
void faulty_init(faulty *c) { c->out.y = 1; c->out.gear = 1; }
void faulty_step(faulty *c, double h) {
    (void)h;
    if (++c->n < (int)c->par.at) return;
    switch (c->par.fault) {
    case 1: c->out.y = NAN; break;
    case 2: c->out.y = -INFINITY; break;
    case 3: c->out.gear = 7; break;
    case 4: c->out.n = 5000000000; break;
    case 5: c->out.y = 1e39; break;
    case 6: c->out.n = 300; break;
    case 7: *(volatile int *)0 = 1; break;
    case 8: c->out.big = 18446744073709551615u; break;
    default: break;
    }
}
"""
MEMBERS = """
struct { double u; } in;
struct { double y; int64_t n; int gear; uint64_t big; } out;
struct { int fault; double at; } par;
int n;
"""
PORTS = ports({"u": REAL}, {"y": REAL, "n": WHOLE, "gear": GEAR, "big": WHOLE})
TAKER = """
void taker_init(taker *c) { (void)c; }
void taker_step(taker *c, double h) { (void)h; c->out.y = c->in.u + c->in.n; }
"""


@pytest.fixture
def faulty(workshop):
    """A faulty component that feeds a narrow one, and is fed by that."""
    bad = workshop.c("faulty", MEMBERS, FAULTS, PORTS, [Parameter("fault", WHOLE, 0), Parameter("at", REAL, 40.0)])
    members = "struct { float u; int8_t n; int gear; } in; struct { double y; } out;"
    taker = workshop.c("taker", members, TAKER, ports({"u": REAL, "n": WHOLE, "gear": GEAR}, {"y": REAL}))
    wires = ["bad.y -> b.u", "bad.n -> b.n", "bad.gear -> b.gear", "b.y -> bad.u"]
    return system_of({"first": taker, "bad": bad, "b": taker}, wires, ["first.y", "bad.big", "b.y"])


FAILING = {1: "nan", 2: "-inf", 3: "gear", 4: "5000000000", 5: "1e+39", 6: "300", 8: "big"}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("fault", FAILING)
def test_a_value_that_fmi_refuses_or_that_is_not_finite_ends_the_run_alike(workshop, faulty, fault):
    failed = assert_same(failures(workshop, faulty, ["b.y"], {"bad.fault": fault, "bad.at": 40.0}))
    # In turn, what another is about to be given is looked at first.
    assert failed.time == pytest.approx(0.4, abs=0.011 if workshop.method == IN_TURN else 1e-9)
    assert FAILING[fault] in str(failed)


def test_a_fault_in_the_last_step_is_found_too(workshop, faulty):
    failed = assert_same(failures(workshop, faulty, ["b.y"], {"bad.fault": 1, "bad.at": 100.0}))
    assert failed.time == pytest.approx(1.0, abs=0.011 if workshop.method == IN_TURN else 1e-9)


BROKEN = """
void broken_init(broken *c) { (void)c; }
void broken_step(broken *c, double h) {
    (&c->out.a)[c->par.which] = ++c->n == 20 ? INFINITY : h;
}
"""
BROKEN_MEMBERS = "struct { double a, b, c; } out; struct { int which; } par; int n;"
SUM_MEMBERS = "struct { double a, b, c; } in; struct { double y; } out;"
SUM = """
void sum_init(sum *c) { (void)c; }
void sum_step(sum *c, double h) { c->out.y += h * (c->in.a + c->in.b + c->in.c); }
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("taking", ["first", "last"])
def test_each_of_several_values_side_by_side_is_looked_at(workshop, taking):
    """It is not finite for one step only, and taken by who has its turn before or after."""
    three = dict.fromkeys("abc", REAL)
    bad = workshop.c("broken", BROKEN_MEMBERS, BROKEN, ports({}, three), [Parameter("which", WHOLE, 0)])
    total = workshop.c("sum", SUM_MEMBERS, SUM, ports(three, {"y": REAL}))
    wires = [f"bad.{name} -> {taking}.{name}" for name in three]
    system = system_of({"first": total, "bad": bad, "last": total}, wires, ["first.y", "last.y"])
    for which, name in enumerate(three):
        failed = assert_same(failures(workshop, system, ["last.y"], {"bad.which": which}))
        assert failed.time == pytest.approx(0.2, abs=0.011)
        assert f"bad.{name}" in str(failed) or f"'{name}'" in str(failed)


@pytest.mark.sampled(2)
def test_after_a_failed_run_the_next_one_is_right(workshop, faulty, method):
    fused = workshop.fuse(faulty, ["b.y"])
    with (
        Simulator(faulty, ["b.y"], method=method) as plain,
        Simulator(faulty, ["b.y"], method=method, fused=fused) as quick,
    ):
        expected = plain.run(stop=1, step=0.01)
        for fault in (1, 3, 6):
            with pytest.raises(RunFailed):
                quick.run(stop=1, step=0.01, start={"bad.fault": fault})
            if fault == 1:  # later failures come while the reset is being proven, by FMI calls
                assert quick.fused_steps == 40 - (method == IN_TURN)
            found = quick.run(stop=1, step=0.01, start={"bad.fault": 0})
            assert found.tobytes() == expected.tobytes()


MODELS = {
    "assert": 'assert(u < 0.5, "too fast");',
    "terminate": 'when u > 0.5 then terminate("there"); end when;',
    "nan": "",
}


ENDINGS = [("assert", "fmi2"), ("terminate", "fmi2"), ("terminate", "fmi3"), ("nan", "fmi3")]
ENDINGS += [(kind, f"{case}-in_turn") for kind, case in ENDINGS]


# What the versions of FMI answer differs where a model ends the simulation.
@pytest.mark.parametrize(("kind", "case"), [(kind, CASES[case]) for kind, case in ENDINGS])
@pytest.mark.thorough
def test_a_model_that_ends_the_simulation_or_cannot_go_on_fails_alike(workshop, kind):
    extra = MODELS[kind]
    equation = "y = sqrt(0.5 - u);" if kind == "nan" else "y = u;"
    text = f"input Real u; output Real y; Real x(start = 0, fixed = true); equation der(x) = u; {equation} {extra}"
    name = f"Ends{kind}"
    model = workshop.modelica(name, text, ports({"u": REAL}, {"y": REAL}))
    code = "void ramp_init(ramp *c) { c->out.y = 0; }\nvoid ramp_step(ramp *c, double h) { c->out.y += h; }"
    ramp = workshop.c("ramp", "struct { double y; } out;", code, ports({}, {"y": REAL}))
    system = system_of({"r": ramp, "m": model, "n": ramp}, ["r.y -> m.u"], ["m.y", "n.y"])
    if kind == "terminate":
        fused = workshop.fuse(system, ["m.y"])
        with workshop.simulator(system, ["m.y"]) as plain, workshop.simulator(system, ["m.y"], fused) as quick:
            for simulator in (plain, quick):  # a reset is proven by FMI calls
                simulator.reset_is_trusted = False
            ends = [(s.run(stop=1, step=0.01).tobytes(), s.ended) for s in (plain, quick)]
            assert 49 <= quick.fused_steps <= 52
        assert ends[0] == ends[1]
        assert "asked to end the simulation: " in ends[0][1]
        assert "there" in ends[0][1]
        return
    failed = assert_same(failures(workshop, system, ["m.y"]))
    assert failed.element == "m"
    # Seen by the model when the ramp has reached a half, or one step after, and rounding may delay that by one more.
    assert 0.49 <= (failed.time or 0.0) <= 0.53


CRASHING = """
import mmap, pickle, sys
from pathlib import Path
from dse.cosim.simulator import Simulator
with open(sys.argv[2], "r+b") as file:
    block = mmap.mmap(file.fileno(), 0)
system, method, fused = pickle.loads(Path(sys.argv[1]).read_bytes())
Simulator(system, ["b.y"], method=method, progress=memoryview(block), fused=fused).run(
    stop=1, step=0.01, start={"bad.fault": 7, "bad.at": 33.0}
)
"""


@pytest.mark.sampled(2)
def test_after_a_crash_the_progress_block_tells_the_step_and_the_element(workshop, faulty, version, method):
    fused = workshop.fuse(faulty, ["b.y"])
    system, block, script = (workshop.folder / name for name in ("system", "block", "crash.py"))
    system.write_bytes(pickle.dumps((faulty, method, fused)))
    block.write_bytes(bytes(PROGRESS_BYTES))
    script.write_text(CRASHING, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(Path(dse.__file__).parents[1])}
    command = [sys.executable, str(script), str(system), str(block)]
    ended = subprocess.run(command, env=environment, check=False, capture_output=True)
    assert ended.returncode != 0
    assert b"Traceback" not in ended.stderr
    assert describe_progress(block.read_bytes(), faulty, 0.01) == f"bad: fmi{version}DoStep at t = 0.32 s"
