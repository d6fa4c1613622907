"""The models the runtime is tested with; each has a closed form or a published solution."""

from __future__ import annotations

from dataclasses import replace

from fmu.modelica_models.bench import Handmade

OSCILLATOR = Handmade(
    name="oscillator",
    values={"x": 1.0, "v": 0.0, "a": 0.0, "rate": 2.0, "energy": 0.0, "stiffness": 0.0},
    states={"x": "v", "v": "a"},
    roles={"rate": "TUNABLE", "x": "FIXED", "v": "FIXED"},
    code={
        "parameters": "V(stiffness) = V(rate) * V(rate);",
        "derivatives": "V(a) = -V(stiffness) * V(x);",
        "outputs": "V(energy) = 0.5 * (V(v) * V(v) + V(stiffness) * V(x) * V(x));",
    },
)
"""x = cos(rate * t)"""

LAG = Handmade(
    name="lag",
    values={"x": 0.0, "slope": 0.0, "u": 0.0, "lag": 0.5, "gain": 3.0, "y": 0.0, "through": 0.0},
    states={"x": "slope"},
    roles={"u": "INPUT", "lag": "TUNABLE", "gain": "FIXED"},
    code={
        "derivatives": "V(slope) = (V(u) - V(x)) / V(lag);",
        "outputs": "V(y) = V(gain) * V(x); V(through) = V(u) + V(x);",
    },
)
"""x moves to u with the time constant *lag*"""

VAN_DER_POL = Handmade(
    name="van_der_pol",
    values={"x": 2.0, "v": 0.0, "a": 0.0, "mu": 1000.0},
    states={"x": "v", "v": "a"},
    roles={"mu": "FIXED"},
    code={"derivatives": "V(a) = V(mu) * (1.0 - V(x) * V(x)) * V(v) - V(x);"},
)

ROBERTSON = Handmade(
    name="robertson",
    values={"y1": 1.0, "y2": 0.0, "y3": 0.0, "d1": 0.0, "d2": 0.0, "d3": 0.0},
    states={"y1": "d1", "y2": "d2", "y3": "d3"},
    nominals={"y2": 1e-4},
    solver="STIFF",
    code={
        "derivatives": "V(d1) = -0.04 * V(y1) + 1e4 * V(y2) * V(y3); V(d3) = 3e7 * V(y2) * V(y2);"
        "V(d2) = -V(d1) - V(d3);"
    },
)

FORCED = Handmade(
    name="forced",
    values={"x": 1.0, "v": 0.0, "a": 0.0},
    states={"x": "v", "v": "a"},
    code={"derivatives": "V(a) = -V(x) * V(x) * V(x) - 0.1 * V(v) + cos(1.3 * m->time);"},
)
"""No closed form; for the order of convergence."""

BALL = Handmade(
    name="ball",
    values={"h": 1.0, "v": 0.0, "a": -9.81, "bounces": 0.0, "last": 0.0, "loss": 0.3},
    states={"h": "v", "v": "a"},
    kinds={"bounces": ("INTEGER", 0)},
    roles={"loss": "TUNABLE"},
    discretes=("bounces", "last"),
    relations=(("V(h)", "<=", "0.0"),),
    conditions=1,
    triggers=1,
    code={
        "derivatives": "V(a) = -9.81;",
        "initial": "m->is_true[0] = m->held[0]; m->is_active[0] = 0;",
        "event": "m->is_true[0] = m->held[0]; m->is_active[0] = m->is_true[0] && !m->was_true[0];"
        "V(bounces) = m->is_active[0] ? PRE(0) + 1.0 : PRE(0); V(last) = m->is_active[0] ? m->time : PRE(1);",
        "reinitialize": "if (m->is_active[0]) { V(v) = -(1.0 - V(loss)) * V(v); return 1; }",
    },
)
"""Bounces lose *loss* of the speed; *last* is the time of the last one."""

RELAY = Handmade(
    name="relay",
    values={"x": 20.0, "slope": 0.0, "on": 0.0, "switches": 0.0},
    states={"x": "slope"},
    kinds={"on": ("BOOLEAN", 0), "switches": ("INTEGER", 0)},
    discretes=("on", "switches"),
    relations=(("V(x)", "<", "19.0"), ("V(x)", ">", "21.0")),
    code={
        "derivatives": "V(slope) = V(on) ? 30.0 - V(x) : 10.0 - V(x);",
        "initial": "V(on) = m->held[0] || (PRE(0) && !m->held[1]); V(switches) = PRE(1); return model_derivatives(m);",
        "event": "V(on) = m->held[0] || (PRE(0) && !m->held[1]);"
        "V(switches) = PRE(1) + (V(on) != PRE(0)); return model_derivatives(m);",
    },
)
"""A heater with hysteresis: towards 30 when on, towards 10 when off, switched at 19 and 21."""

SAMPLED = Handmade(
    name="sampled",
    values={"x": 0.0, "slope": 0.0, "u": 0.0, "ticks": 0.0, "at": -1.0, "held_input": 0.0, "demand": 1.0},
    states={"x": "slope"},
    roles={"demand": "INPUT"},
    kinds={"ticks": ("INTEGER", 0)},
    discretes=("u", "ticks", "at", "held_input"),
    clocks=((1, 0, 100),),
    triggers=1,
    code={
        "derivatives": "V(slope) = -V(x) + V(u);",
        "initial": "m->is_active[0] = 0; V(u) = PRE(0); V(ticks) = PRE(1); V(at) = PRE(2); V(held_input) = PRE(3);"
        "return model_derivatives(m);",
        "event": "m->is_active[0] = m->ticks[0]; const int is_active = m->is_active[0];"
        "V(u) = is_active ? 4.0 * (V(demand) - V(x)) : PRE(0); V(ticks) = is_active ? PRE(1) + 1.0 : PRE(1);"
        "V(at) = is_active ? m->time : PRE(2); V(held_input) = is_active ? V(demand) : PRE(3);"
        "return model_derivatives(m);",
    },
)
"""A sampled proportional controller of a lag, every 10 ms."""

PULSE = Handmade(
    name="pulse",
    values={"x": 0.0, "slope": 0.0, "high": 0.0, "count": 0.0, "from": 0.2, "to": 0.21},
    states={"x": "slope"},
    kinds={"high": ("BOOLEAN", 0), "count": ("INTEGER", 0)},
    roles={"from": "FIXED", "to": "FIXED"},
    discretes=("high", "count"),
    relations=(("m->time", ">=", "V(from)"), ("m->time", ">=", "V(to)")),
    code={
        "derivatives": "V(slope) = V(high);",
        "initial": "V(high) = m->held[0] && !m->held[1]; V(count) = PRE(1); return model_derivatives(m);",
        "event": "V(high) = m->held[0] && !m->held[1]; V(count) = PRE(1) + (V(high) > PRE(0));"
        "return model_derivatives(m);",
    },
)
"""x is the area of one pulse of height 1."""

GRAZE = Handmade(
    name="graze",
    values={"x": 0.0, "v": 0.0, "a": 0.0, "passed": 0.0, "level": 0.999},
    states={"x": "v", "v": "a"},
    kinds={"passed": ("INTEGER", 0)},
    roles={"level": "FIXED", "v": "FIXED"},
    discretes=("passed",),
    relations=(("V(x)", ">", "V(level)"),),
    conditions=1,
    triggers=1,
    code={
        "guess": "V(v) = 1.0;",
        "derivatives": "V(a) = -V(x);",
        "initial": "m->is_true[0] = m->held[0]; m->is_active[0] = 0; V(passed) = PRE(0);",
        "event": "m->is_true[0] = m->held[0]; m->is_active[0] = m->is_true[0] && !m->was_true[0];"
        "V(passed) = PRE(0) + m->is_active[0];",
    },
)
"""x = sin(t): above *level* for a short while once a period."""

TANK = Handmade(
    name="tank",
    values={"h": 1.0, "slope": 0.0, "u": 0.0},
    states={"h": "slope"},
    roles={"h": "FIXED", "u": "INPUT"},
    relations=(("V(h)", ">", "0.0"),),
    code={"derivatives": "V(slope) = V(u) + (m->held[0] ? -sqrt(V(h)) - 0.1 : 0.0);"},
)
"""A tank that runs empty; the outflow has no value below the ground."""

SCHMITT = Handmade(
    name="schmitt",
    values={"x": 0.0, "v": 1.0, "a": 0.0, "b": 1.0, "changes": 0.0},
    states={"x": "v", "v": "a"},
    kinds={"b": ("BOOLEAN", 0), "changes": ("INTEGER", 0)},
    discretes=("b", "changes"),
    relations=(("V(x)", ">", "(PRE(0) ? -0.1 : 0.1)"),),
    code={
        "derivatives": "V(a) = -V(x);",
        "initial": "V(b) = m->held[0]; V(changes) = 0.0;",
        "event": "V(b) = m->held[0]; V(changes) = PRE(1) + (V(b) != PRE(0));",
    },
)
"""x = sin(t); b = x > (if pre(b) then -0.1 else 0.1)"""

CHATTER = Handmade(
    name="chatter",
    values={"x": 1.0, "slope": 0.0},
    states={"x": "slope"},
    relations=(("V(x)", ">", "0.0"),),
    code={"derivatives": "V(slope) = m->held[0] ? -1.0 : 1.0;"},
)

ENDLESS = Handmade(
    name="endless",
    values={"x": 0.0, "slope": 1.0, "b": 0.0},
    states={"x": "slope"},
    kinds={"b": ("BOOLEAN", 0)},
    discretes=("b",),
    relations=(("V(x)", ">", "0.5"),),
    code={
        "derivatives": "V(slope) = 1.0;",
        "event": "V(b) = m->held[0] ? !PRE(0) : PRE(0);",
    },
)

ROOT = Handmade(
    name="root",
    values={"x": 1.0, "slope": 0.0, "y": 1.0},
    states={"x": "slope"},
    failures=("model.mo:7:3: y ^ 2 = x has no solution",),
    code={
        "derivatives": "const uint32_t places[] = {place_y}; const double scales[] = {1.0};"
        "if (dse_newton(m, 1, places, scales, root_system, 1)) { return 1; } V(slope) = -1.0;"
    },
    extra="static int root_system(dse_component *m, double *residual, double *jacobian) {"
    "residual[0] = V(y) * V(y) - V(x); if (jacobian) { jacobian[0] = 2.0 * V(y); } return 0; }",
)
"""y = sqrt(x) by Newton's method, until x becomes negative at 1 s."""

CHECKED = Handmade(
    name="checked",
    values={"x": 0.0, "slope": 1.0, "top": 0.3, "end": 10.0, "warn": 10.0},
    states={"x": "slope"},
    roles={"top": "FIXED", "end": "FIXED", "warn": "FIXED"},
    checks=3,
    code={
        "derivatives": "V(slope) = 1.0;",
        "check": 'if (!(V(x) < V(warn))) { tell(m, 0, 1, "x is getting large"); }'
        'if (!(V(x) < V(top))) { tell(m, 1, 0, "x must stay below top"); return 1; }'
        'if (V(x) >= V(end)) { tell(m, 2, 0, "the end is reached"); return 2; }',
    },
)

BLOW_UP = Handmade(
    name="blow_up",
    values={"x": 1.0, "slope": 0.0},
    states={"x": "slope"},
    code={"derivatives": "V(slope) = V(x) * V(x);"},
)
"""x = 1 / (1 - t)"""

KINDS = Handmade(
    name="kinds",
    values={"flag": 0.0, "count": 3.0, "mode": 2.0, "twice": 0.0, "next": 0.0, "not_flag": 1.0, "not_a_number": 0.0},
    roles={"flag": "INPUT", "count": "TUNABLE", "mode": "INPUT"},
    kinds={
        "flag": ("BOOLEAN", 0), "count": ("INTEGER", 0), "mode": ("ENUMERATION", 3), "twice": ("INTEGER", 0),
        "next": ("ENUMERATION", 3), "not_flag": ("BOOLEAN", 0),
    },
    discretes=("twice", "next", "not_flag"),
    code={
        "outputs": "V(not_a_number) = V(count) == 7.0 ? NAN : 0.0;",
        "initial": "V(twice) = 2.0 * V(count); V(next) = V(mode) >= 3.0 ? 1.0 : V(mode) + 1.0; V(not_flag) = !V(flag);",
        "event": "V(twice) = 2.0 * V(count); V(next) = V(mode) >= 3.0 ? 1.0 : V(mode) + 1.0; V(not_flag) = !V(flag);",
    },
)  # fmt: skip

STIFF_OSCILLATOR = replace(OSCILLATOR, name="stiff_oscillator", solver="STIFF")
"""The oscillator by the stiff solver."""
