"""A battery-electric car, dynamic and quasi-static, as one system of ordinary differential equations with modes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from electric import Axle, Battery, Car, SynchronousMachine
from hybrid_system import Event, Vector
from modes import crossing, guarded

STEPS = ((0.5, 0.0), (3.0, 1200.0), (14.0, 4000.0), (18.0, 300.0), (26.0, -2500.0), (math.inf, 100.0))
"""Torque at the wheels until each time: away, full load, cruise, recuperation, cruise."""


def demand(time: float) -> float:
    """N.m at the wheels. A step belongs to its later side."""
    return next(torque for until, torque in STEPS if time < until)


@dataclass(frozen=True)
class Request:
    """How the driver's demand becomes the machine's: limits of battery and recuperation, faded towards standstill."""

    ratio: float = 11.53
    max_torque: float = 310.0
    max_recuperation: float = 150.0
    fading_speed: float = 30.0
    usable_power: float = 0.9
    max_discharge_power: float = 160e3
    max_charge_power: float = 100e3
    least_soc: float = 0.05
    greatest_soc: float = 0.98
    fading_soc: float = 0.05

    def limits(self, speed: float, soc: float, driving: bool, charging: bool) -> tuple[float, float]:
        """Lowest and highest torque, N.m; the flags say whether power limits them."""
        size = math.hypot(speed, 1.0)
        highest = self.discharge(soc) / size if driving else self.max_torque
        lowest = self.charge(soc) / size if charging else self.max_recuperation
        return -lowest * speed**2 / (speed**2 + self.fading_speed**2), highest

    def excess(self, speed: float, soc: float) -> tuple[float, float]:
        """Power that full torque takes beyond what the battery allows, W: driving, recuperating."""
        size = math.hypot(speed, 1.0)
        return self.max_torque * size - self.discharge(soc), self.max_recuperation * size - self.charge(soc)

    def discharge(self, soc: float) -> float:
        """Power of the shaft that the battery can feed, W."""
        return self.usable_power * self.max_discharge_power * min(max((soc - self.least_soc) / self.fading_soc, 0), 1)

    def charge(self, soc: float) -> float:
        """Power that the battery takes, W."""
        return self.max_charge_power * min(max((self.greatest_soc - soc) / self.fading_soc, 0), 1)


def cut(value: float, low: float, high: float, above: bool, below: bool) -> float:
    """*value* between its limits, where the flags say which one holds."""
    return high if above else low if below else value


def modes(*names: str) -> dict[str, bool]:
    """Modes of a drive, all off: what limits the request and the machine, and whether the field is weakened."""
    return dict.fromkeys(("driving", "charging", "fast", "above", "below", "over", "under", *names), False)


@dataclass
class Stepped:
    """A drive that follows `STEPS`. Mutable: the modes between events."""

    modes: dict[str, bool] = field(default_factory=modes)
    demand_step: int = 0

    def guards(self, time: float, y: Vector) -> dict[str, float]:
        """Positive: the mode is on."""
        raise NotImplementedError

    def events(self) -> list[Event]:
        """Of the present mode."""
        found = guarded(self.modes, self.guards)
        if math.isfinite(STEPS[self.demand_step][0]):
            found.append(crossing(lambda t, y: 1e3 * (t - STEPS[self.demand_step][0]), self._step))
        return found

    def _step(self, time: float) -> None:
        self.demand_step += 1


@dataclass
class DynamicDrive(Stepped):
    """Speed of the car, of the machine, twist, torque, seen voltage, charge, two pair voltages; in, out, loss."""

    machine: SynchronousMachine = field(default_factory=SynchronousMachine)
    battery: Battery = field(default_factory=Battery)
    axle: Axle = field(default_factory=Axle)
    request: Request = field(default_factory=Request)
    car: Car = field(default_factory=Car)
    rotor_inertia: float = 0.05
    voltage_lag: float = 0.05
    auxiliary_power: float = 350.0
    initial_soc: float = 0.8
    initial_voltage: float = 400.0
    modes: dict[str, bool] = field(default_factory=lambda: modes("weakened"))

    def start(self) -> list[float]:
        """At rest."""
        return [0.0, 0.0, 0.0, 0.0, self.initial_voltage, self.initial_soc * self.battery.capacity] + [0.0] * 5

    def _asked(self, y: Vector) -> tuple[float, float, float, float]:
        soc = y[5] / self.battery.capacity
        lowest, highest = self.request.limits(y[1], soc, self.modes["driving"], self.modes["charging"])
        wanted = STEPS[self.demand_step][1] / self.request.ratio
        return wanted, lowest, highest, cut(wanted, lowest, highest, self.modes["above"], self.modes["below"])

    def guards(self, time: float, y: Vector) -> dict[str, float]:
        """Positive: the mode is on."""
        driving, charging = self.request.excess(y[1], y[5] / self.battery.capacity)
        wanted, lowest, highest, asked = self._asked(y)
        limit = self.machine.torque_limit(y[1], y[4], self.modes["fast"])
        return {
            "driving": driving,
            "charging": charging,
            "fast": self.machine.max_torque * abs(y[1]) - self.machine.power_limit(y[4]),
            "above": wanted - highest,
            "below": lowest - wanted,
            "over": asked - limit,
            "under": -limit - asked,
            "weakened": self.machine.weakening(y[3], y[1], y[4]),
        }

    def derivative(self, time: float, y: Vector) -> list[float]:
        """Of the state."""
        v, spin, twist, torque, seen, charge, first, second = y[:8]
        limit = self.machine.torque_limit(spin, seen, self.modes["fast"])
        target = cut(self._asked(y)[3], -limit, limit, self.modes["over"], self.modes["under"])
        machine_loss = self.machine.losses(torque, spin, seen, self.modes["weakened"])
        link_power = torque * spin + machine_loss + self.auxiliary_power
        open_circuit = self.battery.open_circuit(charge)
        current = self.battery.current(link_power, open_circuit - first - second)
        pairs, heat, drop = self.battery.flows(current, (first, second))
        wheel = v / self.car.wheel_radius
        slip = spin / self.axle.ratio - wheel
        shaft = self.axle.stiffness * twist + self.axle.damping * slip
        lost = self.axle.gear_loss(shaft / self.axle.ratio, spin)
        return [
            (shaft / self.car.wheel_radius - self.car.resistance(v)) / self.car.mass,
            (torque - shaft / self.axle.ratio - lost) / self.rotor_inertia,
            slip,
            (target - torque) / self.machine.torque_lag,
            (open_circuit - drop - seen) / self.voltage_lag,
            -current,
            *pairs,
            open_circuit * current,
            shaft * wheel,
            heat + machine_loss + lost * spin + self.axle.damping * slip**2 + self.auxiliary_power,
        ]


@dataclass
class QuasiStaticDrive(Stepped):
    """Speed of the car and charge; in, out, loss. *loss* of speed and share of the torque limit is the map, W."""

    loss: Callable[[float, float], float] = lambda speed, share: math.nan
    machine: SynchronousMachine = field(default_factory=SynchronousMachine)
    battery: Battery = field(default_factory=lambda: Battery(series=523.2, pairs=()))
    axle: Axle = field(default_factory=Axle)
    request: Request = field(default_factory=Request)
    car: Car = field(default_factory=Car)
    auxiliary_power: float = 350.0
    initial_soc: float = 0.8

    def start(self) -> list[float]:
        """At rest."""
        return [0.0, self.initial_soc * self.battery.capacity, 0.0, 0.0, 0.0]

    def _torque(self, y: Vector) -> tuple[float, float, float, float, float]:
        """Wanted, lowest, highest, asked torque and the machine's limit, N.m."""
        spin, soc = self.axle.ratio * y[0] / self.car.wheel_radius, y[1] / self.battery.capacity
        lowest, highest = self.request.limits(spin, soc, self.modes["driving"], self.modes["charging"])
        wanted = STEPS[self.demand_step][1] / self.request.ratio
        limit = self.machine.max_power / abs(spin) if self.modes["fast"] else self.machine.max_torque
        asked = cut(wanted, lowest, highest, self.modes["above"], self.modes["below"])
        return wanted, lowest, highest, asked, limit

    def guards(self, time: float, y: Vector) -> dict[str, float]:
        """Positive: the mode is on."""
        spin = self.axle.ratio * y[0] / self.car.wheel_radius
        driving, charging = self.request.excess(spin, y[1] / self.battery.capacity)
        wanted, lowest, highest, asked, limit = self._torque(y)
        return {
            "driving": driving,
            "charging": charging,
            "fast": self.machine.max_torque * abs(spin) - self.machine.max_power,
            "above": wanted - highest,
            "below": lowest - wanted,
            "over": asked - limit,
            "under": -limit - asked,
        }

    def derivative(self, time: float, y: Vector) -> list[float]:
        """Of the state."""
        wheel = y[0] / self.car.wheel_radius
        spin = self.axle.ratio * wheel
        _, _, _, asked, limit = self._torque(y)
        torque = cut(asked, -limit, limit, self.modes["over"], self.modes["under"])
        machine_loss = self.loss(spin, torque / limit)
        lost = self.axle.gear_loss(torque, spin)
        shaft = self.axle.ratio * (torque - lost)
        open_circuit = self.battery.open_circuit(y[1])
        current = self.battery.current(torque * spin + machine_loss + self.auxiliary_power, open_circuit)
        _, heat, _ = self.battery.flows(current, ())
        return [
            (shaft / self.car.wheel_radius - self.car.resistance(y[0])) / self.car.mass,
            -current,
            open_circuit * current,
            shaft * wheel,
            heat + machine_loss + lost * spin + self.auxiliary_power,
        ]
