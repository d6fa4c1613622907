"""Systems that no rule for error bars was made from: peaks between rows, aliasing, relays, chaos, coupled parts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from workspaces import written

from dse.domain.run import Run, RunRequest
from dse.loading.workspace import Workspace
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.runner import Runner
from dse.testbench.study import bench_study, prepare_study

Signal = NDArray[np.float64]
POINTS = 1_000_001


@dataclass(frozen=True)
class System:
    """*parts* are C by name: ``x`` is what a part gives, ``u`` what it takes from the next one, ``s`` its state; ``t``
    and ``h`` are the time after the step and its length. *truth* gives x of part ``a`` over time; *level* is what it
    is compared with.
    """

    truth: Callable[[Signal], Signal]
    parts: Mapping[str, tuple[str, str]]
    level: float
    step: float = 0.02
    stop: float = 3.0


def given(formula: str, truth: Callable[[Signal], Signal], level: float, step: float = 0.02) -> System:
    """A signal that is exact in each row."""
    return System(truth, {"a": (f"x = {formula};", f"x = {formula};")}, level, step)


def ode(
    slopes: Callable[[float, Signal], list[float]], start: list[float], stop: float = 3.0
) -> Callable[[Signal], Signal]:
    """The first unknown of x' = *slopes*, to ten digits and more."""

    def truth(t: Signal) -> Signal:
        found = solve_ivp(slopes, (0.0, stop), start, "DOP853", rtol=1e-13, atol=1e-13, dense_output=True)
        return np.asarray(found.sol(t)[0])

    return truth


def runge(slopes: str, count: int, start: str) -> tuple[str, str]:
    """The classical method of Runge and Kutta over ``s``; *slopes* fills ``d`` from ``y``; x is the first unknown."""
    step = (
        f"double k[4][{count}], y[{count}], d[{count}]; static const double c[4] = {{0.0, 0.5, 0.5, 1.0}};"
        f" for (int i = 0; i < 4; i++) {{ for (int j = 0; j < {count}; j++)"
        " y[j] = s[j] + (i ? c[i] * h * k[i - 1][j] : 0.0);"
        f" {slopes} for (int j = 0; j < {count}; j++) k[i][j] = d[j]; }}"
        f" for (int j = 0; j < {count}; j++) s[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]); x = s[0];"
    )
    return f"{start} x = s[0];", step


EULER = ("s[0] = 1; x = 1;", "s[0] += h * u; x = s[0];")


def thermostat(t: Signal) -> Signal:
    """x' = 40 q - x between 20 and 22; q switches at once."""
    x, q, now, rows = np.zeros_like(t), 1.0, 0.0, []
    value = 18.0
    while now < t[-1]:
        edge = 22.0 if q else 20.0
        span = math.log((40.0 * q - value) / (40.0 * q - edge))
        rows.append((now, value, q))
        now, value, q = now + span, edge, 1.0 - q
    for begin, first, heat in rows:
        later = t >= begin
        x[later] = 40.0 * heat + (first - 40.0 * heat) * np.exp(-(t[later] - begin))
    return x


def bounces(t: Signal) -> Signal:
    """A ball dropped from 1 m that keeps 0.8 of its speed."""
    x, begin, speed, height = np.zeros_like(t), 0.0, 0.0, 1.0
    while begin < t[-1]:
        later = t >= begin
        dt = t[later] - begin
        x[later] = height + speed * dt - 4.905 * dt**2
        span = (speed + math.sqrt(speed**2 + 2 * 9.81 * height)) / 9.81
        begin, speed, height = begin + span, 0.8 * (9.81 * span - speed), 0.0
    return x


LORENZ = "d[0] = 10 * (y[1] - y[0]); d[1] = y[0] * (28 - y[2]) - y[1]; d[2] = y[0] * y[1] - 8.0 / 3 * y[2];"
DUFFING = "d[0] = y[1]; d[1] = y[0] - y[0] * y[0] * y[0] - 0.3 * y[1] + 0.5 * cos(1.2 * y[2]); d[2] = 1;"

SYSTEMS: Mapping[str, System] = {
    # Peaks between rows.
    "least gap": given("2 + (t - 1.2345) * (t - 1.2345)", lambda t: 2 + (t - 1.2345) ** 2, 2.5, 0.1),
    "corner": given("fabs(t - 1.4142) + 0.3", lambda t: np.abs(t - 1.4142) + 0.3, 0.8, 0.1),
    "bump": given("exp(-pow((t - 1.517) / 0.06, 2))", lambda t: np.exp(-(((t - 1.517) / 0.06) ** 2)), 0.4),
    "overshoot": given("1 - exp(-t) * cos(7.3 * t)", lambda t: 1 - np.exp(-t) * np.cos(7.3 * t), 1.2, 0.05),
    "rectified": given("fabs(sin(2.3 * t + 0.4))", lambda t: np.abs(np.sin(2.3 * t + 0.4)), 0.5, 0.05),
    # Aliasing: what repeats with the step.
    "hum": given("sin(2 * 3.14159265358979323846 * 50 * t)", lambda t: np.sin(2 * np.pi * 50 * t), 0.6),
    "hum, shifted": given(
        "1 + cos(2 * 3.14159265358979323846 * 100 * t + 1)", lambda t: 1 + np.cos(2 * np.pi * 100 * t + 1), 1.4
    ),
    "pulses": given("fmod(t + 0.003, 0.02) < 0.006", lambda t: (np.mod(t + 0.003, 0.02) < 0.006) * 1.0, 0.5),
    "beat": given("sin(2 * 3.14159265358979323846 * 49 * t)", lambda t: np.sin(2 * np.pi * 49 * t), 0.9),
    # What switches.
    "thermostat": System(
        thermostat,
        {
            "a": ("s[0] = 18; x = 18;", "s[0] = 40 * u + (s[0] - 40 * u) * exp(-h); x = s[0];"),
            "b": ("s[0] = 1; x = 1;", "if (u > 22) s[0] = 0; if (u < 20) s[0] = 1; x = s[0];"),
        },
        21.0,
        0.005,
    ),
    "relay": System(  # x' = -sign(x): to zero in a second, then chatter
        lambda t: np.maximum(1.0 - t, 0.0),
        {"a": EULER, "b": ("x = -1;", "x = u > 0 ? -1 : u < 0 ? 1 : 0;")},
        0.5,
        0.015,
    ),
    "ball": System(
        bounces,
        {
            "a": (
                "s[0] = 1; s[1] = 0; x = 1;",
                (
                    "s[0] += h * s[1] - 4.905 * h * h; s[1] -= 9.81 * h;"
                    " if (s[0] < 0 && s[1] < 0) { s[0] = 0; s[1] *= -0.8; } x = s[0];"
                ),
            )
        },
        0.4,
        0.002,
        2.0,
    ),
    # Chaos: far off at the end, whatever the step.
    "lorenz": System(
        ode(
            lambda _, y: [10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]],
            [1.0, 1.0, 20.0],
            22.0,
        ),
        {"a": runge(LORENZ, 3, "s[0] = 1; s[1] = 1; s[2] = 20;")},
        10.0,
        0.02,
        22.0,
    ),
    "duffing": System(
        ode(lambda t, y: [y[1], y[0] - y[0] ** 3 - 0.3 * y[1] + 0.5 * math.cos(1.2 * t)], [0.5, 0.0], 60.0),
        {"a": runge(DUFFING, 3, "s[0] = 0.5; s[1] = 0; s[2] = 0;")},
        1.0,
        0.3,
        60.0,
    ),
    # Coupled parts.
    "spring": System(
        ode(lambda _, y: [y[1], -9 * y[0]], [1.0, 0.0]),
        {
            "a": ("s[0] = 1; s[1] = 0; x = 1;", "s[0] += h * s[1] + h * h / 2 * u; s[1] += h * u; x = s[0];"),
            "b": ("x = -9 * u;", "x = -9 * u;"),
        },
        0.5,
    ),
    "predator": System(
        ode(lambda _, y: [y[0] * (1 - y[1]), y[1] * (y[0] - 1)], [2.0, 1.0], 8.0),
        {
            "a": ("s[0] = 2; x = 2;", "s[0] += h * s[0] * (1 - u); x = s[0];"),
            "b": ("s[0] = 1; x = 1;", "s[0] += h * s[0] * (u - 1); x = s[0];"),
        },
        1.2,
        0.01,
        8.0,
    ),
    "van der pol": System(
        ode(lambda _, y: [y[1], 2 * (1 - y[0] ** 2) * y[1] - y[0]], [2.0, 0.0], 9.0),
        {
            "a": ("s[0] = 2; x = 2;", "s[0] += h * u; x = s[0];"),
            "b": ("s[0] = 0; x = 0;", "s[0] += h * (2 * (1 - u * u) * s[0] - u); x = s[0];"),
        },
        1.0,
        0.005,
        9.0,
    ),
    "loop": System(
        ode(lambda _, y: [y[1] - y[0], 4 * (1 - y[0])], [0.0, 0.0], 6.0),
        {
            "a": ("s[0] = 0; x = 0;", "s[0] = u + (s[0] - u) * exp(-h); x = s[0];"),
            "b": ("s[0] = 0; x = 0;", "s[0] += 4 * h * (1 - u); x = s[0];"),
        },
        0.9,
        0.02,
        6.0,
    ),
    "tanks": System(
        ode(
            lambda t, y: [math.sqrt(max(y[1], 0)) - math.sqrt(max(y[0], 0)), 0.6 - math.sqrt(max(y[1], 0))], [0.2, 1.0]
        ),
        {
            "a": ("s[0] = 0.2; x = 0.2;", "s[0] += h * (sqrt(u) - sqrt(s[0])); x = s[0];"),
            "b": ("s[0] = 1; x = 1;", "(void)u; s[0] += h * (0.6 - sqrt(s[0])); x = s[0];"),
        },
        0.3,
    ),
    "forced": System(
        ode(lambda t, y: [y[1], -25 * y[0] - y[1] + 5 * math.sin(4 * t)], [0.0, 0.0], 5.0),
        {
            "a": runge("d[0] = y[1]; d[1] = -25 * y[0] - y[1] + u;", 2, "s[0] = 0; s[1] = 0;"),
            "b": ("x = 0;", "(void)u; x = 5 * sin(4 * t);"),
        },
        0.4,
        0.02,
        5.0,
    ),
}

METRICS = {
    "end": "final(a.x)",
    "most": "maximum(a.x)",
    "least": "minimum(a.x)",
    "mean": "mean(a.x)",
    "rms": "rms(a.x)",
    "held": "duration(a.x > {level})",
    "reach": "reach_time(a.x, target = {level}, band = 0)",
}


def right(system: System) -> dict[str, float]:
    """The metrics of the solution, from a million points of it."""
    return _metrics(system.truth, system.stop, system.level, POINTS)


def run_of(system: System, folder: Path) -> Run:
    """The run of *system* with error bars; its files are written into *folder*."""
    wires = "  connections: [b.x -> a.u, a.x -> b.u]\n" if len(system.parts) == 2 else ""
    takes, given_in, u = ("inputs: {u: 1}, ", "struct { double u; } in; ", "self->in.u") if wires else ("", "", "0.0")
    parts = ", ".join(f"{name}: part_{name}" for name in system.parts)
    texts = {
        "components/interfaces.yaml": f"interfaces:\n  part: {{{takes}outputs: {{x: 1}}}}\n",
        "designs/d.yaml": f"design: d\nroot:\n  compound: {{{parts}}}\n{wires}",
        "testbenches/b.yaml": _bench(system.stop, system.step, system.level),
    }
    common = f"double *s = self->s, t = self->t, u = {u}, x = 0.0; (void)s; (void)t; (void)u;"
    for name, (start, step) in system.parts.items():
        home = f"components/part_{name}"
        texts |= {
            f"{home}/component.yaml": f"component: part_{name}\nimplements: part\n"
            "source: {kind: c, files: [p.c], struct: p}\n",
            f"{home}/p.h": f"typedef struct {{ {given_in}struct {{ double x; }} out; double s[3], t; }} p;\n"
            "void p_init(p *self);\nvoid p_step(p *self, double h);\n",
            f"{home}/p.c": '#include "p.h"\n#include <math.h>\n'
            f"void p_init(p *self) {{ self->t = 0.0; {common} {start} self->out.x = x; }}\n"
            f"void p_step(p *self, double h) {{ self->t += h; {common} {step} self->out.x = x; }}\n",
        }
    ((identity, prepared),) = _prepared(texts, folder).items()
    with Runner(prepared) as runner:
        return runner.run(RunRequest(0, identity, {}), keep=False)


def _metrics(truth: Callable[[Signal], Signal], stop: float, level: float, points: int) -> dict[str, float]:
    t = np.linspace(0.0, stop, points)
    x = truth(t)
    side = x >= level if x[0] < level else x <= level
    first = int(side.argmax())
    return {
        "end": float(x[-1]),
        "most": float(x.max()),
        "least": float(x.min()),
        "mean": float(np.trapezoid(x, t)) / stop,
        "rms": math.sqrt(float(np.trapezoid(x**2, t)) / stop),
        "held": float(np.mean(x > level)) * stop,
        "reach": float(t[first]) if side[first] else math.nan,
    }


def _bench(stop: float, step: float, level: float) -> str:
    metrics = "".join(f'  {name}: "{text.format(level=level)}"\n' for name, text in METRICS.items())
    times = f"simulation: {{stop: {stop} s, step: {step} s, check_step: true}}"
    return f"testbench: b\ndesign: d\n{times}\nmetrics:\n{metrics}"


def _prepared(texts: Mapping[str, str], folder: Path) -> Mapping[str, PreparedBench]:
    written(folder, texts)
    return prepare_study(bench_study(Workspace(folder).bench("b"))).benches


PART = """\
#include "p.h"
void p_init(p *self) { self->s[0] = self->par.x0; self->s[1] = self->par.y0; self->out.x = self->s[0]; }
static void slopes(const p *self, const double *y, double *d) {
    d[0] = self->par.a * y[0] + self->par.b * y[1] + self->par.g * self->in.u;
    d[1] = self->par.c * y[0] + self->par.d * y[1];
}
void p_step(p *self, double h) {
    double k[4][2], y[2];
    slopes(self, self->s, k[0]);
    if (self->par.runge < 0.5) {
        for (int j = 0; j < 2; j++) self->s[j] += h * k[0][j];
    } else {
        for (int i = 1; i < 4; i++) {
            for (int j = 0; j < 2; j++) y[j] = self->s[j] + (i < 3 ? 0.5 : 1.0) * h * k[i - 1][j];
            slopes(self, y, k[i]);
        }
        for (int j = 0; j < 2; j++) self->s[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
    }
    self->out.x = self->s[0];
}
"""
NAMES = ("a", "b", "c", "d", "g", "x0", "y0", "runge")


def coupled(count: int, folder: Path) -> Iterator[tuple[Mapping[str, float], Mapping[str, float]]]:
    """Two linear parts of second order in a loop, *count* times at random: metrics with their error bars, and right."""
    names = ", ".join(f"{name}: {{start: 0}}" for name in NAMES)
    members = ", ".join(NAMES)
    texts = {
        "components/interfaces.yaml": "interfaces:\n  part: {inputs: {u: 1}, outputs: {x: 1}}\n",
        "components/part/component.yaml": "component: part\nimplements: part\n"
        f"source: {{kind: c, files: [p.c], struct: p}}\nparameters: {{{names}}}\n",
        "components/part/p.h": "typedef struct { struct { double u; } in; struct { double x; } out;"
        f" struct {{ double {members}; }} par; double s[2]; }} p;\n"
        "void p_init(p *self);\nvoid p_step(p *self, double h);\n",
        "components/part/p.c": PART,
        "designs/d.yaml": "design: d\nroot:\n  compound: {a: part, b: part}\n  connections: [b.x -> a.u, a.x -> b.u]\n",
        "testbenches/b.yaml": _bench(3.0, 0.01, 0.5),
    }
    ((identity, prepared),) = _prepared(texts, folder).items()
    random = np.random.default_rng(31)
    with Runner(prepared) as runner:
        for number in range(count):
            parts = {part: dict(zip(NAMES, _draw(random), strict=True)) for part in "ab"}
            point = {f"{part}.{name}": value for part, values in parts.items() for name, value in values.items()}
            run = runner.run(RunRequest(number, identity, point), keep=False)
            yield run.metrics, _metrics(_linear(**parts), 3.0, 0.5, 60_001)


def _draw(random: np.random.Generator) -> list[float]:
    damping, frequency = random.uniform(0.1, 2.0), random.uniform(0.5, 8.0)
    start = random.uniform(-1.0, 1.0, 2)
    return [-damping, frequency, -frequency, -damping, random.uniform(-2.0, 2.0), *start, float(random.integers(2))]


def _linear(a: Mapping[str, float], b: Mapping[str, float]) -> Callable[[Signal], Signal]:
    matrix = np.zeros((4, 4))
    for at, part in ((0, a), (2, b)):
        matrix[at : at + 2, at : at + 2] = [[part["a"], part["b"]], [part["c"], part["d"]]]
        matrix[at, 2 - at] = part["g"]
    values, vectors = np.linalg.eig(matrix)
    weights = np.linalg.solve(vectors, np.array([a["x0"], a["y0"], b["x0"], b["y0"]], dtype=complex))
    return lambda t: np.real((vectors[0] * weights) @ np.exp(np.outer(values, t)))
