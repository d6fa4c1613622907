"""The P2 hybrid as one system: mechanics of `HybridCar`, petrol engine, machine, battery and the control's rules.

State: that of `HybridCar`, then the torque the engine's air allows, the machine's torque, the voltage it sees, charge,
two pair voltages, the clutch's command, the torque asked of the engine and the one expected of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from combustion import Petrol
from combustion_hybrid import ENERGY_IN, ENERGY_LOSS, HybridCar
from electric import Battery, SynchronousMachine
from electric_drive import STEPS, Request, Stepped, cut, modes
from hybrid_system import Event, Vector
from modes import crossing
from range_extender import GOLF

MECHANICS = 9
AIR, TORQUE, SEEN, CHARGE, FAST, SLOW, CLUTCH, ASKED, EXPECTED = range(MECHANICS, MECHANICS + 9)
START_POWER, STOP_POWER = 15e3, 6e3
START_SPEED, STOP_SPEED = 115.0, 92.0
LOW_SOC, HIGH_SOC, TARGET_SOC = 0.45, 0.55, 0.5
LEAST_TIME = 4.0
LEAST_TORQUE, MOST_TORQUE = 10.0, 200.0


def power_cell_battery() -> Battery:
    """96 cells of 31 Ah, resistances 40 % of those of energy cells."""
    share = 0.4
    pairs = ((142.9 * share, 32.85), (152.5 * share, 223.0))
    return Battery(series_cells=96, capacity=111600.0, series=227.8 * share, pairs=pairs)


Watched = Callable[[float, Vector], float]


@dataclass
class HybridDrive(Stepped):
    """Mutable: the modes between events. The demand is *demand_share* of `STEPS`."""

    demand_share: float = 0.5
    petrol: Petrol = field(default_factory=lambda: Petrol(auxiliary_power=0.0))
    machine: SynchronousMachine = GOLF
    battery: Battery = field(default_factory=power_cell_battery)
    request: Request = field(
        default_factory=lambda: Request(ratio=1.0, max_torque=330.0, max_discharge_power=90e3, max_charge_power=60e3)
    )
    initial_soc: float = 0.5
    modes: dict[str, bool] = field(default_factory=lambda: modes("weakened"))
    is_low: bool = False
    is_demanding: bool = False
    is_fast: bool = False
    is_on: bool = False
    is_synchronous: bool = False
    changed_at: float = -1000.0
    starts_of_engine: int = 0
    _engine: float = 0.0
    _machine: float = 0.0
    _clutch: float = 0.0
    car: HybridCar = field(init=False)

    def __post_init__(self) -> None:
        self.car = HybridCar(
            lambda t: self._engine, lambda t: self._machine, lambda t: self._clutch,
            mass=1550.0, radius=0.32, drag_area=0.66, rolling=0.009,
        )  # fmt: skip

    def start(self) -> list[float]:
        """At rest."""
        return [*self.car.start(), 0.0, 0.0, 350.0, self.initial_soc * self.battery.capacity, 0.0, 0.0, 0.0, 0.0, 0.0]

    def _speeds(self, time: float, y: Vector) -> tuple[float, float, float]:
        """Of the machine and the engine, and the ratio of machine to wheels."""
        ratio = self.car.train.ratio(time)[0]
        machine = ratio * y[1]
        return machine, machine if self.car.is_locked else y[0], ratio * self.car.gears.final

    def _brake_torque(self, engine_speed: float, y: Vector) -> tuple[float, float]:
        """Combustion torque and torque on the crankshaft, N.m."""
        burning = min(1.0, max(0.0, (engine_speed - 40.0) / 20.0)) if self.is_on else 0.0
        return burning * y[AIR], burning * y[AIR] - self.petrol.drag(engine_speed)

    def _asked(self, time: float, y: Vector) -> tuple[float, float, float, float]:
        machine, _, ratio = self._speeds(time, y)
        lowest, highest = self.request.limits(
            machine, y[CHARGE] / self.battery.capacity, self.modes["driving"], self.modes["charging"]
        )
        cranking = 45.0 if self.is_on and not self.is_synchronous else 0.0
        wanted = self._shaft_torque(ratio) - y[EXPECTED] + cranking
        return wanted, lowest, highest, cut(wanted, lowest, highest, self.modes["above"], self.modes["below"])

    def _shaft_torque(self, ratio: float) -> float:
        return self.demand_share * STEPS[self.demand_step][1] / ratio

    def guards(self, time: float, y: Vector) -> dict[str, float]:
        """Positive: the mode is on."""
        spin, soc = self._speeds(time, y)[0], y[CHARGE] / self.battery.capacity
        driving, charging = self.request.excess(spin, soc)
        wanted, lowest, highest, asked = self._asked(time, y)
        limit = self.machine.torque_limit(spin, y[SEEN], self.modes["fast"])
        return {
            "driving": driving,
            "charging": charging,
            "fast": self.machine.max_torque * abs(spin) - self.machine.power_limit(y[SEEN]),
            "above": wanted - highest,
            "below": lowest - wanted,
            "over": asked - limit,
            "under": -limit - asked,
            "weakened": self.machine.weakening(y[TORQUE], spin, y[SEEN]),
        }

    def events(self) -> list[Event]:
        """Of the present mode."""
        found = [*self._mechanical(), *super().events()]

        def power(t: float, y: Vector) -> float:
            machine, _, ratio = self._speeds(t, y)
            return self._shaft_torque(ratio) * machine

        def soc(y: Vector) -> float:
            return float(y[CHARGE] / self.battery.capacity)

        found.append(
            self._switch("is_low", lambda t, y: 1e4 * (LOW_SOC - soc(y)), lambda t, y: 1e4 * (soc(y) - HIGH_SOC))
        )
        found.append(
            self._switch("is_demanding", lambda t, y: power(t, y) - START_POWER, lambda t, y: STOP_POWER - power(t, y))
        )
        found.append(
            self._switch(
                "is_fast",
                lambda t, y: self._speeds(t, y)[0] - START_SPEED,
                lambda t, y: STOP_SPEED - self._speeds(t, y)[0],
            )
        )
        if self.is_on != (self.is_low or self.is_demanding):
            found.append(crossing(lambda t, y: 1e3 * (t - self.changed_at - LEAST_TIME), self._decide))
        if self.is_on and not self.is_synchronous:
            found.append(crossing(lambda t, y: 10.0 - abs(self._speeds(t, y)[1] - self._speeds(t, y)[0]), self._close))
        return found

    def _mechanical(self) -> list[Event]:
        def moved(event: Event) -> Event:
            def value(t: float, y: Vector) -> float:
                self._drive(t, y)
                return event.value(t, y)

            def change(t: float, y: Vector) -> None:
                self._drive(t, y)
                event.change(t, y)

            return Event(value, change)

        return [moved(event) for event in self.car.events()]

    def _switch(self, name: str, on: Watched, off: Watched) -> Event:
        def change(time: float) -> None:
            setattr(self, name, not getattr(self, name))
            self._decide(time)

        return crossing(off if getattr(self, name) else on, change)

    def _decide(self, time: float) -> None:
        is_rested = time >= self.changed_at + LEAST_TIME - 1e-11
        is_on = self.is_fast and ((self.is_low or self.is_demanding) if is_rested else self.is_on)
        if is_on != self.is_on:
            self.is_on, self.changed_at, self.is_synchronous = is_on, time, False
            self.starts_of_engine += is_on

    def _close(self, time: float) -> None:
        self.is_synchronous = True

    def _drive(self, time: float, y: Vector) -> tuple[float, float]:
        """Set what the mechanics are driven by; combustion torque and speed of the engine."""
        engine_speed = self._speeds(time, y)[1]
        combustion, self._engine = self._brake_torque(engine_speed, y)
        self._machine, self._clutch = float(y[TORQUE]), float(y[CLUTCH])
        return combustion, engine_speed

    def derivative(self, time: float, y: Vector) -> list[float]:
        """Of the state."""
        combustion, engine_speed = self._drive(time, y)
        mechanics = self.car.derivative(time, y[:MECHANICS])
        spin, _, ratio = self._speeds(time, y)
        fuel = self.petrol.fuel(engine_speed, combustion)
        engine_heat = fuel - self._engine * engine_speed
        demanded = max(y[ASKED], LEAST_TORQUE) if self.is_on else 0.0
        air = max(0.0, self.petrol.target(engine_speed, demanded)) if self.is_on else 0.0
        asked = self._asked(time, y)[3]
        limit = self.machine.torque_limit(spin, y[SEEN], self.modes["fast"])
        target = cut(asked, -limit, limit, self.modes["over"], self.modes["under"])
        machine_loss = self.machine.losses(y[TORQUE], spin, y[SEEN], self.modes["weakened"])
        open_circuit = self.battery.open_circuit(y[CHARGE])
        inner = open_circuit - y[FAST] - y[SLOW]
        current = self.battery.current(y[TORQUE] * spin + machine_loss + 350.0, inner)
        pairs, heat, drop = self.battery.flows(current, (y[FAST], y[SLOW]))
        charging = min(8000.0, max(-8000.0, 1e5 * (TARGET_SOC - y[CHARGE] / self.battery.capacity)))
        share = 0.0
        if self.is_synchronous:
            share = self._shaft_torque(ratio) + charging / max(spin, STOP_SPEED)
            share = min(MOST_TORQUE, max(LEAST_TORQUE, share))
        command = 1.0 if self.is_synchronous else 0.15 if self.is_on else 0.0
        mechanics[ENERGY_IN] = open_circuit * current + fuel
        mechanics[ENERGY_LOSS] += heat + machine_loss + 350.0 + engine_heat
        return [
            *mechanics,
            (air - y[AIR]) / self.petrol.air_lag,
            (target - y[TORQUE]) / self.machine.torque_lag,
            (open_circuit - drop - y[SEEN]) / 0.05,
            -current,
            *pairs,
            (command - y[CLUTCH]) / 0.06,
            (share - y[ASKED]) / 0.4,
            (y[ASKED] - y[EXPECTED]) / 0.2,
        ]
