"""What each reference model does, from closed forms or by another way of computing it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import prod, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

INTERFACES: tuple[tuple[int, str | None], ...] = (
    (1, "CoSimulation"),
    (2, "CoSimulation"),
    (2, "ModelExchange"),
    (2, None),
    (3, "CoSimulation"),
    (3, "ModelExchange"),
    (3, None),
)
"""Version and interface of the FMUs there are; None has both."""

Values = NDArray[np.float64]


def names_of(value: object) -> str:
    """A short word for a parameter of a test."""
    short = {"CoSimulation": "CS", "ModelExchange": "ME", None: "both"}
    return short.get(value, str(value)) if isinstance(value, str | None) else f"fmi{value}"


@dataclass(frozen=True, slots=True)
class Case:
    """A run of one FMU and what has to come out of it.

    *expected* gives, for each label, the values at the given times. *co_simulation* and *model_exchange* are the
    tolerances, absolute; *why* justifies them.
    """

    expected: Callable[[Values], Mapping[str, Values]]
    stop: float
    step: float
    co_simulation: float
    model_exchange: float
    why: str
    start: Mapping[str, float] = field(default_factory=dict)


def dahlquist(k: float) -> Callable[[Values], Mapping[str, Values]]:
    return lambda t: {"x": np.exp(-k * t)}


def bounce_times(g: float = 9.81, height: float = 1.0, e: float = 0.7, slowest: float = 0.1) -> list[float]:
    """When the ball hits the ground, up to the hit after which it rests: it rises for 2 v / g between two of them."""
    time, speed = sqrt(2 * height / g), sqrt(2 * g * height)
    times = [time]
    while (speed := e * speed) >= slowest:
        time += 2 * speed / g
        times.append(time)
    return times


def bouncing_ball(g: float = 9.81, height: float = 1.0, e: float = 0.7) -> Callable[[Values], Mapping[str, Values]]:
    def expected(t: Values) -> Mapping[str, Values]:
        times = bounce_times(g, height, e)
        bounces = np.searchsorted(times, t)
        first = bounces == 0
        since = t - np.where(first, 0.0, np.array([0.0, *times])[bounces])
        speed = np.where(first, 0.0, sqrt(2 * g * height) * e ** bounces.astype(float))
        rests = bounces == len(times)
        return {
            "h": np.where(rests, 0.0, np.where(first, height, 0.0) + speed * since - g * since**2 / 2),
            "v": np.where(rests, 0.0, speed - g * since),
            "bounces": bounces.astype(float),
            "resting": rests.astype(float),
        }

    return expected


def van_der_pol(mu: float) -> Callable[[Values], Mapping[str, Values]]:
    def expected(t: Values) -> Mapping[str, Values]:
        found = solve_ivp(
            lambda _, x: [x[1], mu * (1 - x[0] ** 2) * x[1] - x[0]],
            (0.0, float(t[-1])),
            [2.0, 0.0],
            method="DOP853",
            t_eval=t,
            rtol=1e-13,
            atol=1e-13,
        )
        return {"x0": found.y[0], "x1": found.y[1]}

    return expected


def stair(t: Values) -> Mapping[str, Values]:
    # A communication point k * step may lie a rounding error before the second it stands for.
    return {"counter": 1 + np.floor(t + 1e-9)}


def resource(t: Values) -> Mapping[str, Values]:
    return {"y": np.full(t.size, 97.0)}


@dataclass(frozen=True, slots=True)
class Matrices:
    """The matrices of a state space model and its (constant) input."""

    a: Values
    b: Values
    c: Values
    d: Values
    x0: Values
    u: Values

    def start(self) -> Mapping[str, float]:
        """Starts by label, as FMUs of all versions know them."""
        named = {"A": self.a, "B": self.b, "C": self.c, "D": self.d, "x0": self.x0, "u": self.u}
        return {
            f"{name}[{','.join(str(i + 1) for i in index)}]": float(x)
            for name, values in named.items()
            for index, x in np.ndenumerate(values)
        }

    def expected(self, t: Values) -> Mapping[str, Values]:
        """exp of [[A, B u], [0, 0]] moves (x, 1) on in time."""
        n = self.x0.size
        whole = np.zeros((n + 1, n + 1))
        whole[:n, :n], whole[:n, n] = self.a, self.b @ self.u
        x = np.array([(expm(whole * time) @ [*self.x0, 1.0])[:n] for time in t])
        y = x @ self.c.T + self.d @ self.u
        return {f"y[{i + 1}]": y[:, i] for i in range(y.shape[1])}


def matrices(n: int, m: int, r: int) -> Matrices:
    """A stable system of these sizes: a damped chain, no two entries of B, C and D alike."""

    def filled(*shape: int, first: float) -> Values:
        return (first + 0.1 * np.arange(prod(shape))).reshape(shape)

    a = -1.5 * np.eye(n) + np.diag(np.full(n - 1, 1.0), 1) - np.diag(np.full(n - 1, 0.5), -1)
    return Matrices(
        a,
        filled(n, m, first=0.5),
        filled(r, n, first=-0.3),
        filled(r, m, first=0.2),
        filled(n, first=1),
        filled(m, first=-1),
    )


SQUARE = matrices(3, 3, 3)

CASES: Mapping[str, Case] = {
    "Dahlquist": Case(
        dahlquist(2.0),
        5.0,
        0.1,
        1e-9,
        2e-6,
        "Runge-Kutta of order 4 with h = 0.01 errs by k^5 h^4 t exp(-k t) / 120 < 5e-10; a solver with tolerance 1e-6"
        " by no more than twice that, as old errors die away",
        {"k": 2.0},
    ),
    "BouncingBall": Case(
        bouncing_ball(),
        3.0,
        0.01,
        1e-9,
        1e-9,
        "flight is a parabola, which every method of order 2 or more meets exactly; the time of a hit is found to a few"
        " rounding errors, and speeds only become smaller",
    ),
    "VanDerPol": Case(
        van_der_pol(1.0),
        20.0,
        0.5,
        1e-8,
        1e-4,
        "h = 0.001 and fifth derivatives below 100: 1e-12 * 100 / 120 per unit of time, kept from growing by the limit"
        " cycle; a solver with tolerance 1e-6 makes some hundred steps, whose errors add up along the cycle (phase)",
    ),
    "Stair": Case(stair, 10.0, 0.2, 0.0, 0.0, "whole numbers are right or wrong"),
    "Resource": Case(resource, 1.0, 0.1, 0.0, 0.0, "whole numbers are right or wrong"),
    "StateSpace": Case(
        SQUARE.expected,
        1.0,
        0.1,
        1e-9,
        1e-5,
        "h = 0.01 and |A| < 3: 3^5 * 1e-8 / 120 * |x|, times a decay; a solver with tolerance 1e-6: three states of"
        " size 5, weighted with up to 0.5",
        SQUARE.start(),
    ),
}

ALL = [(name, version, interface) for name in CASES for version, interface in INTERFACES if interface]
