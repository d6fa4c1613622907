"""Differential and algebraic equations: index reduction, loops, aliases, starts."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from language_case import Cases, Given, Steps, Values
from reference import Floats, remembered, root, trajectory
from scipy.linalg import expm

CASES = Cases()
case = CASES.case

EXACT = 1e-14
ROUNDED = 1e-11


@case("RigidGear", given={"u": 10.0, "ratio": 4.0, "J2": 3.0}, variants=({"ratio": -2.0}, {"J2": 0.5}, {"u": 0.0}))
def rigid_gear(t: float, given: Given) -> Values:
    inertia = given["J2"] + given["ratio"] ** 2 * 2
    drive = given["ratio"] * given["u"]
    w = 2 * drive + (1 - 2 * drive) * math.exp(-0.5 * t / inertia)
    load = given["J2"] * (drive - 0.5 * w) / inertia + 0.5 * w
    return {"speed": given["ratio"] * w, "load": load}


@case("PrescribedMotion", given={"m": 2.0}, variants=({"m": 0.1},), error=1e-13)
def prescribed_motion(t: float, given: Given) -> Values:
    v, a = 1.2 * math.cos(4 * t) + 2 * t, -4.8 * math.sin(4 * t) + 2
    return {"force": given["m"] * a, "power": given["m"] * a * v}


@remembered
def swing(length: float) -> Callable[[float], Floats]:
    start = math.asin(0.6 / length)
    return trajectory(lambda _, x: [x[1], -9.81 / length * math.sin(x[0])], [start, 0.0], 2.0)


def pendulum_residuals(v: dict[str, float]) -> list[float]:
    return [
        v["x"] ** 2 + v["y"] ** 2 - 1,
        v["x"] * v["vx"] + v["y"] * v["vy"],
        v["F"] - v["vx"] ** 2 - v["vy"] ** 2 + 9.81 * v["y"],
    ]


@case("Pendulum", stop=2.0, error=1e-6, residuals=pendulum_residuals)
def pendulum(t: float, given: Given) -> Values:
    phi, rate = swing(1.0)(t)
    return {"height": -math.cos(phi), "tension": rate**2 + 9.81 * math.cos(phi)}


@case("SpringMassChain", given={"c": 40.0, "m": 1.0}, variants=({"c": 10.0}, {"m": 4.0}))
def spring_mass_chain(t: float, given: Given) -> Values:
    stiffness = given["c"] * 2 / 3
    a = np.array([[0, 1], [-stiffness / given["m"], -0.5 / given["m"]]])
    s = (expm(a * t) @ [0.2, 0.0])[0]
    return {"y": s, "z": s / 3}


@case("DerivativeOfExpression")
def derivative_of_expression(t: float, given: Given) -> Values:
    x, w = expm(np.array([[-0.5, 1], [-1, 0]]) * t) @ [1.0, 2.0]
    dx, dw = -0.5 * x + w, -x
    return {
        "product_rate": dx * w + x * dw,
        "quotient_rate": dx / (1 + w * w) - 2 * x * w * dw / (1 + w * w) ** 2,
        "acceleration": dx + dw,
    }


@case("LinearLoop", given={"k": 3.0, "u": 2.0}, variants=({"k": -1.0}, {"u": 0.0}), error=ROUNDED)
def linear_loop(t: float, given: Given) -> Values:
    matrix = [[1, given["k"], -1], [2, -1, 1 + t], [2 + math.sin(t), 1, 1]]
    a, b, c = np.linalg.solve(matrix, [given["u"], 1, -given["u"]])
    return {"y": a + b, "z": c}


@case("NonlinearRoots", error=1e-10)
def nonlinear_roots(t: float, given: Given) -> Values:
    roots = np.sort(np.roots([1, 0, -3, -0.5 * math.sin(3 * t)]).real)
    return {"y": roots}


@case("Homotopy", stop=2.0)
def homotopy(t: float, given: Given) -> Values:
    x = float(np.max(np.roots([1, 0, -1, -0.1 * t]).real))
    # From a = 2, b = 4 to the root sqrt(3) - 1 of a^3 - 6 a + 4; Newton's method from the starts finds another.
    a = math.sqrt(3) - 1
    return {"y": [x, a, 6 - a * a, math.exp(-t), math.sin(t)]}


@remembered
def coupled() -> Callable[[float], Floats]:
    def solved(x: float) -> Floats:
        a = b = 1.0
        for _ in range(40):
            f = np.array([a * a + b * b - 4 - x, a * b + math.exp(b - 1) - 2.5 - 0.1 * x])
            step = np.linalg.solve([[2 * a, 2 * b], [b, a + math.exp(b - 1)]], f)
            a, b = a - step[0], b - step[1]
        return np.array([a, b])

    path = trajectory(lambda _, x: [solved(x[0])[0] - x[0]], [0.0], 1.0)
    return lambda t: solved(path(t)[0])


def nonlinear_residuals(v: dict[str, float]) -> list[float]:
    return [
        v["a"] ** 2 + v["b"] ** 2 - 4 - v["x"],
        v["c"] - v["a"] * v["b"],
        v["c"] + math.exp(v["b"] - 1) - 2.5 - 0.1 * v["x"],
        v["der(x)"] - v["a"] + v["x"],
    ]


@case("NonlinearSystem", error=1e-7, residuals=nonlinear_residuals)
def nonlinear_system(t: float, given: Given) -> Values:
    a, b = coupled()(t)
    return {"y": a, "z": b}


@remembered
def ladder(source: float) -> tuple[float, float]:
    def start_of(end: float) -> tuple[float, float]:
        v, i = end, 0.0
        for _ in range(6):
            i += 0.5 * v
            v += i + 0.1 * i**3
        return v, i

    end = root(lambda v: start_of(v)[0] - source, 0, source)
    return end, start_of(end)[1]


@case("TornNetwork", given={"V": 10.0}, variants=({"V": 3.0}, {"V": 0.01}), stop=0.14, error=1e-10)
def torn_network(t: float, given: Given) -> Values:
    end, first = ladder(given["V"])
    return {"y": end, "first": first}


@case("IfEquation", given={"upside": 0}, stop=2.0, events=(0.5, 1.2), variants=({"upside": 1},))
def if_equation(t: float, given: Given) -> Values:
    # down to 0.5, then x' = -x; from 1.2 on x' = 2 - 4x, until x is above 0.5 again: it tends to 0.5 from below
    x = 1 - t
    if t >= 0.5:
        x = 0.5 * math.exp(0.5 - t)
    if t >= 1.2:
        x = 0.5 + (0.5 * math.exp(-0.7) - 0.5) * math.exp(-4 * (t - 1.2))
    y = 3 * x if t < 0.5 else 3.0 if t < 1.2 else 7.0
    return {"y": y, "z": -x if given["upside"] else x}


@case("NoEventKink", error=1e-6)
def no_event_kink(t: float, given: Given) -> Values:
    area = t if t < 0.4 else 0.4 + (t * t - 0.16) / 2
    return {"y": [area, area, max(t - 0.7, 0) ** 3 / 3]}


@case("NoEventPulse", stop=9.8, events=tuple(k / 2 for k in range(20)), error=1e-6, exchanged=False)
def no_event_pulse(t: float, given: Given) -> Values:
    return {"y": math.floor(t) + min(2 * (t % 1), 1)}


@case("SquareRootGuard", error=EXACT)
def square_root_guard(t: float, given: Given) -> Values:
    x = 1 - 2 * t
    return {"y": math.sqrt(max(x, 0)), "z": np.sinc(x / math.pi)}


@case("SemiLinear", error=1e-11)
def semi_linear(t: float, given: Given) -> Values:
    x = 1 - 2 * t
    return {"y": 2 * x if x >= 0 else 5 * x, "z": math.sqrt(4 + t)}


@remembered
def slow_manifold() -> Callable[[float], Floats]:
    """The slow variable on its manifold, fast = cos(slow) - eps d/dt cos(slow), after the layer at the start."""
    eps = 1e-6

    def fast(slow: float) -> float:
        return math.cos(slow) - eps * math.sin(slow) * slow * math.cos(slow)

    path = trajectory(lambda _, x: [-x[0] * fast(x[0])], [1 + eps * math.cos(1)], 1.0)
    return lambda t: np.array([fast(path(t)[0]) if t else 0.0, path(t)[0] if t else 1.0])


@case("StiffDecay", error=1e-6)
def stiff_decay(t: float, given: Given) -> Values:
    fast, slow = slow_manifold()(t)
    return {"y": slow, "z": fast}


@remembered
def relaxation(mu: float) -> Callable[[float], Floats]:
    return trajectory(lambda _, x: [x[1], mu * (1 - x[0] ** 2) * x[1] - x[0]], [2.0, 0.0], 20.0)


@case("VanDerPol", given={"mu": 30.0}, stop=18.0, step=1.7, error=1e-5)
def van_der_pol(t: float, given: Given) -> Values:
    return {"y": relaxation(given["mu"])(t)[0]}


@case("NegatedAliases", events=(math.log(1.5),))
def negated_aliases(t: float, given: Given) -> Values:
    a = 3 * math.exp(-t)
    # b = -a, c = -b, d = -c
    return {"y": -a, "z": a, "same": -a, "positive": a >= 2}


EVERYTHING = {
    "u": Steps((0, 0.35, 0.7), (6.0, -1.0, 2.5)),
    "n": Steps((0, 0.49), (2, -5)),
    "b": Steps((0, 0.21), (1, 0)),
}


@case(
    "OutputsOfEverything", given={"p": 5.0}, variants=({"p": -2.0},), inputs=EVERYTHING, events=(0.21, 0.35, 0.49, 0.7)
)
def outputs_of_everything(t: float, given: Given) -> Values:
    u = EVERYTHING["u"].before(t)
    return {
        "of_constant": 4,
        "of_parameter": given["p"],
        "of_input": u,
        "of_opposite": -u,
        "of_time": t,
        "of_state": 7 + t,
        "of_output": 7 + t,
        "of_integer": EVERYTHING["n"].before(t),
        "of_boolean": EVERYTHING["b"].before(t),
        "literal": 8,
    }


@case("OutputIsState", given={"u": 0.5}, variants=({"u": 2.0},))
def output_is_state(t: float, given: Given) -> Values:
    u = given["u"]
    return {"y": 2 + u * t + (1 - u) * (1 - math.exp(-t))}


@case("AlgorithmSection", given={"u": 1.5}, variants=({"u": 0.5},), events=(0.3, 0.6), error=EXACT)
def algorithm_section(t: float, given: Given) -> Values:
    a = 2 * given["u"] + 1
    y = a + 100 if a > 3.5 else 3 * a
    return {"y": y, "z": y if t < 0.3 else y - a if t < 0.6 else -1}


@remembered
def from_steady_state(u: float) -> Callable[[float], Floats]:
    return trajectory(lambda t, x: [u - x[0] + 0.5 * t, x[0] - x[1] ** 3], [u, u ** (1 / 3)], 1.0)


@case("SteadyState", given={"u": 2.0}, variants=({"u": 5.0},))
def steady_state(t: float, given: Given) -> Values:
    x, z = from_steady_state(given["u"])(t)
    return {"y": z, "w": x}


@case("ParameterFromStart", given={"target": 3.0}, variants=({"target": 8.0},))
def parameter_from_start(t: float, given: Given) -> Values:
    square = given["target"] + 1
    x = square + (1 - square) * math.exp(-t)
    return {"y": x, "z": 2 * math.sqrt(square), "rate": square - x}


@case("StartNotFixed", given={"a": 4.0}, variants=({"a": -1.0},))
def start_not_fixed(t: float, given: Given) -> Values:
    x0 = given["a"] - 2
    x = x0 * math.exp(-t)
    return {"y": x, "z": 2 + x0 - x}


@case("InitialAlgorithm", given={"base": 1.0}, variants=({"base": -2.0},))
def initial_algorithm(t: float, given: Given) -> Values:
    return {"y": (given["base"] + 1 + 1 / 2 + 1 / 3 + 1 / 4) * math.exp(-t)}


@case("InitialDiscrete", given={"b0": 6.0}, variants=({"b0": -1.0},), events=(0.25, 0.5))
def initial_discrete(t: float, given: Given) -> Values:
    late = t > 0.5
    return {"y": [3 + late, given["b0"] * (10 if late else 1), 7.25 if t > 0.25 else 7, 5 + 2 * late]}


def diode(voltage: float) -> float:
    return max(voltage, 0.0)


@remembered
def rectifier() -> tuple[Callable[[float], Floats], tuple[float, ...]]:
    from scipy.integrate import solve_ivp

    def source(t: float) -> float:
        return 5 * math.sin(2 * math.pi * t)

    def blocked(t: float, u: Floats) -> list[float]:
        return [(-u[0] / 10) / 0.05]

    def conducting(t: float, u: Floats) -> list[float]:
        return [(source(t) - u[0] - u[0] / 10) / 0.05]

    def balance(t: float, u: Floats) -> float:
        return source(t) - u[0]

    balance.terminal = True  # type: ignore[attr-defined]  # scipy reads it from the function
    parts, switches, start, u = [], [], 0.0, 0.0
    right = conducting
    while start < 2.0:
        found = solve_ivp(
            right,
            (start, 2.0),
            [u],
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            dense_output=True,
            events=_after(balance, start),
        )
        parts.append(found.sol)
        switches.append(start)
        start, u = float(found.t[-1]), float(found.y[0, -1])
        right = blocked if right is conducting else conducting

    def value(t: float) -> Floats:
        k = max(i for i, at in enumerate(switches) if at <= t)
        u_now = parts[k](t)[0]
        return np.array([u_now, diode(source(t) - u_now) if k % 2 == 0 else 0.0])

    return value, tuple(switches[1:])


def _after(event: Callable[[float, Floats], float], start: float) -> Callable[[float, Floats], float]:
    def later(t: float, u: Floats) -> float:
        return event(t, u) if t > start + 1e-3 else event(start + 1e-3, u)

    later.terminal = True  # type: ignore[attr-defined]  # scipy reads it from the function
    return later


def diode_residuals(v: dict[str, float]) -> list[float]:
    return [
        v["source"] - v["i"] - v["v"] - v["u"],
        v["i"] if v["off"] else v["v"],
        min(v["i"], 0.0),
        max(v["v"], 0.0),
        0.05 * v["der(u)"] - v["i"] + v["u"] / 10,
    ]


@case("IdealDiode", stop=2.0, error=1e-6, residuals=diode_residuals)
def ideal_diode(t: float, given: Given) -> Values:
    u, i = rectifier()[0](t)
    return {"voltage": u, "current": i}


@case("RedundantStart", given={"w0": 2.0}, variants=({"w0": -1.0},))
def redundant_start(t: float, given: Given) -> Values:
    # 2 der(load) = -6 der(w) = -6 tau, so tau = der(w) = 1 - tau
    return {"y": given["w0"] + t / 2, "z": 0.5}


def inertia_residuals(v: dict[str, float]) -> list[float]:
    first, second = 2.0, -0.5
    return [
        v["phi[1]"] - first * v["phi[2]"],
        v["w[2]"] - second * v["w[3]"],
        v["a[1]"] - first * second * v["a[3]"],
        v["a[1]"] - v["tau[1]"],
        2 * v["a[2]"] + first * v["tau[1]"] - v["tau[2]"],
        3 * v["a[3]"] + second * v["tau[2]"] - v["tau[3]"],
        v["tau[3]"] - 50 * (v["end_angle"] - v["phi[3]"]),
        0.5 * v["der(end_speed)"] + v["tau[4]"],
    ]


@case(
    "ThreeInertias",
    residuals=inertia_residuals,
    given={"c": 50.0, "r[1]": 2.0, "J[3]": 3.0},
    variants=({"r[1]": -1.0}, {"J[3]": 0.5}, {"c": 5.0}),
)
def three_inertias(t: float, given: Given) -> Values:
    first, second = given["r[1]"], -0.5
    inertia = given["J[3]"] + second**2 * (2 + first**2)
    c = given["c"]
    # states: angle and speed of the third, angle and speed of the end
    a = np.array([[0, 1, 0, 0], [-c / inertia, 0, c / inertia, 0], [0, 0, 0, 1], [2 * c, 0, -2 * c, 0]])
    x = expm(a * t) @ [0.0, 1 / (first * second), 0.1, 0.0]
    return {"y": first * second * x[1], "z": x[2]}


@case("AbsentCapacitance", given={"C": 0.0, "R": 2.0}, variants=({"R": 1.0}, {"C": 0.25}))
def absent_capacitance(t: float, given: Given) -> Values:
    """A divider of a ramp, which the capacitance delays by tau from 0 on."""
    k = 3 / (3 + given["R"])
    tau = given["C"] * k * given["R"]
    if tau == 0:
        return {"v": k * (1 + t)}
    return {"v": k * (1 + t - tau) - k * (1 - tau) * math.exp(-t / tau)}


UP = math.acos(-0.25)


@case("RootsWithoutStates", events=(UP / 8, (UP + math.pi) / 8), error=EXACT, exchanged=False)
def roots_without_states(t: float, given: Given) -> Values:
    """Up where u = -cos(8 t) reaches 0.25, down where it falls to -0.25."""
    return {"y": 1 if (8 * t - UP) % (2 * math.pi) < math.pi else -1}
