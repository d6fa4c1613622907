"""The range extender as one system: machine, battery, generator set, axle, car and the rules of its control.

State: speed of the car, of the machine, twist, torque, seen voltage, charge, two pair voltages, speed of the generator
set, indicated torque of its engine, mean traction power; energies drawn from cells and fuel, given to the wheels, lost.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

from electric import Axle, Battery, Car, SynchronousMachine
from electric_drive import STEPS, Request, Stepped, cut, modes
from hybrid_system import Event, Vector
from modes import crossing

GOLF = SynchronousMachine(
    max_torque=330.0,
    max_power=85e3,
    pole_pairs=8,
    flux_linkage=0.05,
    inductance=9e-5,
    stator_resistance=0.010,
    hysteresis_loss=45.0,
    eddy_loss=0.012,
    viscous_friction=4e-4,
)
LINE = ((0.0, 160.0), (5000.0, 180.0), (10000.0, 250.0), (16000.0, 350.0), (23000.0, 450.0))
"""Electric power (W) and speed (rad/s) of the generator set."""
POINTS = (8000.0, 14000.0, 22000.0)
BAND = 1000.0


@dataclass
class GeneratorSet:
    """Engine whose speed the generator leads."""

    inertia: float = 0.08
    speed_lag: float = 0.4
    torque_lag: float = 0.15
    firing_speed: float = 80.0
    max_torque: float = 55.0
    efficiency: float = 0.38
    assumed_efficiency: float = 0.94

    def friction(self, speed: float) -> float:
        """N.m."""
        return (5.0 + 1e-5 * speed**2) * speed / math.hypot(speed, 5.0)

    def wanted_torque(self, power: float, speed: float) -> float:
        """N.m on the shaft that give *power* (W, electric)."""
        return power / self.assumed_efficiency / max(speed, self.firing_speed)

    def flows(self, speed: float, indicated: float, target: float) -> tuple[float, float, float, float]:
        """Acceleration (rad/s2), electric power, fuel power and losses (W)."""
        rate = (target - speed) / self.speed_lag
        taken = indicated - self.friction(speed) - self.inertia * rate
        lost = 0.25 * taken**2 + 0.0025 * speed**2
        fuel = indicated * speed / self.efficiency
        heat = (1 - self.efficiency) * fuel + self.friction(speed) * speed + lost
        return rate, taken * speed - lost, fuel, heat


def on_line(power: float) -> float:
    """Speed of the generator set at an electric power, rad/s: straight lines between the points of `LINE`."""
    for (low, slow), (high, fast) in pairwise(LINE):
        if low <= power <= high:
            return slow + (fast - slow) * (power - low) / (high - low)
    raise ValueError(power)


@dataclass
class RangeExtenderCar(Stepped):
    """Mutable: the modes between events."""

    machine: SynchronousMachine = GOLF
    battery: Battery = field(default_factory=lambda: Battery(series_cells=96, capacity=338400.0))
    axle: Axle = field(default_factory=lambda: Axle(ratio=9.665))
    request: Request = field(
        default_factory=lambda: Request(ratio=9.665, max_torque=330.0, max_discharge_power=130e3, max_charge_power=60e3)
    )
    car: Car = field(default_factory=lambda: Car(mass=1500.0, wheel_radius=0.34, drag_area=0.70))
    generator: GeneratorSet = field(default_factory=GeneratorSet)
    initial_soc: float = 0.4805
    start_soc: float = 0.475
    stop_soc: float = 0.4755
    least_time: float = 20.0
    averaging: float = 5.0
    rotor_inertia: float = 0.05
    modes: dict[str, bool] = field(default_factory=lambda: modes("weakened", "burning", "clipped"))
    is_low: bool = False
    is_on: bool = False
    changed_at: float = -1000.0
    is_above: list[bool] = field(default_factory=lambda: [False, False])

    def start(self) -> list[float]:
        """At rest."""
        return [0.0, 0.0, 0.0, 0.0, 350.0, self.initial_soc * self.battery.capacity] + [0.0] * 8

    def power_wanted(self) -> float:
        """Of the generator set, W."""
        point = 2 if self.is_above[1] else 1 if self.is_above[0] else 0
        return POINTS[point] if self.is_on else 0.0

    def _asked(self, y: Vector) -> tuple[float, float, float, float]:
        lowest, highest = self.request.limits(
            y[1], y[5] / self.battery.capacity, self.modes["driving"], self.modes["charging"]
        )
        wanted = STEPS[self.demand_step][1] / self.request.ratio
        return wanted, lowest, highest, cut(wanted, lowest, highest, self.modes["above"], self.modes["below"])

    def guards(self, time: float, y: Vector) -> dict[str, float]:
        """Positive: the mode is on."""
        spin, soc = y[1], y[5] / self.battery.capacity
        driving, charging = self.request.excess(spin, soc)
        wanted, lowest, highest, asked = self._asked(y)
        limit = self.machine.torque_limit(spin, y[4], self.modes["fast"])
        torque = self.generator.wanted_torque(self.power_wanted(), y[8])
        return {
            "driving": driving,
            "charging": charging,
            "fast": self.machine.max_torque * abs(spin) - self.machine.power_limit(y[4]),
            "above": wanted - highest,
            "below": lowest - wanted,
            "over": asked - limit,
            "under": -limit - asked,
            "weakened": self.machine.weakening(y[3], spin, y[4]),
            "burning": y[8] - self.generator.firing_speed,
            "clipped": torque - self.generator.max_torque,
        }

    def events(self) -> list[Event]:
        """Of the present mode."""
        found = super().events()
        level = self.stop_soc if self.is_low else self.start_soc
        sign = 1.0 if self.is_low else -1.0
        found.append(crossing(lambda t, y: 1e4 * sign * (y[5] / self.battery.capacity - level), self._battery))
        if self.is_on != self.is_low:
            found.append(crossing(lambda t, y: 1e3 * (t - self.changed_at - self.least_time), self._decide))
        for k in range(2):
            edge = POINTS[k] + (-BAND if self.is_above[k] else BAND)
            sense = -1.0 if self.is_above[k] else 1.0
            found.append(
                crossing(lambda t, y, s=sense, e=edge: s * (y[10] - e), lambda t, k=k: self._move(k))  # type: ignore[misc]
            )
        return found

    def _battery(self, time: float) -> None:
        self.is_low = not self.is_low
        self._decide(time)

    def _decide(self, time: float) -> None:
        if time >= self.changed_at + self.least_time - 1e-11 and self.is_on != self.is_low:
            self.is_on, self.changed_at = self.is_low, time

    def _move(self, k: int) -> None:
        self.is_above[k] = not self.is_above[k]

    def derivative(self, time: float, y: Vector) -> list[float]:
        """Of the state."""
        v, spin, twist, torque, seen, charge, first, second, turning, indicated, mean = y[:11]
        asked = self._asked(y)[3]
        limit = self.machine.torque_limit(spin, seen, self.modes["fast"])
        target = cut(asked, -limit, limit, self.modes["over"], self.modes["under"])
        machine_loss = self.machine.losses(torque, spin, seen, self.modes["weakened"])
        wanted = self.power_wanted()
        line = on_line(wanted) if wanted > 0 else 0.0
        rate, fed, fuel, engine_heat = self.generator.flows(turning, indicated, line)
        burned = 0.0
        if wanted > 0 and self.modes["burning"]:
            full = self.generator.max_torque
            burned = full if self.modes["clipped"] else self.generator.wanted_torque(wanted, turning)
            burned += self.generator.friction(turning)
        link_power = torque * spin + machine_loss + 350.0 - fed
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
            (open_circuit - drop - seen) / 0.05,
            -current,
            *pairs,
            rate,
            (burned - indicated) / self.generator.torque_lag,
            (asked * spin - mean) / self.averaging,
            open_circuit * current + fuel,
            shaft * wheel,
            heat + machine_loss + lost * spin + self.axle.damping * slip**2 + 350.0 + engine_heat,
        ]

    def stored(self, y: Vector) -> float:
        """J in masses that turn, half shafts and capacitors."""
        capacitors = sum(
            0.5 * constant / self.battery.resistance(specific) * voltage**2
            for voltage, (specific, constant) in zip(y[6:8], self.battery.pairs, strict=True)
        )
        turning = 0.5 * self.rotor_inertia * y[1] ** 2 + 0.5 * self.generator.inertia * y[8] ** 2
        return float(turning + 0.5 * self.axle.stiffness * y[2] ** 2 + capacitors)
