"""A fused system computes what its FMUs do, bit for bit."""

from __future__ import annotations

import math
import threading
from dataclasses import replace

import numpy as np
import pytest
from fusion.conftest import (
    GEAR,
    IN_TURN,
    REAL,
    TRUTH,
    WHOLE,
    Workshop,
    assert_same,
    both_ways,
    failures,
    ports,
    system_of,
)
from hypothesis import HealthCheck, given, settings, strategies as st

from dse.cosim.binding.calls import AccessorType, Call as KernelCall, function_name, type_of
from dse.cosim.simulator import Simulator
from dse.domain.component import Parameter
from dse.domain.fmu import Variable
from dse.domain.method import PLAIN
from dse.fmu.fusion.values import ACCESSORS

SPRING = """
void spring_init(spring *c) { c->out.x = c->par.x0; c->out.v = 0; }
void spring_step(spring *c, double h) {
    for (int i = 0; i < 4; i++) {
        c->out.v += h / 4 * (c->in.force - sin(c->out.x)) / c->par.mass;
        c->out.x += h / 4 * c->out.v;
    }
}
"""
SPRING_MEMBERS = "struct { double force; } in; struct { double x, v; } out; struct { double x0, mass; } par;"
SPRING_PORTS = ports({"force": REAL}, {"x": REAL, "v": REAL})
SPRING_PARAMETERS = (Parameter("x0", REAL, 1.0), Parameter("mass", REAL, 0.7))
DAMPER = """
static double gain(const damper *c) { return c->par.gain; }
void damper_init(damper *c) { c->out.force = 0; }
void damper_step(damper *c) { c->out.force = -gain(c) * c->in.v; c->out.hits++; }
"""
DAMPER_MEMBERS = "struct { double v; } in; struct { double force; int hits; } out; struct { double gain; } par;"
DAMPER_PORTS = ports({"v": REAL}, {"force": REAL, "hits": WHOLE})


def spring(workshop):
    return workshop.c("spring", SPRING_MEMBERS, SPRING, SPRING_PORTS, SPRING_PARAMETERS)


def damper(workshop, step=0.02):
    return workshop.c("damper", DAMPER_MEMBERS, DAMPER, DAMPER_PORTS, [Parameter("gain", REAL, 0.3)], step)


def test_a_loop_of_a_plant_and_a_sampled_controller_is_the_same(workshop):
    wires = ["mass.v -> brake.v", "brake.force -> mass.force"]
    record = ["brake.hits", "mass.x", "brake.force"]
    system = system_of({"mass": spring(workshop), "brake": damper(workshop)}, wires, record)
    starts = [{"mass.x0": 0.1 * n, "brake.gain": 0.3 + 0.1 * n} for n in range(5)]
    runs = both_ways(workshop, system, record, starts)
    assert [run[-1, 0] for run in runs] == [50.0] * 5  # it runs every 0.02 s
    assert len({run.tobytes() for run in runs}) == 5
    # The energy a mass on a spring loses to a damper: it swings less and less.
    assert np.abs(runs[1][-20:, 1]).max() < runs[1][0, 1] or runs[1][0, 1] == 0.1


def test_two_elements_of_one_component_keep_apart(workshop):
    model = spring(workshop)
    wires = ["left.x -> right.force", "right.x -> left.force"]
    system = system_of({"left": model, "right": model}, wires, record := ["left.x", "right.x", "right.v"])
    (run,) = both_ways(workshop, system, record, [{"left.x0": 0.25, "right.mass": 3.0}])
    assert run[0, 0] == 0.25
    assert run[0, 1] == 1.0


def test_what_is_recorded_may_stand_in_any_order_and_twice(workshop):
    record = ["mass.v", "mass.x", "mass.v"]
    system = system_of({"mass": spring(workshop)}, [], record)
    system = replace(system, elements=tuple(replace(e, start={"mass": 2.0}) for e in system.elements))
    (run,) = both_ways(workshop, system, record)
    assert (run[:, 0] == run[:, 2]).all()


def test_nothing_has_to_be_recorded(workshop):
    system = system_of({"mass": spring(workshop), "brake": damper(workshop)}, ["mass.v -> brake.v"], ["brake.hits"])
    (run,) = both_ways(workshop, system, [])
    assert run.shape == (101, 0)


@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_wiring_any_record_and_any_start_is_the_same(workshop_of_once, data):
    workshop, springs, dampers = workshop_of_once
    workshop = replace(workshop, method=data.draw(st.sampled_from([PLAIN, IN_TURN])))
    chosen = data.draw(st.lists(st.sampled_from([springs, dampers]), min_size=2, max_size=5))
    models = {f"e{number}": model for number, model in enumerate(chosen)}
    outputs = [f"{name}.{'x' if model is springs else 'force'}" for name, model in models.items()]
    inputs = [f"{name}.{'force' if model is springs else 'v'}" for name, model in models.items()]
    wires = [f"{data.draw(st.sampled_from(outputs))} -> {name}" for name in data.draw(st.permutations(inputs))]
    record = data.draw(st.lists(st.sampled_from(outputs), max_size=6))
    number = st.floats(0.125, 8.0)
    starts = [{f"{name}.{'mass' if m is springs else 'gain'}": data.draw(number) for name, m in models.items()}]
    both_ways(workshop, system_of(models, wires, record), record, starts, stop=0.3)


@pytest.fixture(scope="module")
def workshop_of_once(tmp_path_factory, cache):
    workshop = Workshop(tmp_path_factory.mktemp("once"), cache)
    return workshop, spring(workshop), damper(workshop)


SEVERAL = dict(zip("abcnmtfd", (REAL, REAL, REAL, WHOLE, WHOLE, TRUTH, TRUTH, REAL), strict=True))
SEVERAL_MEMBERS = """
struct { double a, b, c; int n, m; bool t, f; double d; } in;
struct { double to_a, to_b, to_c; int to_n, to_m; bool to_t, to_f; double to_d; } out;
struct { double seed; } par;
"""
SEVERAL_CODE = """
void several_init(several *c) { c->out.to_n = 16; }
void several_step(several *c, double h) {
    const double whole = c->in.n - 2 * c->in.m + c->in.t - 3 * c->in.f + c->par.seed;
    const double now = c->in.a + 2 * c->in.b + 3 * c->in.c + 5 * c->in.d + whole;
    c->out.to_a = cos(now), c->out.to_b = 2 + sin(now), c->out.to_c = 4 + h + sin(2 * now);
    c->out.to_d = 8 + cos(3 * now);
    c->out.to_n = 16 + c->in.m % 5 + (int)(4 * sin(5 * now));
    c->out.to_m = 32 + c->in.n % 7 + (int)(4 * cos(5 * now));
    c->out.to_t = sin(7 * now) > 0, c->out.to_f = cos(9 * now) > 0;
}
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("order", ["abcnmtfd", "cbanmftd", "bcamntfd", "acd"])
def test_values_side_by_side_go_each_to_its_place(workshop, order):
    """Also where they lie in another order on the other side, or apart."""
    outputs = {f"to_{name}": kind for name, kind in SEVERAL.items()}
    interface, seed = ports(SEVERAL, outputs), Parameter("seed", REAL, 0.0)
    model = workshop.c("several", SEVERAL_MEMBERS, SEVERAL_CODE, interface, [seed])
    pairs = list(zip(SEVERAL, order, strict=False))
    wires = [f"{one}.to_{name} -> {other}.{to}" for one, other in ("ef", "fe") for name, to in pairs]
    record = [f"{element}.{name}" for element in "ef" for name in outputs]
    (run,) = both_ways(workshop, system_of({"e": model, "f": model}, wires, record), record, [{"f.seed": 1.0}])
    assert len({column.tobytes() for column in run.T}) == len(record)


MIXED = (
    "struct { float r; int8_t n; bool t; } in; struct { double y; int hits; bool odd; } out; struct { double by; } par;"
)
MIXED_CODE = """
void mixed_init(mixed *c) { c->out.y = 1; }
void mixed_step(mixed *c, double h) {
    c->out.hits++;
    c->out.odd = !c->out.odd;
    c->out.y = floor(c->in.r + c->in.n + c->in.t) * c->par.by;
}
"""
MIXED_PORTS = ports({"r": REAL, "n": WHOLE, "t": TRUTH}, {"y": REAL, "hits": WHOLE, "odd": TRUTH})


def test_a_value_goes_to_any_kind_that_has_it_or_fails_alike(workshop):
    model = workshop.c("mixed", MIXED, MIXED_CODE, MIXED_PORTS, [Parameter("by", REAL, 1.0)])
    wires = ["a.hits -> b.r", "a.odd -> b.n", "b.odd -> a.t", "b.y -> a.n", "b.odd -> a.r", "a.odd -> b.t"]
    system = system_of({"a": model, "b": model}, wires, record := ["a.y", "b.y"])
    (run,) = both_ways(workshop, system, record)
    assert run[:, 1].max() > 90
    fractional = assert_same(failures(workshop, system, record, {"b.by": 0.5}))
    assert "a.n cannot take the value" in str(fractional)
    too_wide = assert_same(failures(workshop, system, record, {"b.by": 3.0}))
    assert "a.n" in str(too_wide) or "'n'" in str(too_wide)


KINDS = {
    "real": (REAL, ("double", "float")),
    "whole": (WHOLE, ("int8_t", "int16_t", "int32_t", "int64_t", "uint8_t", "uint16_t", "uint32_t", "uint64_t")),
    "truth": (TRUTH, ("bool", "int", "uint64_t")),
    "gear": (GEAR, ("int", "uint8_t", "int64_t")),
}


@pytest.mark.thorough
def test_every_c_type_of_a_member_is_read_and_written(workshop):
    """Sources of every C type feed members of every C type of the same kind, through a component that counts up."""
    members = [(f"{kind}_{n}", port, c_type) for kind, (port, types) in KINDS.items() for n, c_type in enumerate(types)]
    outputs = " ".join(f"{c_type} {name};" for name, _, c_type in members)
    values = {"real": "1e-3 * c->n", "whole": "c->n", "truth": "c->n & 1", "gear": "c->n % 3"}
    code = "\n".join(f"c->out.{name} = {values[name.split('_')[0]]};" for name, _, _ in members)
    source = workshop.c(
        "source",
        f"struct {{ {outputs} }} out; int n;",
        f"void source_init(source *c) {{ (void)c; }}\nvoid source_step(source *c, double h) {{ c->n++; {code} }}",
        ports({}, {name: port for name, port, _ in members}),
    )
    pairs = [
        (f"{kind}_{a}_{b}", f"{kind}_{a}", port, c_type)
        for kind, (port, types) in KINDS.items()
        for a in range(len(types))
        for b, c_type in enumerate(types)
    ]
    inputs = " ".join(f"{c_type} {name};" for name, _, _, c_type in pairs)
    shown = " ".join(f"{'double' if name[:4] == 'real' else 'int64_t'} o_{name};" for name, *_ in pairs)
    code = "\n".join(f"c->out.o_{name} = c->in.{name};" for name, *_ in pairs)
    kinds = {name: WHOLE if port is TRUTH or port is GEAR else port for name, _, port, _ in pairs}
    sink = workshop.c(
        "sink",
        f"struct {{ {inputs} }} in; struct {{ {shown} }} out;",
        f"void sink_init(sink *c) {{ (void)c; }}\nvoid sink_step(sink *c, double h) {{ {code} }}",
        ports({name: port for name, _, port, _ in pairs}, {f"o_{name}": kind for name, kind in kinds.items()}),
    )
    wires = [f"a.{origin} -> b.{name}" for name, origin, _, _ in pairs]
    record = [*(f"a.{name}" for name, _, _ in members), *(f"b.o_{name}" for name, *_ in pairs)]
    (run,) = both_ways(workshop, system_of({"a": source, "b": sink}, wires, record), record)
    last = dict(zip(record, run[-1], strict=True))
    assert last["a.whole_0"] == 100
    seen = 100 if workshop.method == IN_TURN else 99  # one step behind
    assert last["b.o_whole_3_0"] == seen
    assert last["b.o_real_1_0"] == pytest.approx(seen / 1000, rel=1e-7)  # it went through a float
    assert last["b.o_gear_2_1"] == seen % 3


LAG = """
  parameter Real T = 0.2;
  input Real u;
  input Boolean on;
  output Real y(start = 0, fixed = true);
  output Boolean high;
  output Integer level;
equation
  T * der(y) = (if on then 2 * u else u) - y;
  high = y > 0.5;
  level = if high then 2 else 1;
"""
LAG_PORTS = ports({"u": REAL, "on": TRUTH}, {"y": REAL, "high": TRUTH, "level": WHOLE})
PULSE = """
void pulse_init(pulse *c) { c->out.on = false; }
void pulse_step(pulse *c) { c->n++; c->out.on = c->n % 20 < 7; c->out.y = cos(0.1 * c->n) - 0.01 * c->in.level; }
"""


@pytest.mark.thorough
def test_models_from_modelica_and_c_work_together(workshop):
    lag = workshop.modelica("Lag", LAG, LAG_PORTS, [Parameter("T", REAL, 0.2)])
    members = "struct { int level; } in; struct { double y; bool on; } out; int n;"
    pulse = workshop.c("pulse", members, PULSE, ports({"level": WHOLE}, {"y": REAL, "on": TRUTH}), step=0.01)
    wires = ["p.y -> a.u", "p.on -> a.on", "a.level -> p.level", "a.y -> b.u", "a.high -> b.on"]
    record = ["a.y", "b.y", "a.high", "b.level", "p.on"]
    system = system_of({"a": lag, "p": pulse, "b": lag}, wires, record)
    runs = both_ways(workshop, system, record, [{}, {"a.T": 0.05}, {"b.T": 1.0}])
    assert {0.0, 1.0} == set(runs[1][:, 2])


@pytest.mark.sampled(2)
@pytest.mark.thorough
def test_a_model_alone_relaxes_as_its_equation_says(workshop):
    lag = workshop.modelica("Lag", LAG, LAG_PORTS, [Parameter("T", REAL, 0.2)])
    (run,) = both_ways(workshop, system_of({"a": lag}, [], ["a.y"]), ["a.y"], [{"a.u": 1.0, "a.T": 0.5}])
    # The solver's relative tolerance is 1e-6; errors of hundred steps may add up.
    assert run[-1, 0] == pytest.approx(1 - math.exp(-1 / 0.5), abs=1e-5)


@pytest.mark.sampled(2)
def test_names_that_several_components_use_do_not_clash(workshop):
    """The same functions, variables, types and macros in every component, some of them static, some not."""
    members = "struct { double u; } in; struct { double y; } out;"
    models = {}
    for name, factor in (("one", 2), ("two", 3)):
        code = f"""
        #include "shared.h"
        #define FACTOR {factor}
        double clamp(double x) {{ return x > limit ? limit : x; }}
        static double scaled(double x) {{ return FACTOR * x; }}
        void {name}_init({name} *c) {{ c->out.y = 1; }}
        void {name}_step({name} *c, double h) {{ c->out.y = clamp(scaled(c->in.u + h)) + counted(); }}
        """
        more = {
            "shared.h": "extern double limit; double counted(void);\n",
            "shared.c": f"""#include "shared.h"
            double limit = {factor}0; int count;
            static double scaled(double x) {{ return x / {factor}; }}
            double counted(void) {{ return scaled(count++); }}
            """,
        }
        models[name] = workshop.c(name, members, code, ports({"u": REAL}, {"y": REAL}), more=more)
    wires = ["a.y -> b.u", "b.y -> a.u"]
    system = system_of({"a": models["one"], "b": models["two"]}, wires, record := ["a.y", "b.y"])
    fused = workshop.fuse(system, record)
    # Counted in a static variable, which survives a reset: one run each, for the counts to be equal.
    method = workshop.method
    with (
        Simulator(system, record, method=method) as plain,
        Simulator(system, record, method=method, fused=fused) as quick,
    ):
        expected, found = (simulator.run(stop=0.1, step=0.01) for simulator in (plain, quick))
    assert found.tobytes() == expected.tobytes()
    assert expected[-1, 1] > 30


@pytest.mark.sampled(2)
def test_simulators_in_threads_do_not_disturb_each_other(workshop):
    wires = ["mass.v -> brake.v", "brake.force -> mass.force"]
    system = system_of({"mass": spring(workshop), "brake": damper(workshop)}, wires, record := ["mass.x"])
    fused = workshop.fuse(system, record)
    found: dict[int, bytes] = {}

    def simulate(number: int) -> None:
        with workshop.simulator(system, record, fused) as simulator:
            runs = [simulator.run(stop=5, step=0.01, start={"mass.x0": 0.1 * number}) for _ in range(5)]
        assert all((run == runs[0]).all() for run in runs)
        found[number] = runs[0].tobytes()

    threads = [threading.Thread(target=simulate, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with workshop.simulator(system, record) as simulator:
        for number in range(4):
            assert found[number] == simulator.run(stop=5, step=0.01, start={"mass.x0": 0.1 * number}).tobytes()


def test_the_loop_numbers_types_as_the_kernel_does():
    for version, accessors in ACCESSORS.items():
        for fmi_type, (number, accessor) in accessors.items():
            kernels = type_of(Variable("x", 0, fmi_type, "output", None), version)
            assert kernels == AccessorType(number)
            assert accessor == function_name(KernelCall.GET + number, version)
