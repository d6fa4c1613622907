"""A stepped gearbox shifted under power, written from its physics, and curves through points."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from hybrid_system import Event, Vector
from scipy.interpolate import PchipInterpolator


class Curve:
    """Monotone cubic Hermite spline through points, constant outside them."""

    def __init__(self, xs: Sequence[float], ys: Sequence[float]) -> None:
        self._xs, self._ys = [float(x) for x in xs], [float(y) for y in ys]
        self._coefficients = PchipInterpolator(self._xs, self._ys).c.T.tolist()

    def __call__(self, x: float) -> float:
        if x <= self._xs[0]:
            return self._ys[0]
        if x >= self._xs[-1]:
            return self._ys[-1]
        k = bisect_right(self._xs, x) - 1
        a, b, c, d = self._coefficients[k]
        s = x - self._xs[k]
        return float(((a * s + b) * s + c) * s + d)


def direction(x: float, width: float) -> float:
    """Sign of *x*, a smooth step of this width about zero."""
    return x / math.hypot(x, width)


@dataclass(frozen=True)
class Gears:
    """Ratios, losses and shift speeds of a gearbox, SI; *up* and *down* at no and at full load."""

    ratios: tuple[float, ...]
    final: float
    efficiency: float
    drag: float
    inertia_in: float
    inertia_out: float
    shift_time: float
    dwell: float
    up: tuple[float, float]
    down: tuple[float, float]


SIX_SPEED = Gears(
    (4.148, 2.370, 1.556, 1.155, 0.859, 0.686), 3.5, 0.97, 2.0, 0.06, 0.03, 0.4, 0.6, (210.0, 600.0), (110.0, 320.0)
)
SEVEN_SPEED = Gears(
    (3.765, 2.273, 1.531, 1.122, 0.8551, 0.6915, 0.5781),
    4.438, 0.975, 1.0, 0.02, 0.02, 0.25, 0.5, (200.0, 600.0), (105.0, 320.0),
)  # fmt: skip


@dataclass(frozen=True)
class GearMotion:
    """Accelerations (rad/s2) of output and input, torque into the gears (N.m) and heat (W)."""

    output_rate: float
    turbine_rate: float
    into: float
    loss: float


@dataclass
class GearTrain:
    """A gearbox in a gear or between two. Gears count from 0. Mutable: the modes between events."""

    gears: Gears
    initial_output: float
    gear: int = field(init=False)
    previous: int = field(init=False)
    began: float = field(init=False, default=-1e6)
    driving: bool = field(init=False, default=True)

    def __post_init__(self) -> None:
        self.gear = sum(1 for ratio in self.gears.ratios[:-1] if self.initial_output * ratio > self.gears.up[0])
        self.previous = self.gear

    def ratio(self, time: float) -> tuple[float, float]:
        """Input against output speed, and its time derivative."""
        old, new = self.gears.ratios[self.previous], self.gears.ratios[self.gear]
        part = (time - self.began) / self.gears.shift_time
        if part >= 1:
            return new, 0.0
        rate = (new - old) * 6 * part * (1 - part) / self.gears.shift_time
        return old + (new - old) * part * part * (3 - 2 * part), rate

    def motion(self, time: float, output: float, push: float, inertia: float, shaft: float) -> GearMotion:
        """Motion at output speed *output* (rad/s) when *push* (N.m) turns the input.

        *inertia* (kg.m2) turns rigidly with it, beyond the gearbox's own; *shaft* (N.m) is the load at the wheels.
        """
        gears = self.gears
        ratio, rate = self.ratio(time)
        turbine = ratio * output
        drag = gears.drag * direction(turbine, 1.0)
        shifting = time < self.began + gears.shift_time
        pair = (gears.ratios[self.gear], gears.ratios[self.previous if shifting else self.gear])
        through = min(pair) if self.driving else max(pair)
        mesh = (1 - gears.efficiency) * (1 if self.driving else -1) * direction(output, 1.0)
        # With T into the gears: inertia_out a = through (1 - mesh) T - shaft/final
        # and total (ratio a + rate output) = push - drag - T.
        out, total = through * (1 - mesh), inertia + gears.inertia_in
        output_rate = (out * (push - drag - total * rate * output) - shaft / gears.final) / (
            gears.inertia_out + out * total * ratio
        )
        turbine_rate = ratio * output_rate + rate * output
        into = push - drag - total * turbine_rate
        loss = drag * turbine + into * (turbine - through * output) + through * mesh * into * output
        return GearMotion(output_rate, turbine_rate, into, loss)

    def energy(self, time: float, output: float) -> float:
        """Kinetic, J."""
        turbine = self.ratio(time)[0] * output
        return 0.5 * self.gears.inertia_in * turbine**2 + 0.5 * self.gears.inertia_out * output**2

    def input_speed(self, wheel: float) -> float:
        """In the present gear at this speed of the wheels, rad/s."""
        return wheel * self.gears.final * self.gears.ratios[self.gear]

    def events(
        self,
        wheel: Callable[[Vector], float],
        load: Callable[[float, Vector], float],
        into: Callable[[float, Vector], float],
    ) -> list[Event]:
        """Shifts and the reversal of the torque; *load* from 0 to 1."""
        gears = self.gears

        def beyond(pair: tuple[float, float], t: float, y: Vector) -> float:
            return self.input_speed(wheel(y)) - pair[0] - (pair[1] - pair[0]) * load(t, y)

        def ready(t: float) -> float:
            return t - self.began - gears.shift_time - gears.dwell

        def shift(by: int) -> Callable[[float, Vector], None]:
            def change(t: float, y: Vector) -> None:
                self.previous, self.gear, self.began = self.gear, self.gear + by, t

            return change

        def reverse(t: float, y: Vector) -> None:
            self.driving = not self.driving

        def arrive(t: float, y: Vector) -> None:
            self.previous = self.gear

        found = [Event(lambda t, y: (-into(t, y) if self.driving else into(t, y)) - 1e-3, reverse)]
        if self.gear < len(gears.ratios) - 1:
            found.append(Event(lambda t, y: min(ready(t), beyond(gears.up, t, y)), shift(1)))
        if self.gear > 0:
            found.append(Event(lambda t, y: min(ready(t), -beyond(gears.down, t, y)), shift(-1)))
        if self.previous != self.gear:
            found.append(Event(lambda t, y: t - self.began - gears.shift_time, arrive))
        return found
