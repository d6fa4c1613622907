"""Combustion powertrains written from their physics, in a car of one mass whose wheels roll without slip.

State: speeds of the engine and of the gearbox's output (rad/s), twist of the half shafts (rad), combustion torque the
air allows (N.m), pressure of the lock-up clutch, speed of the car (m/s), energies in, out and lost (J).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from combustion_gears import Curve, Gears, GearTrain, direction
from hybrid_system import Event, Vector

ENGINE, OUTPUT, TWIST, AIR, PRESSURE, CAR, ENERGY_IN, ENERGY_OUT, ENERGY_LOSS = range(9)

_SPEEDS = (0, 42, 105, 157, 366.5, 523.6, 628.3, 670, 712)
_FULL_LOAD = Curve(_SPEEDS, (-12, 0, 135, 250, 250, 210.1, 175.1, 140, -50))
_SLOPE = Curve(_SPEEDS, (0.333, 0.343, 0.377, 0.392, 0.397, 0.377, 0.353, 0.343, 0.333))
_VOLUME = 1.498e-3 / (4 * math.pi)  # torque per mean effective pressure, m3
_RATIOS = (0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98, 1)
_CAPACITY = Curve(
    _RATIOS, (3.4325e-3, 3.6925e-3, 3.5842e-3, 3.1077e-3, 2.2626e-3, 1.5901e-3, 0.8551e-3, 0.3533e-3, 0.0)
)
_GAIN = Curve(_RATIOS, (1.6797, 1.5194, 1.4008, 1.286, 1.1215, 1, 1, 1, 1))


def smaller(a: float, b: float, width: float = 2.0) -> float:
    """The smaller of two, rounded by a hyperbola."""
    return 0.5 * (a + b - math.hypot(a - b, width))


@dataclass(frozen=True)
class Petrol:
    """Volkswagen 1.5 TSI: slope * fuel power / speed is the charge's torque; friction and throttling reduce it."""

    idle: float = 90.0
    power: float = 110e3
    air_lag: float = 0.12
    auxiliary_power: float = 500.0  # of the alternator

    def drag(self, speed: float) -> float:
        """Friction, closed throttle and alternator, N.m."""
        pressure = 0.488e5 + 103 * abs(speed) + 0.164 * speed**2
        auxiliaries = self.auxiliary_power * speed / (speed**2 + 400)
        return _VOLUME * pressure * direction(speed, 5.0) + self.throttling(speed) + auxiliaries

    def throttling(self, speed: float) -> float:
        """Of a closed throttle, N.m."""
        return _VOLUME * 0.965e5 * direction(speed, 5.0)

    def fuel(self, speed: float, combustion: float) -> float:
        """Fuel power for what the fuel adds to the torque, W. Throttling falls in proportion to the charge."""
        natural, closed = _VOLUME * 13e5, self.throttling(speed)
        throttled = combustion / (1 + closed / natural)
        charge = throttled if throttled < natural else combustion - closed
        late = 0.3 * (charge - natural) ** 2 / natural if charge > natural else 0.0
        return (charge + late) * max(0.0, speed) / self.slope(speed)

    def slope(self, speed: float) -> float:
        """Of the Willans line."""
        return _SLOPE(speed)

    def highest(self, speed: float) -> float:
        """Combustion torque at full load, N.m."""
        return max(0.0, _FULL_LOAD(speed) + self.drag(speed))

    def wanted(self, speed: float, demand: float) -> float:
        """Combustion torque for a demand beyond the drag, N.m; small demands lead over to overrun."""
        return max(0.0, demand) + self.drag(speed) * direction(max(0.0, demand), 10.0)

    def target(self, speed: float, demand: float) -> float:
        """Combustion torque the air is led to, N.m: demand, but at least idle and at most full load."""
        governed = self.drag(speed) + 1.5 * (self.idle - speed)
        idle = 0.5 * (governed + math.hypot(governed, 2.0))
        return smaller(self.highest(speed), max(self.wanted(speed, demand), idle))


def converter(pump: float, turbine: float) -> tuple[float, float, float]:
    """Torque the pump takes, torque the turbine gives (N.m) and their ratio when driving."""
    gain = _GAIN(turbine / max(pump, 1.0))
    if turbine > pump:
        back = _CAPACITY(pump / max(turbine, 1.0)) * turbine**2
        return -back, -back, gain
    forward = _CAPACITY(turbine / max(pump, 1.0)) * pump**2
    return forward, gain * forward, gain


@dataclass(frozen=True)
class Motion:
    """Of the whole powertrain at one instant: speeds, torques, accelerations, powers; SI."""

    engine: float
    engine_rate: float
    output_rate: float
    twist_rate: float
    shaft: float
    target: float
    clutch: float
    into: float
    fuel: float
    loss: float


@dataclass
class CombustionCar:
    """A car with one of the two gearboxes. *demand* and *brake* (t): torques at the wheels. Mutable: the modes."""

    demand: Callable[[float], float]
    gears: Gears
    has_converter: bool
    initial_speed: float = 0.0
    brake: Callable[[float], float] = lambda time: 0.0
    petrol: Petrol = field(default_factory=Petrol)
    mass: float = 1600.0
    radius: float = 0.31
    drag_area: float = 0.65
    rolling: float = 0.01
    engine_inertia: float = 0.15
    stiffness: float = 3e3
    damping: float = 100.0
    train: GearTrain = field(init=False)
    is_cut: bool = field(init=False, default=False)
    is_closing: bool = field(init=False, default=False)
    is_locked: bool = field(init=False, default=False)
    sliding: int = field(init=False, default=1)

    def __post_init__(self) -> None:
        wheel = self.initial_speed / self.radius
        self.train = GearTrain(self.gears, wheel * self.gears.final)
        turbine = self.train.input_speed(wheel)
        if self.has_converter:
            self.is_closing = self.is_locked = self.train.gear >= 1 and turbine > 130
        else:
            self.is_locked = turbine >= self.petrol.idle

    def start(self) -> list[float]:
        """State at time 0."""
        wheel = self.initial_speed / self.radius
        turbine = self.train.input_speed(wheel)
        engine = turbine if self.is_locked else max(turbine, self.petrol.idle)
        closed = float(self.is_closing)
        return [engine, wheel * self.gears.final, 0.0, 0.0, closed, self.initial_speed, 0.0, 0.0, 0.0]

    def capacity(self, y: Vector) -> float:
        """Of the clutch beside the converter, or of the one that drives off, N.m."""
        if self.has_converter:
            return float(400 * y[PRESSURE])
        beyond = max(0.0, y[ENGINE] - 69) / (170 - 69)
        return max(0.0, smaller(400, 250 * beyond**2, 1.0))

    def motion(self, time: float, y: Vector) -> Motion:
        """In the present mode. While the clutch holds, the engine's speed follows the gearbox."""
        petrol, output = self.petrol, y[OUTPUT]
        ratio = self.train.ratio(time)[0]
        turbine = ratio * output
        engine = turbine if self.is_locked else y[ENGINE]
        pump, fluid, gain = converter(engine, turbine) if self.has_converter else (0.0, 0.0, 1.0)
        wanted = self.demand(time) / (self.gears.final * self.gears.efficiency * ratio * gain)
        burning = 0.0 if self.is_cut else max(0.0, y[AIR])
        brake = burning - petrol.drag(engine)
        twist_rate = output / self.gears.final - y[CAR] / self.radius
        shaft = self.stiffness * y[TWIST] + self.damping * twist_rate
        if self.is_locked:
            gear = self.train.motion(time, output, brake - pump + fluid, self.engine_inertia, shaft)
            clutch = brake - pump - self.engine_inertia * gear.turbine_rate
            engine_rate = gear.turbine_rate
        else:
            clutch = self.capacity(y) * self.sliding
            gear = self.train.motion(time, output, fluid + clutch, 0.0, shaft)
            engine_rate = (brake - pump - clutch) / self.engine_inertia
        fuel = petrol.fuel(engine, burning)
        loss = fuel - brake * engine + gear.loss
        loss += pump * engine - fluid * turbine + clutch * (engine - turbine) + self.damping * twist_rate**2
        target = petrol.target(engine, wanted)
        return Motion(
            engine, engine_rate, gear.output_rate, twist_rate, shaft, target, clutch, gear.into, fuel, loss
        )  # fmt: skip

    def derivative(self, time: float, y: Vector) -> list[float]:
        """Of the state."""
        m, v = self.motion(time, y), y[CAR]
        air = 0.5 * 1.2 * self.drag_area * v * abs(v)
        resistance = air + (self.rolling * self.mass * 9.81 + self.brake(time) / self.radius) * math.tanh(v / 0.1)
        return [
            m.engine_rate,
            m.output_rate,
            m.twist_rate,
            (m.target - y[AIR]) / self.petrol.air_lag,
            (float(self.is_closing) - y[PRESSURE]) / 0.15,
            (m.shaft / self.radius - resistance) / self.mass,
            m.fuel,
            m.shaft * v / self.radius,
            m.loss,
        ]

    def stored(self, time: float, y: Vector) -> float:
        """Kinetic and elastic energy inside the powertrain, J."""
        spinning = 0.5 * self.engine_inertia * self.motion(time, y).engine ** 2
        return float(spinning + self.train.energy(time, y[OUTPUT]) + 0.5 * self.stiffness * y[TWIST] ** 2)

    def imbalance(self, time: float, y: Vector, stored_before: float) -> float:
        """Energy in less out, lost and stored since the start, J."""
        return float(y[ENERGY_IN] - y[ENERGY_OUT] - y[ENERGY_LOSS] - (self.stored(time, y) - stored_before))

    def stored_at_start(self) -> float:
        """Energy stored at time 0, J."""
        return self.stored(0.0, np.array(self.start()))

    def events(self) -> list[Event]:
        """Of the present mode."""

        def wheel(y: Vector) -> float:
            return float(y[CAR] / self.radius)

        def load(t: float, y: Vector) -> float:
            return min(1.0, max(0.0, self.demand(t) * wheel(y) / self.petrol.power))

        shifts = self.train.events(wheel, load, lambda t, y: self.motion(t, y).into)
        return [*self._clutch_events(), *self._fuel_events(), *shifts, *self._lock_up_events(wheel)]

    def _clutch_events(self) -> list[Event]:
        if self.is_locked:
            return [
                Event(lambda t, y: self.motion(t, y).clutch - self.capacity(y), lambda t, y: self._let_go(t, y, 1)),
                Event(lambda t, y: -self.motion(t, y).clutch - self.capacity(y), lambda t, y: self._let_go(t, y, -1)),
            ]

        # Only a slip that comes back to zero is caught: just after letting go it is zero and grows.
        def caught(t: float, y: Vector) -> float:
            return float(self.sliding * (self.train.ratio(t)[0] * y[OUTPUT] - y[ENGINE]))

        def catch(t: float, y: Vector) -> None:
            self.is_locked = True

        return [Event(caught, catch)]

    def _let_go(self, time: float, y: Vector, sliding: int) -> None:
        self.is_locked, self.sliding = False, sliding
        y[ENGINE] = self.train.ratio(time)[0] * y[OUTPUT]

    def _fuel_events(self) -> list[Event]:
        def switch(t: float, y: Vector) -> None:
            self.is_cut = not self.is_cut

        if self.is_cut:
            return [
                Event(lambda t, y: 115 - self.motion(t, y).engine, switch),
                Event(lambda t, y: self.motion(t, y).target - 2, switch),
            ]
        return [Event(lambda t, y: min(self._above(t, y, 140), 1 - y[AIR], 1 - self.motion(t, y).target), switch)]

    def _above(self, time: float, y: Vector, speed: float) -> float:
        return self.motion(time, y).engine - speed

    def _lock_up_events(self, wheel: Callable[[Vector], float]) -> list[Event]:
        if not self.has_converter:
            return []

        def switch(t: float, y: Vector) -> None:
            self.is_closing = not self.is_closing

        train = self.train
        if self.is_closing:
            return [Event(lambda t, y: max(105 - train.input_speed(wheel(y)), 0.5 - train.gear), switch)]
        return [Event(lambda t, y: min(train.input_speed(wheel(y)) - 130, train.gear - 0.5), switch)]
