"""Mechanics of the P2 hybrid written from their physics: engine, separating clutch, machine, gearbox, shafts, car.

State: speeds of the engine and of the gearbox's output (rad/s), twist of the half shafts (rad), pressure of the
clutch, drive power the gearbox reckons with (W), speed of the car (m/s), energies in, out and lost (J).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from combustion_gears import SEVEN_SPEED, GearMotion, Gears, GearTrain
from hybrid_system import Event, Vector

ENGINE, OUTPUT, TWIST, PRESSURE, POWER, CAR, ENERGY_IN, ENERGY_OUT, ENERGY_LOSS = range(9)


@dataclass
class HybridCar:
    """*engine*, *machine* (N.m) and *clutch* (0 to 1) are functions of time. Mutable: the modes between events."""

    engine: Callable[[float], float]
    machine: Callable[[float], float]
    clutch: Callable[[float], float]
    gears: Gears = field(default_factory=lambda: replace(SEVEN_SPEED, inertia_in=0.05 + 0.02))
    mass: float = 1600.0
    radius: float = 0.31
    drag_area: float = 0.65
    rolling: float = 0.01
    engine_inertia: float = 0.15
    stiffness: float = 3e3
    damping: float = 100.0
    train: GearTrain = field(init=False)
    is_locked: bool = field(init=False, default=False)
    sliding: int = field(init=False, default=1)

    def __post_init__(self) -> None:
        self.train = GearTrain(self.gears, 0.0)

    def start(self) -> list[float]:
        """State at time 0, at rest."""
        return [0.0] * 9

    def motion(self, time: float, y: Vector) -> tuple[GearMotion, float, float, float]:
        """Of the gearbox; the clutch's torque (N.m), the engine's speed (rad/s) and acceleration (rad/s2)."""
        output = y[OUTPUT]
        shaft = self.stiffness * y[TWIST] + self.damping * (output / self.gears.final - y[CAR] / self.radius)
        if self.is_locked:
            push = self.engine(time) + self.machine(time)
            gear = self.train.motion(time, output, push, self.engine_inertia, shaft)
            rate = gear.turbine_rate
            held = self.engine(time) - self.engine_inertia * rate
            return gear, held, self.train.ratio(time)[0] * output, rate
        torque = 400 * y[PRESSURE] * self.sliding
        gear = self.train.motion(time, output, torque + self.machine(time), 0.0, shaft)
        return gear, torque, y[ENGINE], (self.engine(time) - torque) / self.engine_inertia

    def derivative(self, time: float, y: Vector) -> list[float]:
        """Of the state."""
        gear, torque, engine, engine_rate = self.motion(time, y)
        v, turbine = y[CAR], self.train.ratio(time)[0] * y[OUTPUT]
        twist_rate = y[OUTPUT] / self.gears.final - v / self.radius
        shaft = self.stiffness * y[TWIST] + self.damping * twist_rate
        power = self.engine(time) * engine + self.machine(time) * turbine
        resistance = 0.5 * 1.2 * self.drag_area * v * abs(v) + self.rolling * self.mass * 9.81 * math.tanh(v / 0.1)
        return [
            engine_rate,
            gear.output_rate,
            twist_rate,
            (min(1.0, max(0.0, self.clutch(time))) - y[PRESSURE]) / 0.05,
            (power - y[POWER]) / 0.3,
            (shaft / self.radius - resistance) / self.mass,
            power,
            shaft * v / self.radius,
            gear.loss + torque * (engine - turbine) + self.damping * twist_rate**2,
        ]

    def events(self) -> list[Event]:
        """Of the present mode."""

        def wheel(y: Vector) -> float:
            return float(y[CAR] / self.radius)

        def load(t: float, y: Vector) -> float:
            return float(min(1.0, max(0.0, y[POWER] / 130e3)))

        shifts = self.train.events(wheel, load, lambda t, y: self.motion(t, y)[0].into)
        return [*self._clutch_events(), *shifts]

    def _clutch_events(self) -> list[Event]:
        if self.is_locked:
            return [
                Event(lambda t, y: self.motion(t, y)[1] - 400 * y[PRESSURE], lambda t, y: self._let_go(t, y, 1)),
                Event(lambda t, y: -self.motion(t, y)[1] - 400 * y[PRESSURE], lambda t, y: self._let_go(t, y, -1)),
            ]

        def caught(t: float, y: Vector) -> float:
            return float(self.sliding * (self.train.ratio(t)[0] * y[OUTPUT] - y[ENGINE]))

        def catch(t: float, y: Vector) -> None:
            self.is_locked = True

        return [Event(caught, catch)]

    def _let_go(self, time: float, y: Vector, sliding: int) -> None:
        self.is_locked, self.sliding = False, sliding
        y[ENGINE] = self.train.ratio(time)[0] * y[OUTPUT]
