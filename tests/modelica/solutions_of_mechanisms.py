"""Mechanisms whose states change during the run, against generalized coordinates that are good all the way.

Errors are bounded at a tolerance of 1e-9: an angle of some ten radians with a relative error of the tolerance in each
of some hundred steps gives 1e-6.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from language_case import Cases, Given, Steps, Values
from reference import Floats, remembered, trajectory

CASES = Cases()
case = CASES.case


@remembered
def turning(length: float, gravity: float, speed: float, stop: float) -> Callable[[float], Floats]:
    return trajectory(lambda _, x: [x[1], -gravity / length * math.sin(x[0])], [0.0, speed / length], stop)


def energy_is_kept(v: dict[str, float]) -> list[float]:
    return [
        v["x"] ** 2 + v["y"] ** 2 - 1,
        v["x"] * v["vx"] + v["y"] * v["vy"],
        (v["energy"] - 81 / 2 + 9.81) / 1000,
    ]


@case(
    "PendulumGoesRound",
    stop=10.0,
    step=0.11,
    given={"L": 1.0, "v0": 9.0},
    variants=({"L": 3.0, "v0": 12.0}, {"v0": -7.0}, {"v0": 4.0}),
    error=2e-5,
    residuals=energy_is_kept,
)
def pendulum_goes_round(t: float, given: Given) -> Values:
    length = given["L"]
    phi, rate = turning(length, 9.81, given["v0"], 11.0)(t)
    return {
        "across": length * math.sin(phi),
        "height": -length * math.cos(phi),
        "tension": length * rate**2 + 9.81 * math.cos(phi),
        "energy": given["v0"] ** 2 / 2 - 9.81 * length,
    }


@remembered
def double(a: float, b: float, m: float) -> Callable[[float], Floats]:
    g, whole = 9.81, 1 + m

    def right(_: float, x: Floats) -> list[float]:
        p, q, dp, dq = x
        s, c = math.sin(p - q), math.cos(p - q)
        mass = np.array([[whole * a, m * b * c], [a * c, b]])
        force = [-m * b * s * dq**2 - whole * g * math.sin(p), a * s * dp**2 - g * math.sin(q)]
        return [dp, dq, *np.linalg.solve(mass, force)]

    return trajectory(right, [0.0, 0.0, 8.0 / a, (3.0 - 8.0) / b], 3.0)


@case("DoublePendulumGoesRound", stop=2.0, given={"a": 1.0, "b": 0.7, "m": 0.5}, variants=({"m": 2.0},), error=1e-5)
def double_pendulum_goes_round(t: float, given: Given) -> Values:
    a, b = given["a"], given["b"]
    p, q, *_ = double(a, b, given["m"])(t)
    x, y = a * math.sin(p), -a * math.cos(p)
    return {"p": [x, y, x + b * math.sin(q), y - b * math.cos(q)]}


def linkage(angle: float, given: Given) -> tuple[Floats, Floats]:
    """The joints of crank and rocker, and their velocities for a crank that turns with 1 rad/s."""
    a, b, c, d = (given[name] for name in "abcd")
    crank, fixed = a * np.array([math.cos(angle), math.sin(angle)]), np.array([d, 0.0])
    way = fixed - crank
    distance = math.hypot(*way)
    along = (b**2 - c**2 + distance**2) / (2 * distance)
    aside = np.array([-way[1], way[0]]) / distance
    rocker = crank + along / distance * way + math.sqrt(b**2 - along**2) * aside
    speed = np.array([-crank[1], crank[0]])
    rods = np.array([rocker - crank, rocker - fixed])
    return np.array([*crank, *rocker]), np.array([*speed, *np.linalg.solve(rods, [rods[0] @ speed, 0.0])])


@remembered
def crank_angle(**numbers: float) -> Callable[[float], Floats]:
    mass = np.array([1.0, 1.0, numbers["m"], numbers["m"]])

    def energies(angle: float) -> tuple[float, float]:
        """Kinetic at 1 rad/s, and potential."""
        places, speeds = linkage(angle, numbers)
        return mass @ speeds**2 / 2, 9.81 * (mass * places)[1::2].sum()

    inertia, height = energies(0.0)
    whole = inertia * numbers["w0"] ** 2 + height

    def right(_: float, x: Floats) -> list[float]:
        kinetic, potential = energies(x[0])
        return [math.sqrt((whole - potential) / kinetic)]

    return trajectory(right, [0.0], 6.0)


@case(
    "FourBarLinkage",
    stop=3.0,
    step=0.06,
    given={"a": 1.0, "b": 3.0, "c": 2.5, "d": 2.0, "m": 2.0, "w0": 10.0},
    variants=({"m": 0.5}, {"w0": 15.0}),
    error=2e-5,
)
def four_bar_linkage(t: float, given: Given) -> Values:
    return {"p": list(linkage(crank_angle(**given)(t)[0], given)[0])}


@case("TurningCurrents", stop=4.0, given={"U": 3.0, "w": 5.0}, variants=({"U": 0.0}, {"w": -2.0}), error=1e-7)
def turning_currents(t: float, given: Given) -> Values:
    """Along the direction the current s obeys ``0.2 s' = U cos(w t) - 0.5 s``."""
    w, u = given["w"], given["U"] / 0.2
    lag = 0.5 / 0.2
    part = complex(u, 0) / complex(lag, w)
    s = (part * np.exp(1j * w * t)).real + (1 - part.real) * math.exp(-lag * t)
    side = s * math.sin(w * t)
    return {"current": [s * math.cos(w * t), side * math.cos(3 * t), side * math.sin(3 * t)]}


GRAVITY = Steps((0.0, 2.1), (9.81, 3.0))


@remembered
def tuned() -> Callable[[float], Floats]:
    first = turning(1.0, 9.81, 8.0, 2.1)
    rest = trajectory(lambda _, x: [x[1], -3.0 * math.sin(x[0])], list(first(2.1)), 4.0)
    return lambda time: first(time) if time <= 2.1 else rest(time - 2.1)


@case("PendulumWithReinit", stop=5.0, tuned={"g": GRAVITY}, error=2e-5, exchanged=False)
def pendulum_with_reinit(t: float, given: Given) -> Values:
    phi, _ = tuned()(t)
    return {"across": math.sin(phi), "height": -math.cos(phi), "passed": phi % (2 * math.pi)}
